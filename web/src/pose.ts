// The platform's coordinates, each with a slider and a number.

import { byId, element, field, numberIn, show } from "./dom";
import type { Coordinate, Description } from "./types";

export interface PoseEvents {
  /** A coordinate has a new value; it is final when the pointer is let go, or a number is entered. */
  moved(name: string, value: number, final: boolean): void;
}

export class PosePanel {
  private rows: { coordinate: Coordinate; slider: HTMLInputElement; number: HTMLInputElement }[] = [];

  constructor(private readonly events: PoseEvents) {}

  build({ coordinates, dependent }: Description): void {
    this.rows = [];
    const rows = coordinates.map((coordinate) => {
      const { name, unit, si, quantity, home } = coordinate;
      // Until the grid is fitted: a quarter of a turn, or a decimetre.
      const reach = quantity === "angle" ? Math.PI / 2 / si : Math.max(0.1 / si, Math.abs(home));
      const slider = element("input", { type: "range", step: "any", "aria-label": `${name}, slider` });
      [slider.min, slider.max, slider.value] = [String(home - reach), String(home + reach), String(home)];
      const number = element("input", { type: "number", step: "any", id: `pose-${name}` });
      const row = { coordinate, slider, number };
      slider.addEventListener("input", () => this.events.moved(name, rounded(slider), false));
      slider.addEventListener("change", () => this.events.moved(name, rounded(slider), true));
      number.addEventListener("input", () => {
        const value = numberIn(number);
        if (value !== undefined) this.events.moved(name, value, false);
      });
      number.addEventListener("change", () => {
        const value = numberIn(number);
        if (value === undefined) number.value = field(row.coordinate.home);
        this.events.moved(name, value ?? row.coordinate.home, true);
      });
      this.rows.push(row);
      const label = element("label", { for: `pose-${name}` }, name);
      return element("div", { className: "quantity" }, label, slider, number, element("span", { className: "unit" }, unit));
    });
    const following = dependent.map(({ name, unit }) =>
      element("div", { className: "quantity" }, element("span", {}, name), element("span", { className: "unit" }, "follows"),
        element("output", { id: `dependent-${name}` }), element("span", { className: "unit" }, unit)));
    byId("pose").replaceChildren(...rows, ...following);
  }

  /** The ranges of the sliders. */
  setRanges(axes: { name: string; min: number; max: number }[]): void {
    for (const { coordinate, slider } of this.rows) {
      const axis = axes.find((axis) => axis.name === coordinate.name);
      if (axis && axis.max > axis.min) [slider.min, slider.max] = [String(axis.min), String(axis.max)];
    }
  }

  /** Shows a pose. The home that an emptied field goes to is that of the mechanism as it is changed now. */
  update({ coordinates }: Description, pose: Record<string, number>): void {
    this.rows.forEach((row, i) => {
      const { name, home } = (row.coordinate = coordinates[i]!);
      const value = pose[name] ?? home;
      show(row.number, value);
      if (Number(row.slider.value) !== value) row.slider.value = String(value);
    });
  }
}

/** The value of a slider, without more digits than its length has. */
export function rounded(slider: HTMLInputElement): number {
  const width = Number(slider.max) - Number(slider.min);
  const step = 10 ** Math.floor(Math.log10(width / 1000));
  return Number((Math.round(slider.valueAsNumber / step) * step).toPrecision(12));
}
