// One instance of the compiled library. The first message is the compiled code; every other one is a request, and is
// answered with the reply and the time that it took.

interface Exports {
  memory: WebAssembly.Memory;
  opm_request(length: number): number;
  opm_answer(): void;
  opm_reply(): number;
}

const scope = self as unknown as DedicatedWorkerGlobalScope;
let library: Exports | undefined;

function answer(request: string): { text: string; bytes: Uint8Array<ArrayBuffer> } {
  if (!library) throw new Error("the library is not loaded");
  const given = new TextEncoder().encode(request);
  // The memory may grow, and is then another buffer.
  const place = library.opm_request(given.length);
  new Uint8Array(library.memory.buffer, place, given.length).set(given);
  library.opm_answer();
  const reply = library.opm_reply();
  const [text = 0, length = 0, bytes = 0, many = 0] = new Uint32Array(library.memory.buffer, reply, 4);
  return {
    text: new TextDecoder().decode(new Uint8Array(library.memory.buffer, text, length)),
    bytes: new Uint8Array(library.memory.buffer, bytes, many).slice(),
  };
}

async function take(message: ArrayBuffer | string): Promise<void> {
  try {
    if (typeof message !== "string") {
      const { instance } = await WebAssembly.instantiate(message, {});
      library = instance.exports as unknown as Exports;
      scope.postMessage({ text: "null", bytes: new Uint8Array(), milliseconds: 0 });
      return;
    }
    const start = performance.now();
    const { text, bytes } = answer(message);
    scope.postMessage({ text, bytes, milliseconds: performance.now() - start }, [bytes.buffer]);
  } catch (error) {
    scope.postMessage({ failed: String(error) });
  }
}

// A request waits until the code is compiled.
let last = Promise.resolve();
scope.onmessage = ({ data }: MessageEvent<ArrayBuffer | string>) => {
  last = last.then(() => take(data));
};
