// The start of the page.

import { byId } from "./dom";
import type { PageFile } from "./follower";
import { Page } from "./page";
import { setTheme } from "./toolbar";
import { unpack } from "./unpack";

const content = (id: string) => byId(id).textContent ?? "";

setTheme(matchMedia("(prefers-color-scheme: dark)").matches);
void unpack(content("opm-library"))
  .then((library) => new Page(JSON.parse(content("opm-file")) as PageFile | null, content("opm-worker"), library).start())
  .catch((error) => {
    byId("status").textContent = `The page does not work in this browser: ${String(error)}`;
  });
