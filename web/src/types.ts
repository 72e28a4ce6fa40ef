// What the compiled library answers: the JSON of crates/opm-web. Numbers are in the units of the mechanism file, but
// for bodies and subspaces, which are in metres.

export interface Problem {
  /** What the page has to do something about: the mechanism has no working mode of the name. */
  kind?: "mode";
  /** The name of the file with the place. */
  file?: string;
  place?: [line: number, column: number];
  message: string;
}

export interface Coordinate {
  name: string;
  unit: string;
  /** The unit in SI. */
  si: number;
  quantity: "length" | "angle";
  home: number;
}

export interface Joint {
  name: string;
  /** The joint that it is a coordinate of. */
  joint: string;
  leg: string;
  kind: "actuated" | "passive" | "imaginary";
  section: "lower" | "upper" | null;
  unit: string;
  home: number;
  limits: [number, number] | null;
}

export interface Dimension {
  name: string;
  group: string;
  label: string;
  unit: string;
  parts: string[];
  values: number[];
}

export type Vector = [number, number, number];

export interface Subspace {
  name: string;
  dimension: number;
  point: Vector | null;
  direction: Vector | null;
}

export interface Solid {
  shape: "cylinder" | "ball" | "block";
  material: "base" | "link" | "actuated" | "passive" | "platform" | "imaginary" | "obstacle";
  /** What it belongs to among the bodies that may interfere. */
  member: string | null;
  from: Vector;
  to: Vector;
  radius: number;
}

export interface Body {
  name: string;
  origin: Vector;
  section: "lower" | "upper" | null;
  solids: Solid[];
  seats: Seat[];
}

/** A joint in a body: its centre, and its axis unless it is a ball. */
export interface Seat {
  joint: string;
  at: Vector;
  axis: Vector | null;
}

export interface Description {
  name: string;
  length: string;
  angle: string;
  coordinates: Coordinate[];
  dependent: Coordinate[];
  home_mode: string;
  modes: string[];
  lambda: number;
  mobility: number;
  lower: Subspace;
  upper: Subspace;
  intersection: Subspace;
  imaginary_joints: number;
  joints: Joint[];
  forward: boolean;
  /** What cannot be told at home, where it is a parallel singularity. */
  home_warning: string | null;
  dimensions: Dimension[];
  bodies: Body[];
}

export interface OutOfReach {
  leg: string;
  section: string;
  deficit: number | null;
  unit: string;
  text: string;
}

export interface Posture {
  mode: string;
  reached: boolean;
  within: boolean;
  values: number[];
  beyond: number[];
  dependent: number[];
  out_of_reach: OutOfReach[];
  modes: { mode: string; within: boolean }[];
  handles: Handles | null;
  contacts: Contacts | null;
}

/** How far the bodies are from each other, in words, and which are too near. */
export interface Contacts {
  near: string[];
  overlap: boolean;
  nearest: string;
  set_aside: string | null;
}

export interface FittedAxis {
  name: string;
  min: number;
  max: number;
  count: number;
  unbounded: boolean;
}

export interface Fitted {
  axes: FittedAxis[];
  poses: number;
}

export interface Counted {
  poses: number;
  reachable: number;
  measure: number;
  unit: string;
  imaginary: ([number, number] | null)[];
}

export interface Slice extends Counted {
  rings: number[][];
}

export interface Colours {
  unit: string;
  min: number | null;
  max: number | null;
}

export interface Assembly {
  pose: number[];
  mode: string;
  within: boolean;
  values: number[];
}

export interface Example {
  name: string;
  description: string;
  text: string;
}

export interface AxisRequest {
  name: string;
  min: number;
  max: number;
  count: number;
}

export interface Move {
  shift: Vector;
  turn: Vector;
}

export interface Handles {
  at: Vector;
  moves: (Move | null)[];
}

export interface WorkspaceBody {
  inside: number;
  points: number;
  poses: number;
  corners: number;
  triangles: number;
  ranges: [number, number][];
}

export interface Kind {
  name: string;
  description: string;
  turns: boolean;
  refused: string | null;
}

export interface KindCount {
  points: number;
  members: number;
  point_name: string;
  member_name: string;
  measure: number | null;
  unit: string;
  varying: string[];
  unbounded: string[];
  rings: number[][];
  options: string[];
}

export interface ShippedMotion {
  name: string;
  mechanism: string;
  description: string;
  text: string;
}

export interface Followed {
  name: string;
  mode: string;
  samples: number;
  reached: number;
  valid: number;
  columns: number;
  violations: { kind: string; joint: string | null; start: number; end: number; text: string }[];
  violation_count: number;
}
