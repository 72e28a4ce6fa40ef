// Kinds of workspace: how many points each has, and how large it is.

import { beyond } from "./beyond";
import { byId, element, grouped, numberIn, short, show } from "./dom";
import type { KindState } from "./state";
import type { Kind, KindCount } from "./types";

export class KindPanel {
  private readonly select = byId<HTMLSelectElement>("kind");
  private readonly turn = byId<HTMLInputElement>("kind-turn");
  private kinds: Kind[] = [];
  private state!: KindState;

  constructor(changed: (kind: KindState) => void) {
    this.select.addEventListener("change", () => changed({ ...this.state, name: this.select.value }));
    this.turn.addEventListener("change", () => changed({ ...this.state, turn: numberIn(this.turn) ?? null }));
  }

  build(kinds: Kind[], angle: string): void {
    this.kinds = kinds;
    byId("kind-unit").textContent = angle;
    this.select.replaceChildren(...kinds.map(({ name, description, refused }) =>
      element("option", { value: name, title: refused ?? description, disabled: refused !== null }, name)));
  }

  /** The kind that is to be counted; nothing for that of all poses, which is counted anyway. */
  get wanted(): string | null {
    const kind = this.kinds.find(({ name }) => name === this.state.name);
    return kind && kind.refused === null && kind.name !== "grid" ? kind.name : null;
  }

  update(state: KindState): void {
    this.state = state;
    const kind = this.kinds.find(({ name }) => name === state.name) ?? this.kinds[0];
    if (!kind) return;
    this.select.value = kind.name;
    byId("kind-turns").hidden = !kind.turns;
    byId("kind-facts").hidden = this.wanted === null;
    byId("kind-note").textContent = kind.refused ?? `${kind.description}.`;
    show(this.turn, state.turn ?? undefined);
  }

  /** Takes a count; nothing where it was refused. */
  setCount(count: KindCount | null): void {
    byId("kind-beyond").textContent = beyond(count?.unbounded ?? []);
    byId("kind-count").textContent = count ? `${grouped(count.members)} of ${grouped(count.points)} ${count.point_name}` : "–";
    byId("kind-measure").textContent = count && count.measure !== null ? `${short(count.measure)} ${count.unit}` : "–";
    const options = count?.options ?? [];
    byId("kind-command").textContent = options.map((option) => (/[ +]/.test(option) ? `"${option}"` : option)).join(" ");
  }
}
