// The page: what was asked for is the state, and two workers follow it. One solves poses, the other counts workspaces, so
// that a long count never holds up the view.

import { Assemblies } from "./assemblies";
import { unbounded } from "./beyond";
import { BodyMesh, BodyPanel } from "./body";
import { Calm } from "./calm";
import { DimensionPanel } from "./dimensions";
import { byId, element, save, short } from "./dom";
import { Refused } from "./engine";
import { Follower, Loop, type PageFile } from "./follower";
import { HandleSet } from "./handles";
import { JointTable } from "./joints";
import { KindPanel } from "./kinds";
import { fitting, fromAddress, toAddress } from "./link";
import { Player } from "./play";
import { PosePanel } from "./pose";
import { ProblemBox, type Source } from "./problems";
import { SlicePanel } from "./slice";
import { initial, type State } from "./state";
import { showModes, showStatus } from "./status";
import { known, sliceAxes, Sweeper } from "./sweeper";
import { poseTable, sliceTable } from "./tables";
import { connectToolbar, connectView } from "./toolbar";
import type { Assembly, Counted, Description, Example, Kind, Posture, Problem, ShippedMotion } from "./types";
import { Undo } from "./undo";
import { View } from "./view";

/** Milliseconds after which a dimension is taken to stay: where it was let go, and where a pointer may still hold it. */
const REST = { final: 120, held: 400 };

type Pose = Record<string, number>;

export class Page {
  private state: State = initial();
  private description: Description | null = null;
  /** The text of the file that is described. */
  private described: string | null = null;
  /** The last posture that was reached, which is shown, and its pose. */
  private posture: Posture | null = null;
  private reached: Pose = {};
  private counted: Counted | null = null;
  private examples: Example[] = [];
  private shippedMotions: ShippedMotion[] = [];
  private readonly poser: Follower;
  private readonly sweeper: Sweeper;
  private readonly view = new View(byId("view"));
  private readonly handles = new HandleSet(this.view, byId("view"), {
    pose: () => this.fullPose(), moved: (values, final) => this.move(values, final),
  });
  private readonly body = new BodyMesh();
  private readonly pose = new PosePanel({ moved: (name, value, final) => this.move({ [name]: value }, final) });
  private readonly joints = new JointTable({ driven: (name, value) => void this.drive(name, value) });
  private readonly dimensions = new DimensionPanel({
    changed: (name, values, final) => this.change({ ...this.state.changes, [name]: values }, final),
  });
  private readonly slice = new SlicePanel({
    sliced: (slice, final) => this.set({ slice }, final), placed: (values, final) => this.move(values, final),
  });
  private readonly bodyPanel = new BodyPanel((body) => this.set({ body }, true));
  private readonly kinds = new KindPanel((kind) => this.set({ kind }, true));
  private readonly player = new Player({
    chosen: (motion) => this.set({ motion }, true),
    placed: (pose, mode, final) => this.set({ pose, mode: this.asState(mode) }, final),
    unknown: (name) => {
      this.state = { ...this.state, motion: null };
      this.problems.add("link", [{ message: `In the link, motion=${name}: opm ships no such motion for this mechanism.` }]);
    },
    pose: () => this.fullPose(),
  });
  private readonly assemblies = new Assemblies((assembly) => this.assemble(assembly));
  private readonly table = new Calm(() => this.joints.update(this.posture, this.counted));
  private readonly undo = new Undo();
  private readonly posing = new Loop(() => this.stepPose(), (error) => this.fail("page", error), () => this.settle());
  private readonly sweeping = new Loop(() => this.stepSweep(), (error) => this.fail("page", error), () => this.settle());
  /** The number of joints that are being driven. */
  private driving = 0;
  private address = "";
  /** The pose that was solved last, as a key. */
  private solved = "";
  private readonly problems = new ProblemBox(() => this.refused(), (refused) => {
    if (refused && !same(this.state.changes, this.undo.settled)) this.set({ changes: this.undo.settled }, true);
    else if (refused) this.go(true);
  });
  private knownKinds: Kind[] = [];
  /** Whether the state is that of a link, in which there may be what the mechanism does not have. */
  private linked = false;
  /** The clock that runs while a dimension moves. */
  private moving = 0;
  /** The state with which the mechanism that is shown was opened or changed. */
  private good: State | null = null;

