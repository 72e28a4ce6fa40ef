// The workspace: a plane slice through it, drawn, counted, and clicked to move the platform.

import { beyond } from "./beyond";
import { byId, element, grouped, numberIn, short, show } from "./dom";
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
  private readonly scale = element("p", { className: "unit", id: "slice-scale" });
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
      element("option", { value: "condition" }, "1 / condition number"),
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
        this.scale,
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
      this.scale.textContent = "";
      this.draw();
      return;
    }
    const { poses, reachable, measure, unit } = shown.slice;
    this.count.textContent = `${reachable} of ${poses}`;
    this.share.textContent = `${((100 * reachable) / poses).toPrecision(4)} %`;
    this.area.textContent = `${short(measure)} ${unit}`;
    const { colours } = shown;
    this.scale.textContent = colours && colours.range.min !== null && colours.range.max !== null
      ? `dark ${short(colours.range.min)} to bright ${short(colours.range.max)} ${colours.range.unit}` : "";
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

  /** The boundary of the slice as a picture. */
  svg(): string {
    if (!this.shown) return "";
    const { x, y, slice } = this.shown;
    const [width, height] = [600, 500];
    const across = (value: number) => 60 + ((value - x.min) / (x.max - x.min || 1)) * (width - 80);
    const upwards = (value: number) => height - 50 - ((value - y.min) / (y.max - y.min || 1)) * (height - 70);
    const path = slice.rings.map((ring) => {
      const corners: string[] = [];
      for (let i = 0; i + 1 < ring.length; i += 2) corners.push(`${across(ring[i]!).toFixed(2)},${upwards(ring[i + 1]!).toFixed(2)}`);
      return `M${corners.join("L")}Z`;
    });
    const ticks = [
      ...nice(x.min, x.max).map((value) => `<text x="${across(value).toFixed(1)}" y="${height - 30}" text-anchor="middle">${short(value)}</text>`),
      ...nice(y.min, y.max).map((value) => `<text x="54" y="${(upwards(value) + 4).toFixed(1)}" text-anchor="end">${short(value)}</text>`),
    ];
    return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" font-family="sans-serif" font-size="12">
<path d="${path.join("")}" fill="#8fc1e3" stroke="#0062a3" fill-rule="evenodd"/>
<rect x="60" y="20" width="${width - 80}" height="${height - 70}" fill="none" stroke="#59636e"/>
${ticks.join("\n")}
<text x="${width / 2}" y="${height - 10}" text-anchor="middle">${x.name} (${this.unit(x.name)})</text>
<text x="14" y="${height / 2}" text-anchor="middle" transform="rotate(-90 14 ${height / 2})">${y.name} (${this.unit(y.name)})</text>
</svg>
`;
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

  /** The rectangle of the canvas that the slice is drawn in: a cell for each pose. */
  private frame() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const { left, right, top, bottom } = MARGIN;
    return { left, top, width: Math.max(1, width - left - right), height: Math.max(1, height - top - bottom) };
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
    context.translate(11, top + height / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    context.fillText(`${y.name} (${this.unit(y.name)})`, 0, 0);
    context.restore();
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
        const share = colours && min !== null && max !== null ? (colours.numbers[number]! - min) / (max - min || 1) : null;
        // The first row of the picture is at the top.
        pixels[(y.count - 1 - row) * x.count + column] = share === null ? plain : pixel(cividis(share));
      }
    }
    context.putImageData(image, 0, 0);
    this.made = { shown, reach, picture };
    return picture;
  }
}

function same(one: string[], other: string[]): boolean {
  return one.join() === other.join();
}

/** Red, green and blue as the pixel of a canvas. */
function pixel([red = 0, green = 0, blue = 0]: number[]): number {
  return ((255 << 24) | (blue << 16) | (green << 8) | red) >>> 0;
}

/** Round numbers between two ends, about five of them. */
export function nice(low: number, high: number): number[] {
  if (!(high > low)) return [low];
  const rough = (high - low) / 5;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5, 10].find((times) => times * power >= rough) ?? 10);
  const ticks: number[] = [];
  for (let i = Math.ceil(low / step); i * step <= high * (1 + 1e-9) + 1e-12; i++) ticks.push(Number((i * step).toPrecision(10)));
  return ticks;
}

/** Colours from dark to bright that everybody tells apart: points of the scale cividis (Nunez, Anderton, Renslow 2018). */
const SCALE = [[0, 32, 77], [60, 77, 110], [124, 123, 120], [187, 173, 108], [255, 234, 70]];

function cividis(share: number): number[] {
  const place = Math.min(1, Math.max(0, share)) * (SCALE.length - 1);
  const low = Math.min(SCALE.length - 2, Math.floor(place));
  return SCALE[low]!.map((value, i) => Math.round(value + (SCALE[low + 1]![i]! - value) * (place - low)));
}

