// The state of the page: what is asked for.

/** What is shown. A coordinate that is not named has its value at home. */
export interface State {
  /** Where the mechanism is from: the page itself, one of those that opm ships, or a text. */
  source: { kind: "page" } | { kind: "example"; name: string } | { kind: "text"; name: string; text: string };
  /** Changed numbers of the mechanism. */
  changes: Record<string, number[]>;
  pose: Record<string, number>;
  /** The working mode; nothing for that of home. */
  mode: string | null;
  slice: SliceState;
  body: BodyState;
  kind: KindState;
  motion: MotionState | null;
  /** Bodies that are nearer to each other than this are red; nothing for those that overlap. */
  clearance: number | null;
}

/** The motion of the platform: a shipped one by its name, or a file with its text. */
export interface MotionState {
  name: string;
  text: string | null;
}

/** The slice: its coordinates, and what is not the default of the mechanism. */
export interface SliceState {
  x: string | null;
  y: string | null;
  nx: number;
  ny: number;
  /** The ends of both axes, where they were set. */
  ends: Partial<Record<(typeof ENDS)[number], number>>;
  colour: string;
}

/** The workspace as a body: its coordinates, where they were set, and what the others are. */
export interface BodyState {
  show: boolean;
  axes: string[] | null;
  others: "pose" | "any";
}

/** The kind of workspace that is counted, and how far its orientations are from that of the pose. */
export interface KindState {
  name: string;
  turn: number | null;
}

/** How many values of a coordinate a slice has, if nothing else is said, and at most. */
export const POINTS = 201;
export const MOST_POINTS = 2001;
export const ENDS = ["xmin", "xmax", "ymin", "ymax"] as const;

export function initial(): State {
  return {
    source: { kind: "page" },
    changes: {},
    pose: {},
    mode: null,
    slice: { x: null, y: null, nx: POINTS, ny: POINTS, ends: {}, colour: "none" },
    body: { show: false, axes: null, others: "pose" },
    kind: { name: "grid", turn: null },
    motion: null,
    clearance: null,
  };
}

/** Whether a slice can have so many values of a coordinate. */
export function countable(points: number): boolean {
  return Number.isInteger(points) && points >= 1 && points <= MOST_POINTS;
}
