// What the second worker computes: the grid that holds the workspace, the slice, the whole workspace, the body, a kind of
// workspace, and motions. The page's state is followed in this order, so that what changes fastest is never behind what
// takes long.

import { unbounded } from "./beyond";
import { Refused } from "./engine";
import { Follower, type PageFile } from "./follower";
import type { Source } from "./problems";
import type { Shown } from "./slice";
import type { SliceState, State } from "./state";
import type { AxisRequest, Colours, Counted, Description, Fitted, Followed, KindCount, Problem, Slice, WorkspaceBody } from "./types";

/** What is asked for, besides the state. */
export interface Wanted {
  state: State;
  /** Whether a dimension is changing: the grids stay as they are. */
  moving: boolean;
  description: Description;
  file: PageFile;
  /** The coordinates of the body; nothing if it is not shown. */
  body: string[] | null;
  kind: string | null;
  motion: { name: string; text: string } | null;
}

/** What has been computed; nothing where it was refused. */
export interface SweeperEvents {
  /** A grid was fitted, the first one for a mechanism file or another one. Nothing while the first one is not there. */
  fitted(fitted: Fitted | null, first: boolean): void;
  sliced(shown: Shown | null): void;
  counted(counted: Counted | null): void;
  embodied(body: WorkspaceBody | null, bytes: Uint8Array<ArrayBuffer>, past: string[]): void;
  kindCounted(count: KindCount | null): void;
  followed(followed: Followed | null, bytes: Uint8Array<ArrayBuffer> | null): void;
  /** What is wrong with one of them; none where it was computed. */
  told(source: Source, problems: Problem[]): void;
}

const NOTHING = new Uint8Array();

export class Sweeper {
  fitted: Fitted | null = null;
  /** The number of grids that were fitted. */
  private fits = 0;
  private shown: Shown | null = null;
  /** What has been done, as keys. */
  private done = new Map<Source, string>();

  constructor(private readonly follower: Follower, private readonly events: SweeperEvents) {}

  /** Computes what is not yet as it is wanted, until there is something else to do. */
  async step({ state, moving, description, file, body, kind, motion }: Wanted, again: () => boolean): Promise<void> {
    const { follower, events } = this;
    const before = follower.text;
    // The other worker tells what is wrong with the same mechanism.
    await follower.agree(file, state.changes).catch((error: unknown) => {
      if (!(error instanceof Refused)) throw error;
    });
    if (!follower.text) return;
    if (before !== follower.text) {
      this.done.clear();
      this.fitted = null;
      events.fitted(null, true);
    }
    const { mode } = state;
    const mechanism = JSON.stringify([follower.text, follower.changes, mode]);
    // While a dimension moves, counts on the same grid are compared. What stays has the grid that is fitted to it, as for
    // the command and whoever opens a link.
    if (!moving || !this.fitted) {
      await this.once("fit", mechanism, async () => {
        const first = this.fitted === null;
        const { value, milliseconds } = await follower.engine.ask<Fitted>({ do: "fit", mode });
        document.body.dataset["fitMs"] = milliseconds.toFixed(1);
        this.fitted = value;
        this.fits++;
        events.fitted(this.fitted, first);
      });
    }
    if (!this.fitted) return;
    const gridded = JSON.stringify([mechanism, this.fits]);
    const axes = sliceAxes(state.slice, this.fitted, description);
    if (axes) await this.slice(mechanism, axes, state, description);
    if (again()) return;
    await this.once("whole", gridded, async () => {
      const { value, milliseconds } = await follower.engine.ask<Counted>({ do: "whole", mode });
      document.body.dataset["wholeMs"] = milliseconds.toFixed(2);
      events.counted(value);
    }, () => events.counted(null));
    if (again()) return;
    const pose = known(state.pose, description);
    if (body) {
      const { others } = state.body;
      const held = others === "pose" ? known(state.pose, description, body) : {};
      await this.once("body", JSON.stringify([gridded, body, others, held]), async () => {
        const request = { do: "body", axes: body, others, pose: held, mode };
        const { value, bytes, milliseconds } = await follower.engine.ask<WorkspaceBody>(request);
        document.body.dataset["bodyMs"] = milliseconds.toFixed(2);
        events.embodied(value, bytes, unbounded(this.fitted).filter((name) => others === "any" || body.includes(name)));
      }, () => events.embodied(null, NOTHING, []));
      if (again()) return;
    } else this.drop("body");
    if (axes) await this.colours(axes, state, description);
    if (again()) return;
    const { turn } = state.kind;
    if (kind) {
      await this.once("kind", JSON.stringify([gridded, kind, turn, pose]), async () => {
        const request = { do: "kind", kind, pose, mode, turn };
        events.kindCounted((await follower.engine.ask<KindCount>(request)).value);
      }, () => events.kindCounted(null));
      if (again()) return;
    } else this.drop("kind");
    if (motion) {
      await this.once("motion", JSON.stringify([mechanism, motion]), async () => {
        const { value, bytes } = await follower.engine.ask<Followed>({ do: "motion", ...motion, mode });
        events.followed(value, bytes);
      }, () => events.followed(null, null));
    } else this.drop("motion");
  }

