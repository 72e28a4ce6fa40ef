// Motions of the platform: chosen or dropped, followed by the library, and played.

import { byId, element, short } from "./dom";
import { plot, timeAt, type Curve } from "./plot";
import { Sinusoids } from "./sinusoids";
import type { MotionState } from "./state";
import type { Description, FittedAxis, Followed, ShippedMotion } from "./types";

/** A motion file. */
export interface MotionFile {
  name: string;
  text: string;
}

export interface PlayEvents {
  /** A person chose another motion, or none. */
  chosen(motion: MotionState | null): void;
  /** The platform is to be at this pose, in the mode of the motion. */
  placed(pose: Record<string, number>, mode: string, final: boolean): void;
  /** There is no motion of this name for the mechanism. */
  unknown(name: string): void;
  pose(): Record<string, number>;
}

/** Most violations that are listed. */
const MOST = 20;
const OWN = "sinusoids";

export class Player {
  private readonly select = byId<HTMLSelectElement>("motion");
  private readonly slider = byId<HTMLInputElement>("time");
  private readonly button = byId<HTMLButtonElement>("play");
  private readonly joint = byId<HTMLSelectElement>("plot-joint");
  private readonly canvas = byId<HTMLCanvasElement>("motion-plot");
  private readonly sinusoids = new Sinusoids(() => this.choose());
  private shipped: ShippedMotion[] = [];
  private dropped: MotionFile | null = null;
  private description: Description | null = null;
  private followed: { about: Followed; rows: Float32Array } | null = null;
  private curve: Curve | null = null;
  private playing = false;
  private drawing = false;
  /** The motion that is to be followed. */
  file: MotionFile | null = null;
  private chosen: MotionState | null = null;

