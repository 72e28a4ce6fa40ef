// The workspace: a plane slice through it, drawn, counted, and clicked to move the platform.

import { beyond } from "./beyond";
import { byId, element, grouped, numberIn, short, show } from "./dom";
import { cividis, nice, NUMBERS, pixel, scaleColumn } from "./scale";
import { countable, MOST_POINTS, POINTS, type SliceState } from "./state";
import type { AxisRequest, Colours, Counted, Description, KindCount, Slice } from "./types";

export interface SliceEvents {
  /** The slice is to be another one. */
  sliced(slice: SliceState, final: boolean): void;
  /** The platform is to move to this place of the slice. */
  placed(values: Record<string, number>, final: boolean): void;
  /** A number was entered that a slice cannot have, with the reason; nothing where another one is right. */
  refused(why: string | null): void;
}

/** A slice as it was asked for, and the answer. */
export interface Shown {
  x: AxisRequest;
  y: AxisRequest;
  /** The other coordinates, where they are not at home. */
  pose: Record<string, number>;
  slice: Slice;
  mask: Uint8Array;
  /** What colours it, with a number for each pose. */
  colours: { by: string; range: Colours; numbers: Float32Array } | null;
}

type End = "xmin" | "xmax" | "ymin" | "ymax";

const MARGIN = { left: 52, right: 10, top: 8, bottom: 34 };
/** The room of the bar of colours, to the right of a slice that has any. */
const BAR = { room: 62, gap: 12, wide: 11 };
/** The least and the most height of a slice, as a share of its width: with equal scales, it has its own. */
const SHAPE = { least: 0.45, most: 1.25, other: 0.85 };

export class SlicePanel {
  private readonly fields = new Map<string, HTMLInputElement | HTMLSelectElement>();
  private readonly canvas = element("canvas", {
    tabIndex: 0, role: "img", id: "slice-canvas",
    "aria-label": "Slice of the workspace. Arrow keys move the platform by a step of the grid.",
  });
  private readonly count = element("output", { id: "slice-count" });
  private readonly share = element("output", { id: "slice-share" });
  private readonly area = element("output", { id: "slice-measure" });
  private readonly whole = element("output", { id: "whole-count" });
  private readonly wholeShare = element("output", { id: "whole-share" });
  private readonly beyond = element("p", { className: "unit", id: "whole-beyond" });
  private state!: SliceState;
  private description!: Description;
  /** What is drawn; nothing where it cannot be computed. */
  shown: Shown | null = null;
  /** A kind of workspace whose boundary is drawn too, where it has the coordinates of the slice. */
  private kind: KindCount | null = null;
  private pose: Record<string, number> = {};
  private drawing = false;
  /** The pixels of a slice, and what they were made of. */
  private made: { shown: Shown; reach: string; picture: HTMLCanvasElement } | null = null;

  constructor(private readonly events: SliceEvents) {
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    this.canvas.addEventListener("pointerdown", (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      this.point(event, false);
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (this.canvas.hasPointerCapture(event.pointerId)) this.point(event, false);
    });
    this.canvas.addEventListener("pointerup", (event) => this.point(event, true));
    this.canvas.addEventListener("keydown", (event) => this.step(event));
  }

