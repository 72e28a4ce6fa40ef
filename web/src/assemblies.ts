// The assemblies for given actuated joints, to be stepped through.

import { byId, element } from "./dom";
import type { Assembly } from "./types";

export class Assemblies {
  private list: Assembly[] = [];

  constructor(private readonly chosen: (assembly: Assembly, final: boolean) => void) {}

  /** Takes the assemblies that were found, and goes to the first one. Returns whether there is any. */
  set(found: Assembly[], final: boolean): boolean {
    this.list = found;
    this.go(0, final);
    return found.length > 0;
  }

  private go(number: number, final: boolean): void {
    const assembly = this.list[number];
    if (assembly) this.chosen(assembly, final);
    const buttons = this.list.map(({ mode, within }, i) => {
      const button = element("button", { type: "button", "aria-pressed": String(i === number), title: within ? "within limits" : "beyond limits" },
        `${i + 1}: ${mode || "assembly"}`);
      button.addEventListener("click", () => this.go(i, true));
      return button;
    });
    byId("assemblies").replaceChildren(...(buttons.length > 1 ? buttons : []));
  }
}