  constructor(private readonly carried: PageFile | null, worker: string, library: ArrayBuffer) {
    this.poser = new Follower(worker, library);
    this.sweeper = new Sweeper(new Follower(worker, library), {
      fitted: (fitted, first) => {
        if (fitted) this.pose.setRanges(fitted.axes);
        else this.slice.setWhole(this.counted = null);
        // Sinusoids that somebody has typed stay.
        if (fitted && first) this.player.setRanges(fitted.axes);
        this.slice.setBeyond(unbounded(fitted));
        this.show();
      },
      sliced: (shown) => this.slice.setSlice(shown),
      counted: (counted) => {
        this.counted = counted;
        this.slice.setWhole(counted);
        this.table.ask();
      },
      embodied: (body, bytes, past) => {
        if (body) this.body.set(body, bytes);
        else this.body.clear();
        this.bodyPanel.setBody(body, past);
        this.placeBody();
      },
      kindCounted: (count) => {
        this.kinds.setCount(count);
        this.slice.setKind(count);
      },
      followed: (about, bytes) => this.player.set(about, bytes),
      told: (source, problems) => this.tell(source, problems),
    });
  }

  async start(): Promise<void> {
    this.view.scene.add(this.body.mesh);
    this.connect();
    const { engine } = this.poser;
    this.examples = (await engine.ask<Example[]>({ do: "examples" })).value;
    this.shippedMotions = (await engine.ask<ShippedMotion[]>({ do: "motions" })).value;
    byId("examples").append(...this.examples.map(({ name, description }) => element("option", { value: name, title: description }, name)));
    await this.take(location.hash);
    this.undo.reset(this.state.changes);
    this.follow();
  }

  // The state, and how it changes.

  /** Sets a part of the state. A final one is a step that the browser goes back to. */
  private set(patch: Partial<State>, final: boolean): void {
    if (patch.changes && !same(patch.changes, this.state.changes)) this.moved(final);
    this.state = { ...this.state, ...patch };
    this.body.still(final);
    if (final) void this.remember();
    this.follow();
  }

  private move(values: Pose, final: boolean): void {
    this.set({ pose: { ...this.state.pose, ...values } }, final);
  }

  private change(changes: State["changes"], final: boolean): void {
    if (final) this.undo.step(changes);
    this.set({ changes }, final);
  }

  /** A dimension moves, and after a pause it does not any more: grids are fitted then. */
  private moved(final: boolean): void {
    clearTimeout(this.moving);
    this.moving = window.setTimeout(() => {
      this.moving = 0;
      this.body.still(true);
      this.follow();
    }, final ? REST.final : REST.held);
  }

  private go(back: boolean): void {
    const changes = this.undo.go(back);
    if (changes) this.set({ changes }, true);
  }

  private open(source: State["source"]): void {
    this.undo.reset({});
    this.player.stop();
    this.problems.clear();
    this.linked = false;
    this.set({ ...initial(), source }, true);
  }

  /** Puts the state into the address, as a new step or in place of the last one. */
  private async remember(instead = false): Promise<void> {
    // In a frame of a notebook, the page has no address of its own.
    if (location.protocol === "about:") return;
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
    await this.take(hash);
    this.undo.settled = this.state.changes;
    this.follow();
  }

  /** Takes the state of a link, and says what is not understood in it. */
  private async take(hash: string): Promise<void> {
    const { state, problems } = await fromAddress(hash, { examples: this.examples.map(({ name }) => name) });
    this.state = state;
    this.linked = true;
    this.problems.clear();
    this.problems.set("link", problems);
  }