  build(description: Description): void {
    this.description = description;
    this.shown = null;
    const names = description.coordinates.map((coordinate) => coordinate.name);
    const choice = (id: "slice-x" | "slice-y", label: string) => {
      const select = element("select", { id, "aria-label": label }, ...names.map((name) => element("option", { value: name }, name)));
      select.addEventListener("change", () => this.choose(id === "slice-x" ? "x" : "y", select.value));
      this.fields.set(id, select);
      return select;
    };
    const end = (name: End, label: string) => {
      const input = element("input", { type: "number", step: "any", id: `slice-${name}`, "aria-label": label });
      input.addEventListener("change", () => {
        const value = numberIn(input);
        const ends = { ...this.state.ends };
        if (value === undefined) delete ends[name];
        else ends[name] = value;
        this.events.sliced({ ...this.state, ends }, true);
      });
      this.fields.set(`slice-${name}`, input);
      return input;
    };
    const points = (name: "nx" | "ny", label: string) => {
      const input = element("input", { type: "number", min: "1", max: String(MOST_POINTS), step: "1", id: `slice-${name}`, "aria-label": label });
      input.addEventListener("change", () => {
        const value = numberIn(input) ?? POINTS;
        const right = countable(value);
        this.events.refused(right ? null : `${label}: ${value}, expected a whole number from 1 to ${MOST_POINTS}. The slice is as before.`);
        this.events.sliced({ ...this.state, [name]: right ? value : this.state[name] }, true);
      });
      this.fields.set(`slice-${name}`, input);
      return input;
    };
    const colour = element("select", { id: "slice-colour" }, element("option", { value: "none" }, "in reach"),
      ...Object.entries(NUMBERS).map(([value, name]) => element("option", { value }, name)),
      ...description.joints.map(({ name, kind }) => element("option", { value: name }, `${name} (${kind})`)));
    colour.addEventListener("change", () => this.events.sliced({ ...this.state, colour: colour.value }, true));
    this.fields.set("slice-colour", colour);
    const fact = (name: string, value: HTMLElement) => [element("dt", {}, name), element("dd", {}, value)];
    const axis = (arrow: string, name: HTMLElement, ...numbers: HTMLElement[]) =>
      element("div", { className: "axis" }, element("span", {}, arrow), name, element("div", {}, ...numbers));
    const facts = (...all: HTMLElement[][]) => element("dl", { className: "facts" }, ...all.flat());
    const one = names.length < 2;
    byId("slice").replaceChildren(
      element("p", { className: "unit", hidden: !one }, "A slice needs two coordinates: this mechanism has one."),
      element("div", { hidden: one },
        axis("→", choice("slice-x", "Coordinate across"), end("xmin", "Lowest value across"), end("xmax", "Highest value across"),
          points("nx", "Number of values across")),
        axis("↑", choice("slice-y", "Coordinate upwards"), end("ymin", "Lowest value upwards"), end("ymax", "Highest value upwards"),
          points("ny", "Number of values upwards")),
        this.canvas,
        element("p", { className: "row" }, element("label", { for: "slice-colour" }, "Colour"), colour),
        facts(fact("Poses of the slice", this.count), fact("Share", this.share), fact("Measure", this.area))),
      facts(fact("Poses of the whole", this.whole), fact("Size of the whole in coordinates", this.wholeShare)),
      this.beyond,
    );
    this.whole.textContent = "counting…";
    this.wholeShare.textContent = "";
  }

  /** Takes the state of the slice and the pose through which it goes. */
  update(state: SliceState, axes: { x: AxisRequest; y: AxisRequest } | null, pose: Record<string, number>): void {
    [this.state, this.pose] = [state, pose];
    if (axes) {
      const { x, y } = axes;
      const values: Record<string, number> = { xmin: x.min, xmax: x.max, nx: x.count, ymin: y.min, ymax: y.max, ny: y.count };
      for (const [name, value] of Object.entries(values)) show(this.fields.get(`slice-${name}`) as HTMLInputElement, value);
      this.fields.get("slice-x")!.value = x.name;
      this.fields.get("slice-y")!.value = y.name;
    }
    this.fields.get("slice-colour")!.value = state.colour;
    this.draw();
  }

  /** Takes a slice; nothing where it was refused. */
  setSlice(shown: Shown | null): void {
    this.shown = shown;
    if (!shown) {
      for (const one of [this.count, this.share, this.area]) one.textContent = "–";
      this.draw();
      return;
    }
    const { poses, reachable, measure, unit } = shown.slice;
    this.count.textContent = `${reachable} of ${poses}`;
    this.share.textContent = `${((100 * reachable) / poses).toPrecision(4)} %`;
    this.area.textContent = `${short(measure)} ${unit}`;
    this.draw();
  }

  setWhole(counted: Counted | null): void {
    this.whole.textContent = counted ? `${grouped(counted.reachable)} of ${grouped(counted.poses)}` : "counting…";
    this.wholeShare.textContent = counted ? `${short(counted.measure)} ${counted.unit}` : "";
  }

  /** The coordinates along which the workspace goes beyond the grid. */
  setBeyond(names: string[]): void {
    this.beyond.textContent = beyond(names);
  }

  setKind(kind: KindCount | null): void {
    if (kind === this.kind) return;
    this.kind = kind;
    this.draw();
  }

