// The state of the page, which lives in its address: what is shared is a link.

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
  ends: Partial<Record<"xmin" | "xmax" | "ymin" | "ymax", number>>;
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

export const POINTS = 201;

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
  };
}

const ENDS = ["xmin", "xmax", "ymin", "ymax"] as const;

/** The state as the part of an address after the `#`. */
export async function toAddress(state: State): Promise<string> {
  const query = new URLSearchParams();
  if (state.source.kind === "example") query.set("example", state.source.name);
  if (state.source.kind === "text") {
    query.set("name", state.source.name);
    query.set("file", await pack(state.source.text));
  }
  if (state.mode !== null) query.set("mode", state.mode);
  for (const [name, value] of Object.entries(state.pose)) query.set(`pose.${name}`, String(value));
  for (const [name, values] of Object.entries(state.changes)) query.set(`set.${name}`, values.join(":"));
  const { x, y, nx, ny, ends, colour } = state.slice;
  if (x) query.set("slice.x", x);
  if (y) query.set("slice.y", y);
  if (nx !== POINTS) query.set("slice.nx", String(nx));
  if (ny !== POINTS) query.set("slice.ny", String(ny));
  for (const end of ENDS) if (ends[end] !== undefined) query.set(`slice.${end}`, String(ends[end]));
  if (colour !== "none") query.set("slice.colour", colour);
  const { body, kind, motion } = state;
  if (motion) query.set("motion", motion.name);
  if (motion && motion.text !== null) query.set("motion.file", await pack(motion.text));
  if (body.show) query.set("body", body.others);
  if (body.axes) query.set("body.axes", body.axes.join(":"));
  if (kind.name !== "grid") query.set("kind", kind.name);
  if (kind.turn !== null) query.set("kind.turn", String(kind.turn));
  return query.toString();
}

/** The state of an address. What is not understood there is as in the initial state. */
export async function fromAddress(hash: string): Promise<State> {
  const state = initial();
  const query = new URLSearchParams(hash.replace(/^#/, ""));
  const number = (text: string | null) => (text === null || text.trim() === "" ? NaN : Number(text));
  for (const [key, value] of query) {
    const [group, name] = [key.slice(0, key.indexOf(".")), key.slice(key.indexOf(".") + 1)];
    if (group === "pose" && Number.isFinite(number(value))) state.pose[name] = number(value);
    if (group === "set") {
      const values = value === "" ? [] : value.split(":").map(number);
      if (values.every(Number.isFinite)) state.changes[name] = values;
    }
  }
  state.mode = query.get("mode");
  const slice = state.slice;
  slice.x = query.get("slice.x");
  slice.y = query.get("slice.y");
  const points = (text: string | null) => (Number.isInteger(number(text)) && number(text) > 0 ? number(text) : POINTS);
  slice.nx = points(query.get("slice.nx"));
  slice.ny = points(query.get("slice.ny"));
  for (const end of ENDS) {
    const value = number(query.get(`slice.${end}`));
    if (Number.isFinite(value)) slice.ends[end] = value;
  }
  slice.colour = query.get("slice.colour") ?? "none";
  const body = query.get("body");
  state.body = { show: body !== null, axes: query.get("body.axes")?.split(":") ?? null, others: body === "any" ? "any" : "pose" };
  const turn = number(query.get("kind.turn"));
  state.kind = { name: query.get("kind") ?? "grid", turn: Number.isFinite(turn) ? turn : null };
  const [motion, moved] = [query.get("motion"), query.get("motion.file")];
  if (motion !== null) {
    const text = moved === null ? null : await unpackText(moved).catch(() => undefined);
    if (text !== undefined) state.motion = { name: motion, text };
  }
  const [example, file] = [query.get("example"), query.get("file")];
  if (example !== null) state.source = { kind: "example", name: example };
  if (file !== null) {
    const text = await unpackText(file).catch(() => null);
    if (text !== null) state.source = { kind: "text", name: query.get("name") ?? "mechanism.toml", text };
  }
  return state;
}

/** A text, compressed, in letters that an address may have. */
async function pack(text: string): Promise<string> {
  const stream = new Blob([text]).stream().pipeThrough(new CompressionStream("deflate-raw"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const letters = Array.from(bytes, (byte) => String.fromCharCode(byte)).join("");
  return btoa(letters).replace(/\+/g, "-").replace(/\//g, "_").replace(/=+$/, "");
}

async function unpackText(packed: string): Promise<string> {
  const letters = atob(packed.replace(/-/g, "+").replace(/_/g, "/"));
  const bytes = Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Response(stream).text();
}