  constructor(private readonly events: PlayEvents) {
    this.select.addEventListener("change", () => this.choose());
    this.button.addEventListener("click", () => (this.playing ? this.stop() : this.run()));
    this.slider.addEventListener("input", () => this.seek(this.slider.valueAsNumber, false));
    this.slider.addEventListener("change", () => this.seek(this.slider.valueAsNumber, true));
    this.joint.addEventListener("change", () => this.setCurve());
    for (const name of ["pointerdown", "pointermove"] as const) {
      this.canvas.addEventListener(name, (event) => {
        if (!event.buttons || !this.curve) return;
        this.stop();
        this.seek(timeAt(this.canvas, this.curve, event.clientX), false);
      });
    }
    this.canvas.addEventListener("pointerup", () => this.seek(this.slider.valueAsNumber, true));
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  /** The motions for a mechanism, and the one that is chosen. */
  build(description: Description, shipped: ShippedMotion[], motion: MotionState | null): void {
    this.stop();
    this.description = description;
    this.shipped = shipped.filter(({ mechanism }) => description.name.startsWith(mechanism));
    this.joint.replaceChildren(...description.joints.map(({ name, unit }, i) => element("option", { value: String(i) }, `${name} (${unit})`)));
    this.sinusoids.build(description.coordinates, []);
    this.take(motion);
  }

  /** Follows the motion of the state, if it is another one. */
  update(motion: MotionState | null): void {
    if (this.description && JSON.stringify(motion) !== JSON.stringify(this.chosen)) this.take(motion);
  }

  private take(motion: MotionState | null): void {
    this.dropped = motion && motion.text !== null ? { name: motion.name, text: motion.text } : null;
    this.list();
    this.select.value = motion?.name ?? "";
    const found = this.select.selectedIndex >= 0;
    if (!found) this.select.value = "";
    if (motion && found) byId<HTMLDetailsElement>("motions").open = true;
    this.start();
    this.chosen = found ? motion : null;
    if (motion && !found) this.events.unknown(motion.name);
  }

  setRanges(axes: FittedAxis[]): void {
    if (this.description) this.sinusoids.build(this.description.coordinates, axes);
  }

  /** Takes a file that was dropped, and plays it. */
  open(file: MotionFile): void {
    this.dropped = file;
    this.list();
    this.select.value = file.name;
    byId<HTMLDetailsElement>("motions").open = true;
    this.choose();
  }

  /** Follows the chosen motion, which becomes that of the state. */
  private choose(): void {
    this.start();
    const shipped = this.shipped.some(({ name }) => name === this.select.value);
    this.chosen = shipped ? { name: this.select.value, text: null } : this.file;
    this.events.chosen(this.chosen);
  }

  private list(): void {
    const chosen = this.select.value;
    const options = [element("option", { value: "" }, "none"),
      ...this.shipped.map(({ name, description }) => element("option", { value: name, title: description }, name)),
      element("option", { value: OWN }, "sinusoids of your own"),
      ...(this.dropped ? [element("option", { value: this.dropped.name }, this.dropped.name)] : [])];
    this.select.replaceChildren(...options);
    this.select.value = chosen;
  }

  /** The chosen motion, which is to be followed from its start. */
  private start(): void {
    this.stop();
    const { value } = this.select;
    byId("sinusoids").hidden = value !== OWN;
    const shipped = this.shipped.find(({ name }) => name === value);
    this.file = value === "" || !this.description ? null
      : shipped ? { name: `${shipped.name}.toml`, text: shipped.text }
        : value === OWN ? { name: "sinusoids.toml", text: this.sinusoids.file(this.events.pose(), this.description) }
          : this.dropped;
    this.set(null, null);
  }

  /** Takes a motion as the mechanism follows it. */
  set(about: Followed | null, bytes: Uint8Array<ArrayBuffer> | null): void {
    this.followed = about && bytes ? { about, rows: new Float32Array(bytes.buffer, bytes.byteOffset, bytes.byteLength / 4) } : null;
    byId("player").hidden = !this.followed;
    if (!about || !this.followed) return;
    const { rows } = this.followed;
    const [first, last] = [rows[0]!, rows[rows.length - about.columns]!];
    const before = this.slider.valueAsNumber;
    [this.slider.min, this.slider.max, this.slider.step] = [String(first), String(last), "any"];
    this.slider.value = String(Math.min(last, Math.max(first, before)));
    const count = about.violation_count;
    byId("motion-summary").textContent = count
      ? `The mechanism cannot follow all of it: ${count} violation${count > 1 ? "s" : ""}, ${about.valid} of ${about.samples} samples are within reach and limits.`
      : `The mechanism follows all ${about.samples} samples, in mode ${about.mode || "the only one"}.`;
    byId("motion-summary").classList.toggle("wrong", count > 0);
    byId("violations").replaceChildren(...about.violations.slice(0, MOST).map(({ start, end, text }) => {
      const span = end > start ? `${short(start)} to ${short(end)} s` : `${short(start)} s`;
      const button = element("button", { type: "button" }, `${span}: ${text}`);
      button.addEventListener("click", () => this.seek(start, true));
      return element("li", {}, button);
    }), ...(count > MOST ? [element("li", {}, `and ${count - MOST} more`)] : []));
    this.setCurve();
  }

  private setCurve(): void {
    if (!this.followed || !this.description) return;
    const { about: { columns, violations }, rows } = this.followed;
    const number = Number(this.joint.value);
    const joint = this.description.joints[number];
    if (!joint) return;
    const column = 1 + this.description.coordinates.length + number;
    const count = rows.length / columns;
    const of = (place: number) => Float32Array.from({ length: count }, (_, i) => rows[i * columns + place]!);
    // Whatever is wrong with the whole, or with this joint.
    const wrong = violations.filter(({ joint: of }) => of === null || of === joint.name);
    this.curve = { label: `${joint.name} (${joint.unit})`, times: of(0), values: of(column), limits: joint.limits, wrong };
    this.draw();
  }

  private run(): void {
    if (!this.followed) return;
    this.playing = true;
    this.button.textContent = "Pause";
    const [first, last] = [Number(this.slider.min), Number(this.slider.max)];
    let time = this.slider.valueAsNumber >= last ? first : this.slider.valueAsNumber;
    let before = performance.now();
    const frame = (now: number) => {
      if (!this.playing) return;
      time += Math.min(0.1, Math.max(0, now - before) / 1000);
      before = now;
      if (time >= last) {
        this.seek(last, true);
        this.stop();
        return;
      }
      this.seek(time, false);
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  stop(): void {
    if (this.playing) this.seek(this.slider.valueAsNumber, true);
    this.playing = false;
    this.button.textContent = "Play";
  }

  /** Goes to a time of the motion. */
  private seek(time: number, final: boolean): void {
    if (!this.followed || !this.description) return;
    const { about: { columns, mode }, rows } = this.followed;
    const last = rows.length / columns - 1;
    const [from, to] = [rows[0]!, rows[last * columns]!];
    // Samples are at equal steps, but for the last one.
    const step = last > 0 ? rows[columns]! - from : 1;
    const place = Math.min(last, Math.max(0, (time - from) / (step || 1)));
    const [row, share] = [Math.min(Math.floor(place), Math.max(0, last - 1)), place - Math.min(Math.floor(place), Math.max(0, last - 1))];
    const pose = Object.fromEntries(this.description.coordinates.map(({ name }, i) => {
      const [a, b] = [rows[row * columns + 1 + i]!, rows[Math.min(last, row + 1) * columns + 1 + i]!];
      return [name, Number((a + (b - a) * share).toPrecision(6))];
    }));
    const shown = Math.min(to, Math.max(from, time));
    this.slider.value = String(shown);
    byId("time-value").textContent = `${shown.toFixed(2)} s`;
    this.draw();
    this.events.placed(pose, mode, final);
  }

  /** Draws at the next frame. */
  draw(): void {
    if (this.drawing) return;
    this.drawing = true;
    requestAnimationFrame(() => {
      this.drawing = false;
      plot(this.canvas, this.curve, this.slider.valueAsNumber);
    });
  }
}