  /** Every coordinate of the pose. */
  private fullPose(): Pose {
    const home = this.description?.coordinates.map(({ name, home }) => [name, home]) ?? [];
    return { ...(Object.fromEntries(home) as Pose), ...this.state.pose };
  }

  /** A working mode as the state has it: nothing for that of home. */
  private asState(mode: string): string | null {
    return mode === this.description?.home_mode ? null : mode;
  }

  // The workers follow the state.

  /** Shows the state, and lets both workers go after it. */
  private follow(): void {
    document.body.dataset["ready"] = "false";
    this.show();
    void this.posing.start();
    void this.sweeping.start();
  }

  /** Says that all that was asked for has been computed, where this is so. */
  private settle(): void {
    const ready = !this.posing.running && !this.sweeping.running && !this.driving && !this.moving;
    if (ready) this.table.flush();
    document.body.dataset["ready"] = String(ready);
  }

  /** The mechanism file of the state. */
  private file(): PageFile {
    const { source } = this.state;
    if (source.kind === "text") return { name: source.name, text: source.text };
    const wanted = source.kind === "example" ? source.name : undefined;
    const example = this.examples.find(({ name }) => name === wanted) ?? this.examples[0];
    if (wanted === undefined && this.carried) return this.carried;
    return { name: `${example?.name ?? "mechanism"}.toml`, text: example?.text ?? "" };
  }

  private async stepPose(): Promise<void> {
    const before = this.poser.text;
    const asked = this.state;
    const file = this.file();
    const description = await this.poser.agree(file, asked.changes).catch((error: unknown) => {
      if (!(error instanceof Refused)) throw error;
      if (this.poser.text === file.text) this.tell("mechanism", error.problems);
      else this.stay(error.problems);
      return undefined;
    });
    // Another state follows, or what is shown stays.
    if (description === undefined) return;
    const another = before !== this.poser.text;
    if (description) {
      this.good = asked;
      this.tell("mechanism", []);
      const kinds = another ? (await this.poser.engine.ask<Kind[]>({ do: "kinds" })).value : null;
      this.knownKinds = kinds ?? this.knownKinds;
      this.described = this.poser.text;
      this.check(description);
      this.showMechanism(description, kinds);
      // The other worker may have come to it before its coordinates were known here.
      void this.sweeping.start();
    }
    if (!this.description) return;
    this.check(this.description);
    const pose = known(this.state.pose, this.description);
    const key = JSON.stringify([this.poser.text, this.poser.changes, pose, this.state.mode]);
    if (key === this.solved) return;
    this.solved = key;
    try {
      const { value, bytes } = await this.poser.engine.ask<Posture>({ do: "pose", pose, mode: this.state.mode });
      if (value.reached) {
        [this.posture, this.reached] = [value, pose];
        this.view.place(bytes);
      }
      if (description && another) this.view.fit(false);
      this.showPosture(value);
      this.tell("pose", []);
    } catch (error) {
      this.fail("pose", error);
    }
  }

  /** Leaves out what a link asks for and the mechanism does not have, and says so. */
  private check(description: Description): void {
    if (!this.linked || this.described !== this.file().text) return;
    this.linked = false;
    const { state, problems } = fitting(this.state, description, this.knownKinds);
    this.state = state;
    this.problems.add("link", problems);
    if (problems.length) this.show();
  }

  private async stepSweep(): Promise<void> {
    const { state, description } = this;
    const file = this.file();
    // Its coordinates have to be known; the other worker is told when they are.
    if (!description || this.described !== file.text) return;
    const body = this.bodyPanel.wanted ? this.bodyPanel.chosen() : null;
    const wanted = { state, moving: this.moving > 0, description, file, body, kind: this.kinds.wanted, motion: this.player.file };
    await this.sweeper.step(wanted, () => this.sweeping.again);
  }

  // What is shown.

