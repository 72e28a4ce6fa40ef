// The table of joints: values, and where they are inside the limits, as bars or, where they are driven, as sliders.

import { byId, element, field, numberIn, short, show } from "./dom";
import { COLOURS } from "./colours";
import { rounded } from "./pose";
import type { Counted, Description, Joint, Posture } from "./types";
import { halfTurn } from "./units";

export interface JointEvents {
  /** An actuated joint is to have this value; it is final when the slider is let go, or a number is entered. */
  driven(name: string, value: number, final: boolean): void;
  /** A joint is pointed at; nothing where none is. */
  pointed(joint: string | null): void;
}

interface Row {
  joint: Joint;
  row: HTMLTableRowElement;
  value: HTMLElement;
  bar: HTMLElement;
  mark: HTMLElement;
  /** In place of the bar, where the joint is driven. */
  slider: HTMLInputElement | null;
}

export class JointTable {
  private rows: Row[] = [];
  private joints: Joint[] = [];

  constructor(private readonly events: JointEvents) {}

  build({ joints, forward }: Description): void {
    this.joints = joints;
    this.rows = [];
    const body = element("tbody");
    for (const leg of new Set(joints.map((joint) => joint.leg))) {
      body.append(element("tr", {}, element("th", { colSpan: 4, scope: "rowgroup" }, leg)));
      for (const joint of joints) if (joint.leg === leg) body.append(this.row(joint, forward));
    }
    const names = ["Joint", "Value", "Unit", "Within its limits"];
    const head = element("tr", {}, ...names.map((name) => element("th", { scope: "col" }, name)));
    byId("joints").replaceChildren(element("table", {}, element("thead", { className: "hidden" }, head), body));
  }

  private row(joint: Joint, forward: boolean): HTMLTableRowElement {
    const { name, kind, limits, unit } = joint;
    const dot = element("span", { className: "dot", title: `${kind}${joint.section ? `, ${joint.section} section` : ""}` });
    dot.style.background = COLOURS[kind];
    const driven = kind === "actuated" && forward;
    const value = driven
      ? element("input", { type: "number", step: "any", id: `joint-${name}`, "aria-label": `${name}, ${unit}` })
      : element("output", { id: `joint-${name}` });
    if (value instanceof HTMLInputElement) {
      value.addEventListener("change", () => {
        const wanted = numberIn(value);
        if (wanted !== undefined) this.events.driven(name, wanted, true);
      });
    }
    const slider = driven ? element("input", { type: "range", step: "any", "aria-label": `${name}, slider` }) : null;
    slider?.addEventListener("input", () => this.events.driven(name, rounded(slider), false));
    slider?.addEventListener("change", () => this.events.driven(name, rounded(slider), true));
    const mark = element("b");
    const bar = element("div", { className: limits ? "" : "open" }, mark);
    const row = element("tr", {}, element("td", {}, dot, name), element("td", { className: "value" }, value),
      element("td", { className: "unit" }, unit), element("td", { className: "bar" }, slider ?? bar));
    for (const event of ["pointerenter", "focusin"]) row.addEventListener(event, () => this.events.pointed(joint.joint));
    for (const event of ["pointerleave", "focusout"]) row.addEventListener(event, () => this.events.pointed(null));
    this.rows.push({ joint, row, value, bar, mark, slider });
    return row;
  }

  /** Marks the rows of a joint; nothing marks none. */
  point(name: string | null): void {
    for (const { joint, row } of this.rows) row.classList.toggle("pointed", joint.joint === name);
  }

  /** Puts the value of a posture back into the field and the slider of a joint that cannot have what was entered. */
  restore(name: string, posture: Posture | null): void {
    const number = this.joints.findIndex((joint) => joint.name === name);
    const [row, now] = [this.rows.find(({ joint }) => joint.name === name), posture?.values[number]];
    if (now === undefined) return;
    if (row?.value instanceof HTMLInputElement) row.value.value = field(Number(short(now)));
    if (row?.slider && !row.slider.matches(":active")) row.slider.value = String(now);
  }

  /** The values of a posture, and the ranges of the imaginary joints over the workspace. */
  update(posture: Posture | null, counted: Counted | null): void {
    const first = this.joints.findIndex((joint) => joint.kind === "imaginary");
    for (const { joint, row, value, bar, mark, slider } of this.rows) {
      const number = this.joints.indexOf(joint);
      const now = posture?.values[number];
      if (value instanceof HTMLInputElement) show(value, now === undefined ? undefined : Number(short(now)));
      else value.textContent = now === undefined ? "" : short(now);
      const swept = joint.kind === "imaginary" ? (counted?.imaginary[number - first] ?? null) : null;
      const turn = halfTurn(joint.unit);
      const [low, high] = joint.limits ?? swept ?? (turn ? [joint.home - turn, joint.home + turn] : [joint.home - 1, joint.home + 1]);
      (slider ?? bar).title = joint.limits ? `limits ${field(low)} to ${field(high)} ${joint.unit}`
        : swept ? `over the workspace ${short(low)} to ${short(high)} ${joint.unit}` : "no limits";
      row.classList.toggle("beyond", posture?.beyond.includes(number) ?? false);
      if (slider && high > low) {
        [slider.min, slider.max] = [String(low), String(high)];
        // Whoever drags it is ahead of the mechanism.
        if (now !== undefined && !slider.matches(":active")) slider.value = String(now);
      }
      mark.hidden = now === undefined;
      if (now !== undefined) {
        const place = high > low ? (now - low) / (high - low) : 0.5;
        mark.style.left = `${100 * Math.min(1, Math.max(0, place))}%`;
      }
    }
  }
}
