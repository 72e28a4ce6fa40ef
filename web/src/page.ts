// The page: what was asked for is the state, and two workers follow it. One solves poses, the other counts workspaces, so
// that a long count never holds up the view.

import { Address } from "./address";
import { byId, element, short } from "./dom";
import { Driver } from "./driver";
import { Refused } from "./engine";
import { Follower, Loop, type PageFile } from "./follower";
import { connectLayout } from "./layout";
import { fitting, fromAddress } from "./link";
import { Panels } from "./panels";
import { ProblemBox, type Source } from "./problems";
import { saveEntry } from "./saving";
import { Stage } from "./stage";
import { initial, type State } from "./state";
import { known, sliceAxes, Sweeper } from "./sweeper";
import { connectToolbar } from "./toolbar";
import type { Assembly, Description, Example, Kind, Posture, Problem, ShippedMotion } from "./types";
import { Undo } from "./undo";

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
  private examples: Example[] = [];
  private shippedMotions: ShippedMotion[] = [];
  private readonly poser: Follower;
  private readonly sweeper: Sweeper;
  private readonly driver: Driver;
  private readonly stage = new Stage({
    pose: () => this.fullPose(this.state.pose), moved: (values, final) => this.move(values, final),
    pointed: (joint) => this.panels.joints.point(joint),
  });
  private readonly address = new Address((hash) => this.recall(hash));
  private readonly panels = new Panels({
    set: (patch, final) => this.set(patch, final),
    move: (values, final) => this.move(values, final),
    change: (name, values, final) => this.change({ ...this.state.changes, [name]: values }, final),
    drive: (name, value, final) => void this.driver.drive({ name, value, final }),
    pointed: (joint) => this.stage.point(joint),
    assemble: (assembly, final) => this.assemble(assembly, final),
    follow: (pose, mode, final) => this.set({ pose, mode: this.asState(mode) }, final),
    refused: (why) => this.tell("field", why === null ? [] : [{ message: why }]),
    unknownMotion: (name) => {
      this.state = { ...this.state, motion: null };
      this.problems.add("link", [{ message: `In the link, motion=${name}: opm ships no such motion for this mechanism.` }]);
    },
    pose: () => this.fullPose(this.state.pose),
  });
  private readonly undo = new Undo();
  private readonly posing = new Loop(() => this.stepPose(), (error) => this.fail("page", error), () => this.settle());
  private readonly sweeping = new Loop(() => this.stepSweep(), (error) => this.fail("page", error), () => this.settle());
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
    this.driver = new Driver(this.poser.engine, {
      from: () => {
        const { description, posture, state: { pose } } = this;
        return description && posture && { description, posture, pose };
      },
      found: (found, { name, value, final }) => {
        this.tell("joint", []);
        if (!this.panels.assemblies.set(found, final)) this.panels.refuseJoint(name, `No pose of the platform has ${name} = ${short(value)}.`);
      },
      failed: (error, { name }) => {
        this.panels.refuseJoint(name, null);
        this.fail("joint", error);
      },
      changed: () => this.settle(),
    });
    this.sweeper = new Sweeper(new Follower(worker, library), {
      fitted: (fitted, first) => {
        this.panels.setFitted(fitted, first);
        this.show();
      },
      sliced: (shown) => this.panels.slice.setSlice(shown),
      counted: (counted) => this.panels.setCounted(counted),
      embodied: (body, bytes, past) => {
        this.stage.setBody(body, bytes);
        this.panels.body.setBody(body, past);
        this.placeBody();
      },
      kindCounted: (count) => this.panels.setKind(count),
      followed: (about, bytes) => this.panels.player.set(about, bytes),
      told: (source, problems) => this.tell(source, problems),
    });
  }

  async start(): Promise<void> {
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
    this.stage.still(final);
    if (final) void this.address.remember(this.state);
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
      this.stage.still(true);
      this.follow();
    }, final ? REST.final : REST.held);
  }

  private go(back: boolean): void {
    const changes = this.undo.go(back);
    if (changes) this.set({ changes }, true);
  }

  private open(source: State["source"]): void {
    this.undo.reset({});
    this.panels.player.stop();
    this.problems.clear();
    this.linked = false;
    this.set({ ...initial(), source }, true);
  }

  /** Another file is opened: what was wrong before is told no more, but for a dimension that is refused. */
  private forget(): void {
    for (const source of ["link", "file", "field", "motion"] as const) this.problems.set(source, []);
    if (!this.refused()) this.problems.set("mechanism", []);
  }

  /** Takes the state of the address to which the browser has gone. */
  private async recall(hash: string): Promise<void> {
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

  /** Every coordinate of a pose. */
  private fullPose(pose: Pose): Pose {
    const home = this.description?.coordinates.map(({ name, home }) => [name, home]) ?? [];
    return { ...(Object.fromEntries(home) as Pose), ...pose };
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
    const ready = !this.posing.running && !this.sweeping.running && !this.driver.running && !this.moving;
    if (ready) this.panels.flush();
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
    const { mode, clearance } = this.state;
    const key = JSON.stringify([this.poser.text, this.poser.changes, pose, mode, clearance]);
    if (key === this.solved) return;
    this.solved = key;
    try {
      const { value, bytes } = await this.poser.engine.ask<Posture>({ do: "pose", pose, mode, clearance });
      // What is said below the view takes room from it.
      this.panels.setPosture(value, this.description);
      if (value.reached) {
        [this.posture, this.reached] = [value, pose];
        this.stage.setPosture(value, bytes);
      }
      this.showPosture();
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
    const { body: { wanted: shown }, kinds, player } = this.panels;
    const body = shown ? this.panels.body.chosen() : null;
    const wanted = { state, moving: this.moving > 0, description, file, body, kind: kinds.wanted, motion: player.file };
    await this.sweeper.step(wanted, () => this.sweeping.again);
  }

  // What is shown.

  /** Takes a mechanism: another one, with its kinds of workspace, or the same one with other dimensions. */
  private showMechanism(description: Description, kinds: Kind[] | null): void {
    const names = ({ coordinates, joints, dimensions }: Description) =>
      JSON.stringify([coordinates, dimensions.map(({ name, values }) => [name, values.length]), joints.map(({ name, limits }) => [name, limits])]);
    const rebuilt = kinds || !this.description || names(this.description) !== names(description);
    this.description = description;
    const { name, lower, upper, intersection, lambda, mobility, imaginary_joints: imaginary, home_warning: warning } = description;
    const shared = intersection.dimension ? `a ${intersection.name}` : "no motion";
    const motions = upper.dimension ? `${lower.name} and ${upper.name}, sharing ${shared}` : lower.name;
    const joints = imaginary ? `; ${imaginary} imaginary joint${imaginary === 1 ? "" : "s"}` : "";
    const home = warning ? `. Note: ${warning}` : "";
    byId("summary").textContent = `Mobility ${mobility}, joint screws of rank ${lambda}: ${motions}${joints}${home}`;
    if (kinds) {
      document.title = `${name} – opm explorer`;
      byId("title").textContent = name;
      [this.posture, this.reached] = [null, {}];
      this.panels.build(description, kinds, this.shippedMotions, this.state.motion);
    }
    if (rebuilt) this.panels.buildJoints(description);
    this.stage.setMechanism(description, kinds !== null);
    this.show();
  }

  private show(): void {
    this.problems.show();
    if (!this.description) return;
    const { pose, changes, slice } = this.state;
    this.panels.update(this.state, this.description, sliceAxes(slice, this.sweeper.fitted, this.description), this.fullPose(pose));
    this.placeBody();
    byId<HTMLButtonElement>("undo").disabled = !this.undo.canUndo;
    byId<HTMLButtonElement>("redo").disabled = !this.undo.canRedo;
    byId<HTMLButtonElement>("reset").disabled = Object.keys(changes).length === 0;
  }

  /** Shows the last posture that was reached: one out of reach leaves it. */
  private showPosture(): void {
    const { description } = this;
    if (!description) return;
    this.placeBody();
    description.dependent.forEach(({ name }, number) => {
      const value = this.posture?.dependent[number];
      byId(`dependent-${name}`).textContent = value === undefined ? "" : short(value);
    });
  }

  /** Puts the body of the workspace beside the mechanism. Where the pose is out of reach, both stay. */
  private placeBody(): void {
    this.stage.placeBody(this.panels.body, this.sweeper.fitted !== null, this.fullPose(this.reached));
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
      void this.address.remember(this.state, true);
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

  /** Goes to one of the assemblies for the present actuated joints. */
  private assemble(assembly: Assembly, final: boolean): void {
    if (!this.description) return;
    const pose = this.description.coordinates.map(({ name }, i) => [name, Number(assembly.pose[i]!.toPrecision(12))]);
    this.set({ pose: Object.fromEntries(pose) as Pose, mode: this.asState(assembly.mode) }, final);
  }

  // Buttons, menus, files.

  private connect(): void {
    this.stage.connect();
    connectLayout(() => this.stage.picture());
    this.address.connect();
    byId("share").hidden = location.protocol === "about:";
    connectToolbar({
      home: () => this.set({ pose: {} }, true),
      undo: (back) => this.go(back),
      reset: () => this.change({}, true),
      share: () => void this.share(),
      themed: () => {
        this.panels.draw();
        this.stage.still(true);
      },
      mode: (mode) => this.set({ mode: this.asState(mode) }, true),
      example: (name) => this.open({ kind: "example", name }),
      save: (entry) => {
        const { description, stage, posture, reached, panels: { slice }, poser: { engine } } = this;
        if (description) void saveEntry(entry, { description, engine, slice, stage, posture, reached });
      },
      opened: (name, text) => {
        this.forget();
        // A motion has a duration, or is a table.
        const motion = /\.csv$/i.test(name) || /^\s*(duration|points|moves)\s*=|^\s*\[+\s*(coordinates|points|moves)/m.test(text);
        if (motion && this.description) this.panels.player.open({ name, text });
        else this.open({ kind: "text", name, text });
      },
      unreadable: (message) => {
        this.forget();
        this.tell("file", [{ message }]);
      },
    });
  }

  private async share(): Promise<void> {
    await this.address.remember(this.state);
    const button = byId("share");
    try {
      await navigator.clipboard.writeText(location.href);
      button.textContent = "Copied";
      setTimeout(() => (button.textContent = "Copy link"), 1500);
    } catch {
      prompt("The link to what is shown", location.href);
    }
  }
}

function same(one: unknown, other: unknown): boolean {
  return JSON.stringify(one) === JSON.stringify(other);
}
