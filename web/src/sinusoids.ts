// A motion of sinusoids, one for each task coordinate: its fields, and its motion file.

import { byId, element, numberIn } from "./dom";
import type { Coordinate } from "./types";
import { halfTurn } from "./units";

const PARTS = ["amplitude", "frequency", "phase"] as const;

export class Sinusoids {
  private rows: { coordinate: Coordinate; fields: HTMLInputElement[] }[] = [];

  constructor(private readonly changed: () => void) {}

  /** Fields for these coordinates, with a motion that is small beside the ranges of the workspace. */
  build(coordinates: Coordinate[], ranges: { name: string; min: number; max: number }[]): void {
    this.rows = coordinates.map((coordinate, number) => {
      const range = ranges.find(({ name }) => name === coordinate.name);
      const amplitude = Number(((range ? range.max - range.min : 1) / 10).toPrecision(2));
      const given = [amplitude, 0.1 * (number + 1), 60 * number];
      const fields = PARTS.map((part, i) => {
        const field = element("input", {
          type: "number", step: "any", id: `sine-${coordinate.name}-${part}`, "aria-label": `${part} of ${coordinate.name}`, value: String(Number(given[i]!.toPrecision(3))),
        });
        field.addEventListener("change", this.changed);
        return field;
      });
      return { coordinate, fields };
    });
    const head = ["amplitude", "Hz", "phase, deg"].map((name) => element("th", { scope: "col" }, name));
    const rows = this.rows.map(({ coordinate: { name, unit }, fields }) =>
      element("tr", {}, element("th", { scope: "row" }, `${name} (${unit})`), ...fields.map((field) => element("td", {}, field))));
    byId("sinusoids").replaceChildren(element("table", { className: "sinusoids" }, element("tr", {}, element("td"), ...head), ...rows));
  }

  /** The motion as a file, about a pose. */
  file(pose: Record<string, number>, units: { length: string; angle: string }): string {
    const lines = this.rows.map(({ coordinate: { name, home }, fields }) => {
      const [amplitude, frequency, phase] = fields.map((field) => numberIn(field) ?? 0) as [number, number, number];
      const turned = (phase * (halfTurn(units.angle) ?? 180)) / 180;
      const offset = pose[name] ?? home;
      return amplitude && frequency > 0
        ? `${name} = { amplitude = ${amplitude}, frequency = ${frequency}, phase = ${turned}, offset = ${offset} }` : `${name} = ${offset}`;
    });
    return `format = 1
name = "sinusoids"
units = { length = "${units.length}", angle = "${units.angle}" }
duration = 10
rate = 100

[coordinates]
${lines.join("\n")}
`;
  }
}
