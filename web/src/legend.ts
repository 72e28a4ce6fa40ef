// The legend of the view.

import { COLOURS, PARTS, PART_NAMES, type PartName } from "./colours";
import { byId, element } from "./dom";

const entries = new Map<PartName, HTMLElement>();

/** Makes the legend; an entry that is pointed at shows its part alone. */
export function connectLegend(highlight: (part: PartName | null) => void): void {
  for (const part of PARTS) {
    const colour = element("i");
    colour.style.background = COLOURS[part];
    const button = element("button", { type: "button" }, colour, PART_NAMES[part]);
    for (const event of ["pointerenter", "focus"]) button.addEventListener(event, () => highlight(part));
    for (const event of ["pointerleave", "blur"]) button.addEventListener(event, () => highlight(null));
    entries.set(part, element("li", { className: part }, button));
  }
  byId("legend").append(...entries.values());
}

/** Where all legs move in one subspace, links are of no section. */
export function nameLinks(oneSubspace: boolean): void {
  entries.get("lower")!.querySelector("button")!.lastChild!.textContent = oneSubspace ? "Links" : PART_NAMES.lower;
}

/** Lists the parts that there are; the motions of the sections always are. */
export function showParts(parts: Set<PartName>): void {
  for (const [part, entry] of entries) entry.hidden = part !== "motions" && !parts.has(part);
}
