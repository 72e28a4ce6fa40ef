// The first script of the page: it decompresses the others, and runs them.

import { unpack } from "./unpack";

const packed = document.getElementById("opm-script")?.textContent ?? "";
unpack(packed)
  .then((bytes) => {
    const script = document.createElement("script");
    script.textContent = new TextDecoder().decode(bytes);
    document.body.append(script);
  })
  .catch((error: unknown) => {
    document.getElementById("status")!.textContent = `The page does not work in this browser: ${String(error)}`;
  });
