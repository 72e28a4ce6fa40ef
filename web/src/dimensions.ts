// The numbers of the mechanism that can be changed, each with a slider.

import { byId, element, field, numberIn, show } from "./dom";
import { rounded } from "./pose";
import type { Description, Dimension } from "./types";
import { halfTurn } from "./units";

export interface DimensionEvents {
  /** A dimension has new numbers; they are final when the pointer is let go, or a number is entered. */
  changed(name: string, values: number[], final: boolean): void;
}

interface Row {
  dimension: Dimension;
  /** The numbers that the fields show, with all their digits. */
  shown: number[];
  numbers: HTMLInputElement[];
  sliders: HTMLInputElement[];
}

export class DimensionPanel {
  private readonly rows = new Map<string, Row>();

  constructor(private readonly events: DimensionEvents) {}

  build({ dimensions }: Description): void {
    this.rows.clear();
    const groups = [...new Set(dimensions.map(({ group }) => group))].map((group) => {
      const own = dimensions.filter((dimension) => dimension.group === group);
      // Most joints have no limits, and their fields would hide the others.
      const open = own.filter(({ parts, values }) => parts[0] === "min" && values.length === 0);
      const given = own.filter((dimension) => !open.includes(dimension));
      const fields = (list: Dimension[]) => list.flatMap((dimension) => this.fields(dimension, own));
      const more = open.length
        ? element("details", {}, element("summary", {}, "Limits that are not given"), ...fields(open)) : null;
      return element("div", {}, element("h3", {}, group), ...fields(given), more);
    });
    byId("dimensions").replaceChildren(...groups);
  }

  private fields(dimension: Dimension, others: Dimension[]): HTMLElement[] {
    const { name, group, unit, parts, values } = dimension;
    const label = dimension.label.startsWith(`${group}.`) ? dimension.label.slice(group.length + 1) : dimension.label;
    const row: Row = { dimension, shown: values, numbers: [], sliders: [] };
    this.rows.set(name, row);
    // A length may be zero at first: the slider then goes as far as the other lengths of its leg.
    const same = others.filter((other) => other.unit === unit).flatMap((other) => other.values.map(Math.abs));
    const turn = halfTurn(unit);
    const typical = turn ? turn / 2 : unit === "" ? 1 : Math.max(...same, 0) || 1;
    return (parts.length ? parts : [""]).map((part, index) => {
      const [id, text] = part ? [`param-${name}.${part}`, `${label}.${part}`] : [`param-${name}`, label];
      const number = element("input", { type: "number", step: "any", id });
      const slider = element("input", { type: "range", step: "any", "aria-label": `${text}, slider` });
      const value = values[index] ?? 0;
      const reach = turn || unit === "" ? typical : Math.abs(value) || typical;
      [slider.min, slider.max, slider.value] = [String(value - reach), String(value + reach), String(value)];
      const report = (final: boolean) => {
        const all = row.numbers.map((_, place) => numberOf(row, place));
        if (all.every((one) => one !== undefined)) this.events.changed(name, all as number[], final);
        else if (final && parts[0] === "min" && all.every((one) => one === undefined)) this.events.changed(name, [], true);
      };
      const slide = (final: boolean) => {
        const other = row.sliders.map((slider, place) => numberOf(row, place) ?? Number(slider.value));
        other[index] = rounded(slider);
        this.events.changed(name, other, final);
      };
      slider.addEventListener("input", () => slide(false));
      slider.addEventListener("change", () => slide(true));
      number.addEventListener("input", () => report(false));
      number.addEventListener("change", () => report(true));
      row.numbers.push(number);
      row.sliders.push(slider);
      // A name may go on below behind a dot.
      const pieces = text.split(/(?<=\.)/).flatMap((piece) => [piece, element("wbr")]);
      const head = element("label", { for: id, title: text }, ...pieces);
      return element("div", { className: "quantity" }, head, slider, number, element("span", { className: "unit" }, unit));
    });
  }

  /** Shows the numbers of the mechanism, or those that were asked for. */
  update({ dimensions }: Description, changes: Record<string, number[]>): void {
    dimensions.forEach(({ name, values }) => {
      const row = this.rows.get(name);
      if (!row) return;
      const shown = changes[name] ?? values;
      row.shown = shown;
      row.numbers.forEach((input, part) => show(input, shown[part]));
      row.sliders.forEach((slider, part) => {
        if (shown[part] !== undefined && slider.valueAsNumber !== shown[part]) slider.value = String(shown[part]);
      });
    });
  }
}

/** The number in a field of a row: that which it shows, unless another one was typed. */
function numberOf({ numbers, shown }: Row, place: number): number | undefined {
  const [input, known] = [numbers[place]!, shown[place]];
  return known !== undefined && input.value === field(known) ? known : numberIn(input);
}