  /** Takes a mechanism: another one, with its kinds of workspace, or the same one with other dimensions. */
  private showMechanism(description: Description, kinds: Kind[] | null): void {
    const names = ({ coordinates, joints, dimensions }: Description) =>
      JSON.stringify([coordinates, dimensions.map(({ name, values }) => [name, values.length]), joints.map(({ name, limits }) => [name, limits])]);
    const rebuilt = kinds || !this.description || names(this.description) !== names(description);
    this.description = description;
    const { name, lower, upper, intersection, lambda, mobility, imaginary_joints: imaginary } = description;
    const motions = upper.dimension ? `${lower.name} and ${upper.name}, sharing a ${intersection.name}` : lower.name;
    byId("summary").textContent = `Mobility ${mobility}, joint screws of rank ${lambda}: ${motions}; ${imaginary} imaginary joint${imaginary === 1 ? "" : "s"}`;
    if (kinds) {
      document.title = `${name} – opm explorer`;
      byId("title").textContent = name;
      [this.posture, this.reached] = [null, {}];
      this.assemblies.set([]);
      this.pose.build(description);
      this.dimensions.build(description);
      this.slice.build(description);
      this.bodyPanel.build(description);
      this.kinds.build(kinds, description.angle);
      this.player.build(description, this.shippedMotions, this.state.motion);
      byId("mode").replaceChildren(...description.modes.map((mode) => element("option", { value: mode }, mode || "the only one")));
    }
    if (rebuilt) {
      this.joints.build(description);
      this.joints.update(this.posture, this.counted);
    }
    this.view.setMechanism(description);
    this.show();
  }

  private show(): void {
    this.problems.show();
    if (!this.description) return;
    const { pose, changes, slice, body, kind, mode, motion } = this.state;
    this.pose.update(pose);
    this.dimensions.update(this.description, changes);
    this.slice.update(slice, sliceAxes(slice, this.sweeper.fitted, this.description), this.fullPose());
    this.bodyPanel.update(body);
    this.kinds.update(kind);
    this.player.update(motion);
    if (!this.kinds.wanted) this.slice.setKind(null);
    this.placeBody();
    byId<HTMLSelectElement>("mode").value = mode ?? this.description.home_mode;
    byId<HTMLButtonElement>("undo").disabled = !this.undo.canUndo;
    byId<HTMLButtonElement>("redo").disabled = !this.undo.canRedo;
    byId<HTMLButtonElement>("reset").disabled = Object.keys(changes).length === 0;
  }

  /** Shows a posture. One out of reach leaves the last one that was reached, and says what is missing. */
  private showPosture(posture: Posture): void {
    const { description } = this;
    if (!description) return;
    showStatus(posture, description);
    showModes(posture);
    this.table.ask();
    if (posture.handles) this.handles.set(description.coordinates, posture.handles, this.view.size);
    this.placeBody();
    description.dependent.forEach(({ name }, number) => {
      const value = this.posture?.dependent[number];
      byId(`dependent-${name}`).textContent = value === undefined ? "" : short(value);
    });
  }

  /** Puts the body of the workspace beside the mechanism. */
  private placeBody(): void {
    const { posture, description, body, bodyPanel } = this;
    const ready = bodyPanel.wanted && description && posture?.handles && this.sweeper.fitted;
    body.mesh.visible = Boolean(ready);
    // Where the pose is out of reach, the platform and the body stay.
    if (ready && posture.reached) {
      const note = body.place(bodyPanel.chosen(), description, this.fullPose(), posture.handles!, this.view.size);
      bodyPanel.setNote(note);
    }
    this.view.draw();
  }

  private fail(source: Source, error: unknown): void {
    this.tell(source, error instanceof Refused ? error.problems : [{ message: `The computation failed: ${String(error)}` }]);
  }

  /** Says what is wrong with something; nothing where it has succeeded. */
  private tell(source: Source, problems: Problem[]): void {
    if (problems.some(({ kind }) => kind === "mode")) {
      // Both workers refuse it. Only a link has such a mode, and the mechanism is shown in that of home.
      if (this.state.mode === null) return;
      this.problems.add("link", problems.map(({ message }) => ({ message: `In the link, mode=${this.state.mode}: ${message}` })));
      this.set({ mode: null }, false);
      return;
    }
    this.problems.set(source, problems);
    if (!this.description && problems.length) byId("status").textContent = "No mechanism is shown.";
  }

