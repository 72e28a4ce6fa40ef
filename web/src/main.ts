// The page: what was asked for is the state, and two workers follow it. One solves poses, the other counts workspaces, so
// that a long count never holds up the view.

import { DimensionPanel } from "./dimensions";
import { byId, element, save, short } from "./dom";
import { Engine, Refused, unpack } from "./engine";
import { JointTable } from "./joints";
import { PosePanel } from "./pose";
import { SlicePanel, type Shown } from "./slice";
import { fromAddress, initial, toAddress, type State } from "./state";
import type {
  Assembly, AxisRequest, Colours, Counted, Description, Example, Fitted, Posture, Problem, Slice,
} from "./types";
import { COLOURS, PARTS, PART_NAMES } from "./colours";
import { View } from "./view";

/** The mechanism file that the page carries. */
interface PageFile {
  name: string;
  text: string;
}

/** One worker, and what it was last told. */
interface Follower {
  engine: Engine;
  /** The text that is open there, and its changes. */
  text: string | null;
  changes: string;
}

class Page {
  private state: State = initial();
  private description: Description | null = null;
  private posture: Posture | null = null;
  private fitted: Fitted | null = null;
  private counted: Counted | null = null;
  private examples: Example[] = [];
  private assemblies: Assembly[] = [];
  private assembly = -1;
  private readonly poser: Follower;
  private readonly sweeper: Follower;
  private readonly view = new View(byId("view"));
  private readonly pose = new PosePanel({ moved: (name, value, final) => this.move({ [name]: value }, final) });
  private readonly joints = new JointTable({ driven: (name, value) => void this.drive(name, value) });
  private readonly dimensions = new DimensionPanel({
    changed: (name, values, final) => this.change({ ...this.state.changes, [name]: values }, final),
  });
  private readonly slice = new SlicePanel({
    sliced: (slice, final) => this.set({ slice }, final),
    placed: (values, final) => this.move(values, final),
  });
  private undone: Record<string, number[]>[] = [];
  private done: Record<string, number[]>[] = [];
  /** The changes at the last step that can be undone. */
  private settled: Record<string, number[]> = {};
  private running = { pose: false, sweep: false };
  /** The number of joints that are being driven. */
  private driving = 0;
  private again = { pose: false, sweep: false };
  private address = "";
  /** What each worker has done, as keys. */
  private donePose = "";
  private doneSlice = "";
  private doneWhole = "";
  private doneColours = "";
  private fittedFor = "";
  private problems: Problem[] = [];
  /** Problems that are still to be shown after the next mechanism is. */
  private kept: Problem[] = [];
  /** The name of the file that could not be opened. */
  private name = "";
  /** The state with which the mechanism that is shown was opened or changed. */
  private good: State | null = null;

  constructor(private readonly carried: PageFile | null, worker: string, library: ArrayBuffer) {
    const follower = () => ({ engine: new Engine(worker, library), text: null, changes: "" });
    [this.poser, this.sweeper] = [follower(), follower()];
  }

  async start(): Promise<void> {
    this.buildLegend();
    this.connect();
    this.examples = (await this.poser.engine.ask<Example[]>({ do: "examples" })).value;
    byId("examples").append(...this.examples.map(({ name, description }) =>
      element("option", { value: name, title: description }, name)));
    this.state = await fromAddress(location.hash);
    this.settled = this.state.changes;
    this.follow();
  }

  // The state, and how it changes.

  /** Sets a part of the state. A final one is a step that the browser goes back to. */
  private set(patch: Partial<State>, final: boolean): void {
    this.state = { ...this.state, ...patch };
    if (final) void this.remember();
    this.follow();
  }

  private move(values: Record<string, number>, final: boolean): void {
    this.set({ pose: { ...this.state.pose, ...values } }, final);
  }

  private change(changes: Record<string, number[]>, final: boolean): void {
    if (final && !same(changes, this.settled)) {
      this.done.push(this.settled);
      this.undone = [];
      this.settled = changes;
    }
    this.set({ changes }, final);
  }

  /** Goes to the changes before the last ones, or to those after. */
  private undo(from: Record<string, number[]>[], to: Record<string, number[]>[]): void {
    const changes = from.pop();
    if (!changes) return;
    to.push(this.settled);
    this.settled = changes;
    this.set({ changes }, true);
  }

