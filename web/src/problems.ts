// The box that says what is wrong, and where that is from: what becomes right is no longer said.

import { byId, element } from "./dom";
import type { Problem } from "./types";

/** Where problems are from. */
export type Source = "link" | "file" | "field" | "mechanism" | "pose" | "joint" | "fit" | "slice" | "whole" | "body" | "colours" | "kind" | "motion" | "page";

export class ProblemBox {
  private readonly box = byId("problems");
  private readonly sources = new Map<Source, Problem[]>();
  private shown = "";

  /** `refused` says whether what is shown is not what the fields say; `closed` is what the button does besides. */
  constructor(private readonly refused: () => boolean, private readonly closed: (refused: boolean) => void) {}

  /** Takes all problems of a source; with none, it has succeeded. */
  set(source: Source, problems: Problem[]): void {
    if (problems.length) this.sources.set(source, problems);
    else this.sources.delete(source);
    this.show();
  }

  /** Takes more problems of a source. */
  add(source: Source, problems: Problem[]): void {
    if (problems.length) this.set(source, [...(this.sources.get(source) ?? []), ...problems]);
  }

  clear(): void {
    this.sources.clear();
    this.show();
  }

  show(): void {
    const all = [...this.sources.values()].flat();
    const lines = [...new Set(all.map(({ file, place, message }) => (place ? `${file ?? ""}:${place[0]}:${place[1]}: ${message}` : message)))];
    const refused = all.length > 0 && this.refused();
    const text = lines.join("\n") + (refused ? "\nWhat is shown is the last mechanism that could be computed." : "");
    if (text === this.shown) return;
    this.shown = text;
    this.box.hidden = lines.length === 0;
    const button = element("button", { type: "button" }, refused ? "Undo" : "Close");
    button.addEventListener("click", () => {
      this.clear();
      this.closed(refused);
    });
    this.box.replaceChildren(element("div", {}, text), button);
  }
}