  /** Whether what is shown is not the mechanism that was asked for. */
  private refused(): boolean {
    return this.good !== null && !same(this.good.changes, this.state.changes);
  }

  /** Stays at the mechanism that is shown, where another one cannot be opened. */
  private stay(problems: Problem[]): void {
    if (this.good) {
      this.state = this.good;
      this.tell("mechanism", problems);
      void this.remember(true);
      this.follow();
    } else if (Object.keys(this.state.changes).length) {
      // A mechanism that a link cannot change is shown as its file has it.
      this.problems.add("link", problems);
      this.undo.reset({});
      this.set({ changes: {} }, false);
    } else if (this.state.source.kind !== "page") {
      // One of a link that cannot be computed: the page has its own.
      this.problems.add("link", problems);
      this.set(initial(), false);
    } else this.tell("mechanism", problems);
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
      const request = { do: "forward", joints, pose: known(this.state.pose, this.description) };
      const { assemblies } = (await this.poser.engine.ask<{ assemblies: Assembly[] }>(request)).value;
      this.tell("joint", []);
      if (!this.assemblies.set(assemblies)) {
        this.joints.restore(name, this.posture);
        byId("status").classList.add("wrong");
        byId("status").textContent = `No pose of the platform has ${name} = ${short(value)}.`;
      }
    } catch (error) {
      this.joints.restore(name, this.posture);
      this.fail("joint", error);
    }
    this.driving--;
    this.settle();
  }

  /** Goes to one of the assemblies for the present actuated joints. */
  private assemble(assembly: Assembly): void {
    if (!this.description) return;
    const pose = this.description.coordinates.map(({ name }, i) => [name, Number(assembly.pose[i]!.toPrecision(12))]);
    this.set({ pose: Object.fromEntries(pose) as Pose, mode: this.asState(assembly.mode) }, true);
  }

  // Buttons, menus, files.

  private connect(): void {
    connectView(this.view);
    byId("share").hidden = location.protocol === "about:";
    const handles = byId<HTMLInputElement>("handles");
    handles.addEventListener("change", () => {
      this.handles.group.visible = handles.checked;
      this.view.draw();
    });
    connectToolbar({
      home: () => this.set({ pose: {} }, true),
      undo: (back) => this.go(back),
      reset: () => this.change({}, true),
      share: () => void this.share(),
      themed: () => {
        this.slice.draw();
        this.player.draw();
      },
      mode: (mode) => this.set({ mode: this.asState(mode) }, true),
      example: (name) => this.open({ kind: "example", name }),
      save: (what) => void this.save(what),
      opened: (name, text) => {
        // A motion has a duration, or is a table.
        const motion = /\.csv$/i.test(name) || /^\s*(duration|points|moves)\s*=|^\s*\[+\s*(coordinates|points|moves)/m.test(text);
        if (motion && this.description) this.player.open({ name, text });
        else this.open({ kind: "text", name, text });
      },
    });
    window.addEventListener("popstate", () => void this.recall());
    window.addEventListener("hashchange", () => void this.recall());
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
    } else if (what === "slice-csv" && this.slice.shown) {
      save(`${name}-slice.csv`, sliceTable(this.description, this.slice.shown), "text/csv");
    } else if (what === "slice-svg") save(`${name}-slice.svg`, this.slice.svg(), "image/svg+xml");
    else if (what === "picture") {
      const picture = await this.view.picture();
      if (picture) save(`${name}.png`, picture, "image/png");
    } else if (what === "pose" && this.posture) {
      // The pose that is shown: one out of reach has no joints.
      save(`${name}-pose.csv`, poseTable(this.description, this.reached, this.posture), "text/csv");
    }
  }
}

function same(one: unknown, other: unknown): boolean {
  return JSON.stringify(one) === JSON.stringify(other);
}