  private open(source: State["source"]): void {
    [this.done, this.undone, this.settled] = [[], [], {}];
    this.set({ ...initial(), source }, true);
  }

  /** Puts the state into the address, as a new step or in place of the last one. */
  private async remember(instead = false): Promise<void> {
    const address = await toAddress(this.state);
    if (address === this.address) return;
    this.address = address;
    if (instead) history.replaceState(null, "", `#${address}`);
    else history.pushState(null, "", `#${address}`);
  }

  /** Takes the state from the address, where the browser has gone back or forward. */
  private async recall(): Promise<void> {
    const hash = location.hash.replace(/^#/, "");
    if (hash === this.address) return;
    this.address = hash;
    this.state = await fromAddress(hash);
    this.settled = this.state.changes;
    this.follow();
  }

  // The workers follow the state.

  /** Shows the state, and lets both workers go after it. */
  private follow(): void {
    document.body.dataset["ready"] = "false";
    this.show();
    void this.run("pose", () => this.stepPose());
    void this.run("sweep", () => this.stepSweep());
  }

  /** Runs steps until there is nothing left to do; a change of the state in the meantime is one more round. */
  private async run(which: "pose" | "sweep", step: () => Promise<void>): Promise<void> {
    this.again[which] = true;
    if (this.running[which]) return;
    this.running[which] = true;
    while (this.again[which]) {
      this.again[which] = false;
      try {
        await step();
      } catch (error) {
        this.fail(error);
      }
    }
    this.running[which] = false;
    this.settle();
  }

  /** Says that all that was asked for has been computed, where this is so. */
  private settle(): void {
    const idle = !this.running.pose && !this.running.sweep && !this.driving;
    document.body.dataset["ready"] = String(idle);
  }

  /** The text of the mechanism file of the state. */
  private text(): PageFile {
    const { source } = this.state;
    if (source.kind === "text") return { name: source.name, text: source.text };
    const wanted = source.kind === "example" ? source.name : undefined;
    const example = this.examples.find(({ name }) => name === wanted) ?? this.examples[0];
    if (wanted === undefined && this.carried) return this.carried;
    return { name: `${example?.name ?? "mechanism"}.toml`, text: example?.text ?? "" };
  }

  /** Opens the mechanism of the state in a worker, or changes it; nothing if it is there already. */
  private async agree(follower: Follower): Promise<Description | null> {
    const [{ text }, changes] = [this.text(), JSON.stringify(this.state.changes)];
    if (follower.text === text && follower.changes === changes) return null;
    const opening = follower.text !== text;
    const asked = this.state.changes;
    if (opening) {
      const { value } = await follower.engine.ask<Description>({ do: "open", text, changes: asked });
      [follower.text, follower.changes] = [text, changes];
      return value;
    }
    // Even if it is refused: the same would be refused again.
    follower.changes = changes;
    return (await follower.engine.ask<Description>({ do: "change", changes: asked })).value;
  }

  private async stepPose(): Promise<void> {
    const before = this.poser.text;
    const asked = this.state;
    const description = await this.agree(this.poser).catch((error: unknown) => {
      if (!(error instanceof Refused) || this.poser.text === this.text().text) throw error;
      this.stay(error.problems);
      return null;
    });
    if (description) {
      this.good = asked;
      this.problems = this.kept;
      this.kept = [];
      if (!this.problems.length) this.name = "";
      this.take(description, before !== this.poser.text);
      // The other worker may have come to it before its coordinates were known here.
      void this.run("sweep", () => this.stepSweep());
    }
    if (!this.description) return;
    const known = new Set(this.description.coordinates.map(({ name }) => name));
    const pose = Object.fromEntries(Object.entries(this.state.pose).filter(([name]) => known.has(name)));
    const key = JSON.stringify([this.poser.text, this.poser.changes, pose, this.state.mode]);
    if (key === this.donePose) return;
    this.donePose = key;
    const { value, bytes } = await this.poser.engine.ask<Posture>({ do: "pose", pose, mode: this.state.mode });
    if (value.reached) {
      this.posture = value;
      this.view.place(bytes);
    }
    if (description && before !== this.poser.text) this.view.fit(false);
    this.showPosture(value);
    this.showProblems();
  }

  private async stepSweep(): Promise<void> {
    const before = this.sweeper.text;
    // The other worker tells what is wrong with the same mechanism.
    const description = await this.agree(this.sweeper).catch((error: unknown) => {
      if (!(error instanceof Refused)) throw error;
      return null;
    });
    if (description && before !== this.sweeper.text) this.fittedFor = "";
    if (!this.description || !this.sweeper.text) return;
    const { mode } = this.state;
    const mechanism = JSON.stringify([this.sweeper.text, this.sweeper.changes, mode]);
    // The grid is fitted once for each mechanism file: while a dimension changes, counts on the same grid are compared.
    if (this.fittedFor !== this.sweeper.text) {
      this.fittedFor = this.sweeper.text;
      [this.fitted, this.counted] = [null, null];
      this.doneWhole = "";
      this.fitted = (await this.sweeper.engine.ask<Fitted>({ do: "fit", mode })).value;
      this.pose.setRanges(this.fitted.axes);
      this.show();
    }
    const axes = this.axes();
    if (axes) await this.stepSlice(mechanism, axes);
    if (this.again.sweep) return;
    if (this.fitted && mechanism !== this.doneWhole) {
      this.doneWhole = mechanism;
      const { value, milliseconds } = await this.sweeper.engine.ask<Counted>({ do: "whole", mode });
      this.counted = value;
      document.body.dataset["wholeMs"] = milliseconds.toFixed(2);
      this.slice.setWhole(value);
      this.joints.update(this.posture, value);
    }
    if (axes && !this.again.sweep) await this.stepColours(axes);
  }

  private shown: Shown | null = null;

  private async stepSlice(mechanism: string, { x, y }: { x: AxisRequest; y: AxisRequest }): Promise<void> {
    const pose = this.others(x, y);
    const key = JSON.stringify([mechanism, x, y, pose]);
    if (key === this.doneSlice) return;
    this.doneSlice = key;
    const { mode } = this.state;
    const { value, bytes, milliseconds } = await this.sweeper.engine.ask<Slice>({ do: "slice", x, y, pose, mode });
    document.body.dataset["sliceMs"] = milliseconds.toFixed(3);
    this.shown = { x, y, slice: value, mask: bytes, colours: null };
    this.doneColours = "";
    this.slice.setSlice(this.shown);
  }

  private async stepColours({ x, y }: { x: AxisRequest; y: AxisRequest }): Promise<void> {
    const by = this.state.slice.colour;
    const key = JSON.stringify([this.doneSlice, by]);
    if (!this.shown || key === this.doneColours) return;
    this.doneColours = key;
    const request = { do: "colours", x, y, pose: this.others(x, y), mode: this.state.mode, by };
    const answer = by === "none" ? null : await this.sweeper.engine.ask<Colours>(request);
    const colours = answer && { by, range: answer.value, numbers: new Float32Array(answer.bytes.buffer) };
    this.shown = { ...this.shown, colours };
    this.slice.setSlice(this.shown);
  }

  /** The coordinates that a slice holds at the pose. */
  private others(x: AxisRequest, y: AxisRequest): Record<string, number> {
    const known = new Set(this.description?.coordinates.map(({ name }) => name));
    const held = Object.entries(this.state.pose).filter(([name]) => known.has(name) && name !== x.name && name !== y.name);
    return Object.fromEntries(held);
  }

  /** The axes of the slice: what was set, and else the range that holds the workspace. */
  private axes(): { x: AxisRequest; y: AxisRequest } | null {
    if (!this.fitted || !this.description) return null;
    const names = this.description.coordinates.map(({ name }) => name);
    const { slice } = this.state;
    const x = slice.x !== null && names.includes(slice.x) ? slice.x : names[0];
    const second = names.find((name) => name !== x);
    const y = slice.y !== null && names.includes(slice.y) && slice.y !== x ? slice.y : second;
    if (x === undefined || y === undefined) return null;
    const axis = (name: string, end: "x" | "y", count: number): AxisRequest => {
      const range = this.fitted?.axes.find((axis) => axis.name === name) ?? { min: -1, max: 1 };
      const wide = range.max > range.min ? range : { min: range.min - 1, max: range.max + 1 };
      return { name, min: slice.ends[`${end}min`] ?? wide.min, max: slice.ends[`${end}max`] ?? wide.max, count };
    };
    return { x: axis(x, "x", slice.nx), y: axis(y, "y", slice.ny) };
  }

  // What is shown.

  private take(description: Description, another: boolean): void {
    const names = ({ coordinates, joints, dimensions }: Description) =>
      JSON.stringify([coordinates, dimensions.map(({ name, values }) => [name, values.length]), joints.map(({ name, limits }) => [name, limits])]);
    const rebuilt = another || !this.description || names(this.description) !== names(description);
    this.description = description;
    document.title = `${description.name} – opm explorer`;
    byId("title").textContent = description.name;
    const { lower, upper, intersection, mobility, imaginary_joints: imaginary } = description;
    const motions = upper.dimension ? `${lower.name} and ${upper.name}, sharing a ${intersection.name}` : lower.name;
    byId("summary").textContent = `Mobility ${mobility}: ${motions}; ${imaginary} imaginary joint${imaginary === 1 ? "" : "s"}`;
    if (another) {
      this.posture = null;
      this.shown = null;
      this.doneSlice = "";
      this.assemblies = [];
      this.pose.build(description);
      this.dimensions.build(description);
      this.slice.build(description);
      byId("mode").replaceChildren(...description.modes.map((mode) =>
        element("option", { value: mode }, mode || "the only one")));
    }
    if (rebuilt) this.joints.build(description);
    this.view.setMechanism(description);
    this.show();
  }

  private show(): void {
    if (!this.description) return;
    const all = Object.fromEntries(this.description.coordinates.map(({ name, home }) => [name, home]));
    this.pose.update(this.state.pose);
    this.dimensions.update(this.description, this.state.changes);
    this.slice.update(this.state.slice, this.axes(), { ...all, ...this.state.pose });
    byId<HTMLSelectElement>("mode").value = this.state.mode ?? this.description.home_mode;
    byId<HTMLButtonElement>("undo").disabled = this.done.length === 0;
    byId<HTMLButtonElement>("redo").disabled = this.undone.length === 0;
    byId<HTMLButtonElement>("reset").disabled = Object.keys(this.state.changes).length === 0;
  }

  /** Shows a posture. One out of reach leaves the last one that was reached, and says what is missing. */
  private showPosture(posture: Posture): void {
    if (!this.description) return;
    const status = byId("status");
    status.classList.toggle("wrong", !posture.within);
    const beyond = posture.beyond.map((number) => {
      const { name, limits, unit } = this.description!.joints[number]!;
      const value = posture.values[number]!;
      const excess = limits ? Math.max(limits[0] - value, value - limits[1]) : 0;
      return `${name} by ${short(excess)} ${unit}`;
    });
    status.textContent = !posture.reached
      ? `Out of reach: ${posture.out_of_reach.map(({ leg, text }) => `${leg}, ${text}`).join("; ")}. The last pose in reach is shown.`
      : beyond.length ? `Beyond limits: ${beyond.join(", ")}` : `In reach, within all limits. ${this.modesText(posture)}`;
    this.joints.update(this.posture, this.counted);
    this.description.dependent.forEach(({ name }, number) => {
      const value = this.posture?.dependent[number];
      byId(`dependent-${name}`).textContent = value === undefined ? "" : short(value);
    });
    const reaching = new Map(posture.modes.map(({ mode, within }) => [mode, within]));
    for (const option of byId<HTMLSelectElement>("mode").options) {
      const within = reaching.get(option.value);
      const note = within === undefined ? "" : within ? " · in reach" : " · beyond limits";
      const text = (option.value || "the only one") + note;
      if (option.textContent !== text) option.textContent = text;
    }
  }

  private modesText({ modes }: Posture): string {
    const within = modes.filter((mode) => mode.within).length;
    return modes.length > 1 ? `${within} of ${this.description!.modes.length} working modes reach this pose within limits.` : "";
  }

  private fail(error: unknown): void {
    const problems = error instanceof Refused ? error.problems : [{ message: `The computation failed: ${String(error)}` }];
    // Both workers refuse the same change.
    if (same(problems, this.problems)) return;
    this.problems = problems;
    this.showProblems();
    // An unknown mode is that of home.
    if (this.state.mode !== null && problems.some(({ message }) => message.includes("mode"))) this.set({ mode: null }, false);
    if (!this.description) byId("status").textContent = "No mechanism is shown.";
  }

  /** Stays at the mechanism that is shown, where another one cannot be opened. */
  private stay(problems: Problem[]): void {
    this.name = this.text().name;
    if (this.good) {
      this.state = this.good;
      void this.remember(true);
    } else if (Object.keys(this.state.changes).length) {
      // A mechanism that a link cannot change is shown as its file has it.
      this.kept = problems;
      this.set({ changes: {} }, false);
    } else byId("status").textContent = "No mechanism is shown.";
    this.problems = problems;
    this.showProblems();
    this.show();
  }

  private showProblems(): void {
    const box = byId("problems");
    box.hidden = this.problems.length === 0;
    if (box.hidden) return;
    const name = this.name || this.text().name;
    const lines = this.problems.map(({ place, message }) => (place ? `${name}:${place[0]}:${place[1]}: ${message}` : message));
    // The mechanism is not what the fields say.
    const refused = this.good !== null && !same(this.good.changes, this.state.changes);
    const note = refused ? "\nWhat is shown is the last mechanism that could be computed." : "";
    const button = element("button", { type: "button" }, refused ? "Undo" : "Close");
    button.addEventListener("click", () => {
      this.problems = [];
      this.name = "";
      if (refused && !same(this.state.changes, this.settled)) this.set({ changes: this.settled }, true);
      else if (refused) this.undo(this.done, this.undone);
      this.showProblems();
    });
    box.replaceChildren(element("div", {}, lines.join("\n") + note), button);
  }

  /** Moves an actuated joint, and the platform to the nearest pose that this allows. */
  private async drive(name: string, value: number): Promise<void> {
    if (!this.description || !this.posture) return;
    const { values } = this.posture;
    const actuated = this.description.joints.map((joint, number) => ({ joint, value: values[number]! }));
    const joints = Object.fromEntries(actuated.filter(({ joint }) => joint.kind === "actuated").map(({ joint, value }) => [joint.name, value]));
    joints[name] = value;
    this.driving++;
    this.settle();
    try {
      const { pose } = this.state;
      const found = (await this.poser.engine.ask<{ assemblies: Assembly[] }>({ do: "forward", joints, pose })).value;
      this.assemblies = found.assemblies;
      if (this.assemblies.length) this.assemble(0);
      else {
        byId("status").classList.add("wrong");
        byId("status").textContent = `No pose of the platform has ${name} = ${short(value)}.`;
      }
    } catch (error) {
      this.fail(error);
    }
    this.driving--;
    this.settle();
  }

  /** Goes to one of the assemblies for the present actuated joints. */
  private assemble(number: number): void {
    const assembly = this.assemblies[number];
    if (!assembly || !this.description) return;
    this.assembly = number;
    const pose = Object.fromEntries(this.description.coordinates.map(({ name }, i) => [name, Number(assembly.pose[i]!.toPrecision(12))]));
    this.set({ pose, mode: assembly.mode === this.description.home_mode ? null : assembly.mode }, true);
    const buttons = this.assemblies.map(({ mode, within }, i) => {
      const button = element("button", { type: "button", "aria-pressed": String(i === this.assembly), title: within ? "within limits" : "beyond limits" },
        `${i + 1}: ${mode || "assembly"}`);
      button.addEventListener("click", () => this.assemble(i));
      return button;
    });
    byId("assemblies").replaceChildren(...(buttons.length > 1 ? buttons : []));
  }

  // Buttons, menus, keys, files.

  private buildLegend(): void {
    byId("legend").append(...PARTS.map((part) => {
      const colour = element("i");
      colour.style.background = COLOURS[part];
      const button = element("button", { type: "button" }, colour, PART_NAMES[part]);
      for (const event of ["pointerenter", "focus"]) button.addEventListener(event, () => this.view.highlight(part));
      for (const event of ["pointerleave", "blur"]) button.addEventListener(event, () => this.view.highlight(null));
      return element("li", {}, button);
    }));
  }

  private connect(): void {
    const click = (id: string, action: () => void) => byId(id).addEventListener("click", action);
    click("home", () => this.set({ pose: {} }, true));
    click("fit", () => this.view.fit());
    click("undo", () => this.undo(this.done, this.undone));
    click("redo", () => this.undo(this.undone, this.done));
    click("reset", () => this.change({}, true));
    click("open", () => byId("file").click());
    click("about", () => byId<HTMLDialogElement>("about-box").showModal());
    click("share", () => void this.share());
    click("theme", () => setTheme(document.documentElement.dataset["theme"] !== "dark", () => this.slice.draw()));
    byId("licences").textContent = byId("opm-licences").textContent;
    byId("mode").addEventListener("change", () => {
      const mode = byId<HTMLSelectElement>("mode").value;
      this.set({ mode: mode === this.description?.home_mode ? null : mode }, true);
    });
    const chosen = (id: string, action: (value: string) => void) => {
      const select = byId<HTMLSelectElement>(id);
      select.addEventListener("change", () => {
        const { value } = select;
        select.value = "";
        if (value) action(value);
      });
    };
    chosen("examples", (name) => this.open({ kind: "example", name }));
    chosen("save", (what) => void this.save(what));
    const input = byId<HTMLInputElement>("file");
    input.addEventListener("change", () => {
      if (input.files?.[0]) void this.openFile(input.files[0]);
      input.value = "";
    });
    window.addEventListener("dragover", (event) => {
      event.preventDefault();
      document.body.classList.add("dropping");
    });
    window.addEventListener("dragleave", (event) => {
      if (!event.relatedTarget) document.body.classList.remove("dropping");
    });
    window.addEventListener("drop", (event) => {
      event.preventDefault();
      document.body.classList.remove("dropping");
      if (event.dataTransfer?.files[0]) void this.openFile(event.dataTransfer.files[0]);
    });
    window.addEventListener("popstate", () => void this.recall());
    window.addEventListener("hashchange", () => void this.recall());
    window.addEventListener("keydown", (event) => {
      if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z" || event.target instanceof HTMLInputElement) return;
      event.preventDefault();
      if (event.shiftKey) this.undo(this.undone, this.done);
      else this.undo(this.done, this.undone);
    });
    byId("view").addEventListener("keydown", (event) => {
      const turn = { ArrowLeft: [0.12, 0], ArrowRight: [-0.12, 0], ArrowUp: [0, 0.12], ArrowDown: [0, -0.12] }[event.key];
      const zoom = { "+": 0.9, "=": 0.9, "-": 1 / 0.9 }[event.key];
      if (turn) this.view.orbit(turn[0]!, turn[1]!);
      else if (zoom) this.view.orbit(0, 0, zoom);
      else if (event.key === "f") this.view.fit();
      else return;
      event.preventDefault();
    });
  }

  private async openFile(file: File): Promise<void> {
    this.open({ kind: "text", name: file.name, text: await file.text() });
  }

  private async share(): Promise<void> {
    await this.remember();
    const button = byId("share");
    try {
      await navigator.clipboard.writeText(location.href);
      button.textContent = "Copied";
      setTimeout(() => (button.textContent = "Copy link"), 1500);
    } catch {
      prompt("The link to what is shown", location.href);
    }
  }

  private async save(what: string): Promise<void> {
    if (!this.description) return;
    const { name } = this.description;
    if (what === "mechanism") {
      const { value } = await this.poser.engine.ask<string>({ do: "file" });
      save(`${name}.toml`, value, "application/toml");
    } else if (what === "slice-csv") save(`${name}-slice.csv`, this.slice.csv(), "text/csv");
    else if (what === "slice-svg") save(`${name}-slice.svg`, this.slice.svg(), "image/svg+xml");
    else if (what === "picture") {
      const picture = await this.view.picture();
      if (picture) save(`${name}.png`, picture, "image/png");
    } else if (what === "pose" && this.posture) {
      const { coordinates, joints } = this.description;
      const columns = [...coordinates, ...joints];
      const values = [...coordinates.map(({ name, home }) => this.state.pose[name] ?? home), ...this.posture.values];
      const head = columns.map(({ name, unit }) => `${name} (${unit})`).join(",");
      save(`${name}-pose.csv`, `${head}\n${values.join(",")}\n`, "text/csv");
    }
  }
}

function same(one: unknown, other: unknown): boolean {
  return JSON.stringify(one) === JSON.stringify(other);
}

function setTheme(dark: boolean, then?: () => void): void {
  document.documentElement.dataset["theme"] = dark ? "dark" : "light";
  then?.();
}

const content = (id: string) => byId(id).textContent ?? "";

setTheme(matchMedia("(prefers-color-scheme: dark)").matches);
void unpack(content("opm-library").trim())
  .then((library) => new Page(JSON.parse(content("opm-file")) as PageFile | null, content("opm-worker"), library).start())
  .catch((error) => {
    byId("status").textContent = `The page does not work in this browser: ${String(error)}`;
  });