  /** The slice as a picture: its pixels where they are coloured, its boundary, axes and the bar of colours. */
  svg(): string {
    if (!this.shown) return "";
    const { x, y, slice } = this.shown;
    const bar = this.bar();
    const [[xLow, xHigh], [yLow, yHigh]] = [this.ends(x), this.ends(y)];
    const width = 600 - 60 - 20 - (bar ? BAR.room : 0);
    const height = Math.round(width * this.shape());
    const [all, below] = [60 + width + 20 + (bar ? BAR.room : 0), 20 + height];
    const across = (value: number) => 60 + ((value - xLow) / (xHigh - xLow)) * width;
    const upwards = (value: number) => below - ((value - yLow) / (yHigh - yLow)) * height;
    const path = slice.rings.map((ring) => {
      const corners: string[] = [];
      for (let i = 0; i + 1 < ring.length; i += 2) corners.push(`${across(ring[i]!).toFixed(2)},${upwards(ring[i + 1]!).toFixed(2)}`);
      return `M${corners.join("L")}Z`;
    });
    const text = (at: number, from: number, anchor: string, content: string) => `<text x="${at.toFixed(1)}" y="${from.toFixed(1)}" text-anchor="${anchor}">${content}</text>`;
    const box = (at: number, wide: number) => `<rect x="${at}" y="20" width="${wide}" height="${height}" fill="none" stroke="#59636e"/>`;
    const image = (at: number, wide: number, pixels: HTMLCanvasElement) =>
      `<image x="${at}" y="20" width="${wide}" height="${height}" preserveAspectRatio="none" style="image-rendering:pixelated" href="${pixels.toDataURL()}"/>`;
    const marks = [
      ...nice(x.min, x.max).map((value) => text(across(value), below + 20, "middle", short(value))),
      ...nice(y.min, y.max).map((value) => text(54, upwards(value) + 4, "end", short(value))),
    ];
    if (bar) {
      const from = 60 + width + BAR.gap;
      marks.push(image(from, BAR.wide, scaleColumn()), box(from, BAR.wide), text(from + BAR.wide, 13, "end", escaped(bar.title)));
      for (const value of bar.ticks) marks.push(text(from + BAR.wide + 5, below - bar.place(value) * height + 4, "start", short(value)));
    }
    return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${all} ${below + 50}" font-family="sans-serif" font-size="12">
${bar ? image(60, width, this.picture("#8fc1e3")) : ""}
<path d="${path.join("")}" fill="${bar ? "none" : "#8fc1e3"}" stroke="#0062a3" fill-rule="evenodd"/>
${box(60, width)}
${marks.join("\n")}
${text(60 + width / 2, below + 40, "middle", `${x.name} (${this.unit(x.name)})`)}
<text x="14" y="${20 + height / 2}" text-anchor="middle" transform="rotate(-90 14 ${20 + height / 2})">${y.name} (${this.unit(y.name)})</text>
</svg>
`;
  }

  /** The height of the slice as a share of its width: both axes have one scale where they are of one unit. */
  private shape(): number {
    const { x, y } = this.shown!;
    const [wide, high] = [x, y].map((axis) => this.ends(axis)).map(([low, top]) => top - low) as [number, number];
    return this.unit(x.name) === this.unit(y.name) && wide > 0 && high > 0 ? Math.min(10, Math.max(0.1, high / wide)) : SHAPE.other;
  }

  /** The numbers beside the bar of colours; nothing where there are no colours. */
  private bar() {
    const { by, range: { min, max, unit } } = this.shown?.colours ?? { by: "", range: { min: null, max: null, unit: "" } };
    if (min === null || max === null) return null;
    const place = (value: number) => (value - min) / (max - min || 1);
    return { title: unit ? `${by} (${unit})` : by, ticks: nice(min, max), place };
  }

  private unit(name: string): string {
    return this.description.coordinates.find((coordinate) => coordinate.name === name)?.unit ?? "";
  }

  private choose(which: "x" | "y", name: string): void {
    const other = which === "x" ? "y" : "x";
    const before = { x: (this.fields.get("slice-x") as HTMLSelectElement), y: (this.fields.get("slice-y") as HTMLSelectElement) };
    const ends = { ...this.state.ends };
    delete ends[`${which}min`];
    delete ends[`${which}max`];
    const state = { ...this.state, ends, [which]: name };
    // A coordinate cannot be on both axes: they change places.
    if (before[other].value === name) {
      state[other] = this.shown ? this.shown[which].name : null;
      delete ends[`${other}min`];
      delete ends[`${other}max`];
    }
    this.events.sliced(state, true);
  }

  /** What is left free above the slice and beside it: colours have a bar with a title. */
  private margins() {
    const bar = this.bar() !== null;
    return { above: MARGIN.top + (bar ? 12 : 0), beside: MARGIN.left + MARGIN.right + (bar ? BAR.room : 0) };
  }

  /** The rectangle of the canvas that the slice is drawn in: a cell for each pose. */
  private frame() {
    const { clientWidth, clientHeight } = this.canvas;
    const { above: top, beside } = this.margins();
    const { left, bottom } = MARGIN;
    const most = { width: Math.max(1, clientWidth - beside), height: Math.max(1, clientHeight - top - bottom) };
    const shape = this.shape();
    const width = Math.min(most.width, most.height / shape);
    return { left: left + (most.width - width) / 2, top, width, height: width * shape };
  }

  private ends(axis: AxisRequest): [number, number] {
    const half = axis.count > 1 ? (axis.max - axis.min) / (axis.count - 1) / 2 : 0.5;
    return [axis.min - half, axis.max + half];
  }

  private point(event: PointerEvent, final: boolean): void {
    if (!this.shown) return;
    const { x, y } = this.shown;
    const { left, top, width, height } = this.frame();
    const box = this.canvas.getBoundingClientRect();
    const at = (axis: AxisRequest, share: number) => {
      const [low, high] = this.ends(axis);
      const value = Math.min(axis.max, Math.max(axis.min, low + share * (high - low)));
      return Number(value.toPrecision(5));
    };
    const across = at(x, (event.clientX - box.left - left) / width);
    const upwards = at(y, 1 - (event.clientY - box.top - top) / height);
    this.events.placed({ [x.name]: across, [y.name]: upwards }, final);
  }

  private step(event: KeyboardEvent): void {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] }[event.key];
    if (!way || !this.shown) return;
    event.preventDefault();
    const values: Record<string, number> = {};
    [this.shown.x, this.shown.y].forEach((axis, number) => {
      const step = axis.count > 1 ? (axis.max - axis.min) / (axis.count - 1) : 0;
      values[axis.name] = Number(((this.pose[axis.name] ?? 0) + way[number]! * step).toPrecision(9));
    });
    this.events.placed(values, true);
  }

  /** Draws at the next frame. */
  draw(): void {
    if (this.drawing) return;
    this.drawing = true;
    requestAnimationFrame(() => this.render());
  }

  private render(): void {
    this.drawing = false;
    if (this.shown) {
      // A slice takes no more room than it needs.
      const high = Math.min(SHAPE.most, Math.max(SHAPE.least, this.shape()));
      const { above, beside } = this.margins();
      const { clientWidth: wide } = this.canvas;
      this.canvas.style.height = `${Math.round((wide - beside) * high + above + MARGIN.bottom)}px`;
    }
    const { clientWidth, clientHeight } = this.canvas;
    const context = this.canvas.getContext("2d");
    if (!context || !clientWidth) return;
    const ratio = devicePixelRatio;
    const [wide, high] = [Math.round(clientWidth * ratio), Math.round(clientHeight * ratio)];
    if (this.canvas.width !== wide) this.canvas.width = wide;
    if (this.canvas.height !== high) this.canvas.height = high;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const theme = getComputedStyle(document.documentElement);
    const ink = (name: string) => theme.getPropertyValue(`--${name}`).trim();
    context.fillStyle = ink("ground");
    context.fillRect(0, 0, clientWidth, clientHeight);
    if (!this.shown) return;
    const { x, y, slice } = this.shown;
    const { left, top, width, height } = this.frame();
    const [[xLow, xHigh], [yLow, yHigh]] = [this.ends(x), this.ends(y)];
    const across = (value: number) => left + ((value - xLow) / (xHigh - xLow)) * width;
    const upwards = (value: number) => top + height - ((value - yLow) / (yHigh - yLow)) * height;

    context.imageSmoothingEnabled = false;
    context.drawImage(this.picture(ink("reach")), left, top, width, height);
    context.save();
    context.beginPath();
    context.rect(left, top, width, height);
    context.clip();
    const outline = (rings: number[][], swapped: boolean) => {
      context.beginPath();
      for (const ring of rings) {
        for (let i = 0; i + 1 < ring.length; i += 2) {
          const [a, b] = swapped ? [ring[i + 1]!, ring[i]!] : [ring[i]!, ring[i + 1]!];
          context[i ? "lineTo" : "moveTo"](across(a), upwards(b));
        }
        context.closePath();
      }
      context.stroke();
    };
    context.strokeStyle = ink("edge");
    context.lineWidth = 1.4;
    outline(slice.rings, false);
    if (this.kind && same([...this.kind.varying].sort(), [x.name, y.name].sort())) {
      context.strokeStyle = ink("kind");
      context.lineWidth = 2;
      context.setLineDash([7, 4]);
      outline(this.kind.rings, this.kind.varying[0] !== x.name);
      context.setLineDash([]);
    }
    // The pose.
    const [px, py] = [across(this.pose[x.name] ?? 0), upwards(this.pose[y.name] ?? 0)];
    context.strokeStyle = ink("mark");
    context.lineWidth = 1.6;
    context.beginPath();
    context.arc(px, py, 5, 0, 2 * Math.PI);
    for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]] as const) {
      context.moveTo(px + 5 * dx, py + 5 * dy);
      context.lineTo(px + 11 * dx, py + 11 * dy);
    }
    context.stroke();
    context.restore();

    context.strokeStyle = ink("line");
    context.strokeRect(left + 0.5, top + 0.5, width - 1, height - 1);
    context.fillStyle = ink("quiet");
    context.font = "11.5px system-ui, sans-serif";
    context.textAlign = "center";
    for (const value of nice(x.min, x.max)) context.fillText(short(value), across(value), top + height + 14);
    context.fillText(`${x.name} (${this.unit(x.name)})`, left + width / 2, top + height + 29);
    context.textAlign = "right";
    for (const value of nice(y.min, y.max)) context.fillText(short(value), left - 5, upwards(value) + 4);
    context.save();
    context.translate(left - 41, top + height / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    context.fillText(`${y.name} (${this.unit(y.name)})`, 0, 0);
    context.restore();
    const bar = this.bar();
    if (!bar) return;
    const from = left + width + BAR.gap;
    context.drawImage(scaleColumn(), from, top, BAR.wide, height);
    context.strokeRect(from + 0.5, top + 0.5, BAR.wide - 1, height - 1);
    context.textAlign = "right";
    context.fillText(bar.title, from + BAR.wide + 34, top - 7);
    context.textAlign = "left";
    for (const value of bar.ticks) context.fillText(short(value), from + BAR.wide + 5, top + height - bar.place(value) * height + 4);
  }

  /** A pixel for each pose. */
  private picture(reach: string): HTMLCanvasElement {
    const shown = this.shown!;
    if (this.made?.shown === shown && this.made.reach === reach) return this.made.picture;
    const { x, y, mask, colours } = shown;
    const picture = element("canvas", { width: x.count, height: y.count });
    const context = picture.getContext("2d")!;
    const image = context.createImageData(x.count, y.count);
    const pixels = new Uint32Array(image.data.buffer);
    const plain = pixel([1, 3, 5].map((at) => parseInt(reach.slice(at, at + 2), 16)));
    const { min, max } = colours?.range ?? { min: null, max: null };
    for (let row = 0; row < y.count; row++) {
      for (let column = 0; column < x.count; column++) {
        const number = row * x.count + column;
        if (!mask[number]) continue;
        const value = colours?.numbers[number] ?? NaN;
        const share = min !== null && max !== null && !Number.isNaN(value) ? (value - min) / (max - min || 1) : null;
        // The first row of the picture is at the top.
        pixels[(y.count - 1 - row) * x.count + column] = share === null ? plain : pixel(cividis(share));
      }
    }
    context.putImageData(image, 0, 0);
    this.made = { shown, reach, picture };
    return picture;
  }
}

/** A text as SVG has it: names of joints are those of a file. */
const escaped = (name: string) => name.replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);

function same(one: string[], other: string[]): boolean {
  return one.join() === other.join();
}