  /** Does something unless it was done for the same key. Where it is refused, the page tells why. */
  private async once(what: Source, key: string, action: () => Promise<void>, refused?: () => void): Promise<void> {
    if (this.done.get(what) === key) return;
    this.done.delete(what);
    try {
      await action();
      this.done.set(what, key);
      this.events.told(what, []);
    } catch (error) {
      if (!(error instanceof Refused)) throw error;
      // The same would be refused again.
      this.done.set(what, key);
      refused?.();
      this.events.told(what, error.problems);
    }
  }

  /** Something is not wanted any more, and nothing is wrong with it. */
  private drop(what: Source): void {
    if (this.done.delete(what)) this.events.told(what, []);
  }

  private async slice(mechanism: string, { x, y }: Axes, { pose, mode }: State, description: Description): Promise<void> {
    const held = known(pose, description, [x.name, y.name]);
    await this.once("slice", JSON.stringify([mechanism, x, y, held]), async () => {
      const request = { do: "slice", x, y, pose: held, mode };
      const { value, bytes, milliseconds } = await this.follower.engine.ask<Slice>(request);
      document.body.dataset["sliceMs"] = milliseconds.toFixed(3);
      this.shown = { x, y, pose: held, slice: value, mask: bytes, colours: null };
      this.done.delete("colours");
      this.events.sliced(this.shown);
    }, () => {
      this.shown = null;
      this.drop("colours");
      this.events.sliced(null);
    });
  }

  private async colours({ x, y }: Axes, { pose, mode, slice: { colour: by } }: State, description: Description): Promise<void> {
    if (!this.shown) return;
    const shown = this.shown;
    await this.once("colours", JSON.stringify([this.done.get("slice"), by]), async () => {
      if (by === "none" && !shown.colours) return;
      const request = { do: "colours", x, y, pose: known(pose, description, [x.name, y.name]), mode, by };
      const answer = by === "none" ? null : await this.follower.engine.ask<Colours>(request);
      const colours = answer && { by, range: answer.value, numbers: new Float32Array(answer.bytes.buffer) };
      this.shown = { ...shown, colours };
      this.events.sliced(this.shown);
    });
  }
}

interface Axes {
  x: AxisRequest;
  y: AxisRequest;
}

/** The values of a pose that the mechanism knows, but for some coordinates. */
export function known(pose: Record<string, number>, { coordinates }: Description, without: string[] = []): Record<string, number> {
  const names = new Set(coordinates.map(({ name }) => name));
  return Object.fromEntries(Object.entries(pose).filter(([name]) => names.has(name) && !without.includes(name)));
}

/** The axes of the slice: what was set, and else the range that holds the workspace. */
export function sliceAxes(slice: SliceState, fitted: Fitted | null, description: Description | null): Axes | null {
  if (!fitted || !description) return null;
  const names = description.coordinates.map(({ name }) => name);
  const x = slice.x !== null && names.includes(slice.x) ? slice.x : names[0];
  const second = names.find((name) => name !== x);
  const y = slice.y !== null && names.includes(slice.y) && slice.y !== x ? slice.y : second;
  if (x === undefined || y === undefined) return null;
  const axis = (name: string, end: "x" | "y", count: number): AxisRequest => {
    const range = fitted.axes.find((axis) => axis.name === name) ?? { min: -1, max: 1 };
    const wide = range.max > range.min ? range : { min: range.min - 1, max: range.max + 1 };
    return { name, min: slice.ends[`${end}min`] ?? wide.min, max: slice.ends[`${end}max`] ?? wide.max, count };
  };
  return { x: axis(x, "x", slice.nx), y: axis(y, "y", slice.ny) };
}
