// Buttons, menus, keys, and files that are opened or dropped.

import type { PartName } from "./colours";
import { byId, typing } from "./dom";
import { connectLegend } from "./legend";

export interface ToolbarEvents {
  home(): void;
  undo(back: boolean): void;
  reset(): void;
  share(): void;
  themed(): void;
  mode(mode: string): void;
  example(name: string): void;
  save(what: string): void;
  opened(name: string, text: string): void;
  /** A file that is no text was to be opened. */
  unreadable(message: string): void;
}

/** What the buttons of the view do. */
export interface ViewEvents {
  fit(): void;
  orbit(across: number, upwards: number, nearer?: number): void;
  highlight(part: PartName | null): void;
}

export function connectToolbar(events: ToolbarEvents): void {
  const click = (id: string, action: () => void) => byId(id).addEventListener("click", action);
  click("home", events.home);
  click("undo", () => events.undo(true));
  click("redo", () => events.undo(false));
  click("reset", events.reset);
  click("open", () => byId("file").click());
  click("about", () => byId<HTMLDialogElement>("about-box").showModal());
  click("share", events.share);
  click("theme", () => {
    setTheme(document.documentElement.dataset["theme"] !== "dark");
    events.themed();
  });
  byId("licences").textContent = byId("opm-licences").textContent;
  const mode = byId<HTMLSelectElement>("mode");
  mode.addEventListener("change", () => events.mode(mode.value));
  const chosen = (id: string, action: (value: string) => void) => {
    const select = byId<HTMLSelectElement>(id);
    select.addEventListener("change", () => {
      const { value } = select;
      select.value = "";
      if (value) action(value);
    });
  };
  chosen("examples", events.example);
  chosen("save", events.save);
  window.addEventListener("keydown", (event) => {
    // What is being typed in a field, the browser undoes.
    if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z" || typing(event.target)) return;
    event.preventDefault();
    events.undo(!event.shiftKey);
  });
  connectFiles(async (file) => {
    const bytes = await file.arrayBuffer();
    const text = decoded(bytes);
    if (text !== null) events.opened(file.name, text);
    else events.unreadable(`${file.name}:${wrongLine(bytes)}: not UTF-8, expected a mechanism file or a motion`);
  });
}

/** The text that bytes are; nothing where they are none. */
function decoded(bytes: ArrayBuffer): string | null {
  try {
    return new TextDecoder("utf-8", { fatal: true }).decode(bytes);
  } catch {
    return null;
  }
}

/** The line of the first byte that is no text: in its place stands a sign for it. */
function wrongLine(bytes: ArrayBuffer): number {
  return new TextDecoder().decode(bytes).split("\uFFFD", 1)[0]!.split("\n").length;
}

function connectFiles(open: (file: File) => Promise<void>): void {
  const input = byId<HTMLInputElement>("file");
  input.addEventListener("change", () => {
    if (input.files?.[0]) void open(input.files[0]);
    input.value = "";
  });
  window.addEventListener("dragover", (event) => {
    event.preventDefault();
    document.body.classList.add("dropping");
  });
  window.addEventListener("dragleave", (event) => {
    if (!event.relatedTarget) document.body.classList.remove("dropping");
  });
  window.addEventListener("drop", (event) => {
    event.preventDefault();
    document.body.classList.remove("dropping");
    if (event.dataTransfer?.files[0]) void open(event.dataTransfer.files[0]);
  });
}

/** The buttons and the keys of the view. */
export function connectView(view: ViewEvents): void {
  connectLegend(view.highlight);
  byId("fit").addEventListener("click", view.fit);
  byId("view").addEventListener("keydown", (event) => {
    const turn = { ArrowLeft: [0.12, 0], ArrowRight: [-0.12, 0], ArrowUp: [0, 0.12], ArrowDown: [0, -0.12] }[event.key];
    const zoom = { "+": 0.9, "=": 0.9, "-": 1 / 0.9 }[event.key];
    if (turn) view.orbit(turn[0]!, turn[1]!);
    else if (zoom) view.orbit(0, 0, zoom);
    else if (event.key === "f") view.fit();
    else return;
    event.preventDefault();
  });
}

export function setTheme(dark: boolean): void {
  document.documentElement.dataset["theme"] = dark ? "dark" : "light";
}
