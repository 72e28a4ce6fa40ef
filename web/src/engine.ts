// The compiled library in workers, so that the view never waits for it.

import type { Problem } from "./types";

/** The answer to a request: JSON, bytes, and the milliseconds that it took. */
export interface Answer<T> {
  value: T;
  bytes: Uint8Array<ArrayBuffer>;
  milliseconds: number;
}

/** The library refused a request, with all problems. */
export class Refused extends Error {
  constructor(readonly problems: Problem[]) {
    super(problems.map((problem) => problem.message).join("; "));
  }
}

interface Reply {
  text: string;
  bytes: Uint8Array<ArrayBuffer>;
  milliseconds: number;
  failed?: string;
}

/** One worker, which answers in the order of the requests. */
export class Engine {
  private readonly worker: Worker;
  private readonly waiting: { resolve(reply: Reply): void; reject(error: Error): void }[] = [];

  constructor(code: string, library: ArrayBuffer) {
    const place = URL.createObjectURL(new Blob([code], { type: "text/javascript" }));
    this.worker = new Worker(place);
    this.worker.onmessage = ({ data }: MessageEvent<Reply>) => {
      const next = this.waiting.shift();
      if (data.failed) next?.reject(new Error(data.failed));
      else next?.resolve(data);
    };
    this.worker.onerror = (event) => this.waiting.shift()?.reject(new Error(event.message));
    void this.send(library).then(() => URL.revokeObjectURL(place));
  }

  private send(message: ArrayBuffer | string): Promise<Reply> {
    return new Promise((resolve, reject) => {
      this.waiting.push({ resolve, reject });
      this.worker.postMessage(message);
    });
  }

  /** Asks, and throws `Refused` where the answer is a list of problems. */
  async ask<T>(request: { do: string } & Record<string, unknown>): Promise<Answer<T>> {
    const { text, bytes, milliseconds } = await this.send(JSON.stringify(request));
    const value = JSON.parse(text) as T | { problems: Problem[] };
    if (value && typeof value === "object" && "problems" in value) throw new Refused(value.problems);
    return { value: value as T, bytes, milliseconds };
  }
}
