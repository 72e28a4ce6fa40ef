// The box that says what is wrong with a file or a change.

import { byId, element } from "./dom";
import type { Problem } from "./types";

/** Shows problems of a file. Where it was refused, what is shown is not what the fields say. */
export function showProblems(problems: Problem[], name: string, refused: boolean, closed: () => void): void {
  const box = byId("problems");
  box.hidden = problems.length === 0;
  if (box.hidden) return;
  const lines = problems.map(({ place, message }) => (place ? `${name}:${place[0]}:${place[1]}: ${message}` : message));
  const note = refused ? "\nWhat is shown is the last mechanism that could be computed." : "";
  const button = element("button", { type: "button" }, refused ? "Undo" : "Close");
  button.addEventListener("click", closed);
  box.replaceChildren(element("div", {}, lines.join("\n") + note), button);
}
