// Links: the state of the page lives in its address, and what a link asks for may not be there.

import { NUMBERS } from "./scale";
import { countable, ENDS, initial, MOST_POINTS, POINTS, type State } from "./state";
import type { Description, Kind, Problem } from "./types";

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
  const { body, kind, motion, clearance } = state;
  if (motion) query.set("motion", motion.name);
  if (motion && motion.text !== null) query.set("motion.file", await pack(motion.text));
  if (body.show) query.set("body", body.others);
  if (body.axes) query.set("body.axes", body.axes.join(":"));
  if (kind.name !== "grid") query.set("kind", kind.name);
  if (kind.turn !== null) query.set("kind.turn", String(kind.turn));
  if (clearance !== null) query.set("clearance", String(clearance));
  return query.toString();
}

/** What a link may name besides coordinates, dimensions and joints. */
export interface Known {
  examples: string[];
}

/** What an address asks for, and what of it is not understood. */
export interface Linked {
  state: State;
  problems: Problem[];
}

const PLAIN = new Set(["example", "name", "file", "mode", "slice.x", "slice.y", "slice.nx", "slice.ny", ...ENDS.map((end) => `slice.${end}`),
  "slice.colour", "motion", "motion.file", "body", "body.axes", "kind", "kind.turn", "clearance"]);

/** The state of an address. What is not understood there is as in the initial state, and is told. */
export async function fromAddress(hash: string, { examples }: Known): Promise<Linked> {
  const state = initial();
  const query = new URLSearchParams(hash.replace(/^#/, ""));
  const wrong: string[] = [];
  const numeric = (text: string) => (text.trim() === "" ? NaN : Number(text));
  const number = (key: string, usable: (value: number) => boolean = Number.isFinite, expected = "a number"): number | undefined => {
    const text = query.get(key);
    if (text === null) return undefined;
    const value = numeric(text);
    if (usable(value)) return value;
    wrong.push(`${key}=${text}: expected ${expected}`);
    return undefined;
  };
  const unpacked = async (key: string, what: string): Promise<string | null> => {
    const text = await unpackText(query.get(key) ?? "").catch(() => null);
    if (text === null) wrong.push(`${key}=…: ${what} in the link is damaged or not complete`);
    return text;
  };
  for (const [key, value] of query) {
    const [group, name] = [key.slice(0, key.indexOf(".")), key.slice(key.indexOf(".") + 1)];
    if (group === "pose") {
      const given = number(key);
      if (given !== undefined) state.pose[name] = given;
    } else if (group === "set") {
      const values = value === "" ? [] : value.split(":").map(numeric);
      if (values.every(Number.isFinite)) state.changes[name] = values;
      else wrong.push(`${key}=${value}: expected numbers with colons between them`);
    } else if (!PLAIN.has(key)) wrong.push(`${key}: not known`);
  }
  state.mode = query.get("mode");
  const { slice } = state;
  slice.x = query.get("slice.x");
  slice.y = query.get("slice.y");
  const points = (key: string) => number(key, countable, `a whole number from 1 to ${MOST_POINTS}`) ?? POINTS;
  [slice.nx, slice.ny] = [points("slice.nx"), points("slice.ny")];
  for (const end of ENDS) {
    const value = number(`slice.${end}`);
    if (value !== undefined) slice.ends[end] = value;
  }
  slice.colour = query.get("slice.colour") ?? "none";
  const body = query.get("body");
  if (body !== null && body !== "any" && body !== "pose") wrong.push(`body=${body}: expected any or pose`);
  state.body = { show: body !== null, axes: query.get("body.axes")?.split(":") ?? null, others: body === "any" ? "any" : "pose" };
  state.kind = { name: query.get("kind") ?? "grid", turn: number("kind.turn") ?? null };
  state.clearance = number("clearance", (value) => Number.isFinite(value) && value >= 0, "a length of 0 or more") ?? null;
  const motion = query.get("motion");
  if (motion !== null) {
    const text = query.has("motion.file") ? await unpacked("motion.file", "the motion") : null;
    if (text !== null || !query.has("motion.file")) state.motion = { name: motion, text };
  }
  const example = query.get("example");
  let lost = false;
  if (query.has("file")) {
    const text = await unpacked("file", "the mechanism");
    lost = text === null;
    if (text !== null) state.source = { kind: "text", name: query.get("name") ?? "mechanism.toml", text };
  } else if (example !== null) {
    lost = !examples.includes(example);
    if (lost) wrong.push(`example=${example}: opm ships no mechanism of this name`);
    else state.source = { kind: "example", name: example };
  }
  const problems = wrong.map((what) => ({ message: `In the link, ${what}.${lost ? " The page shows its own mechanism." : ""}` }));
  // Whatever else is in the link is for another mechanism.
  return { state: lost ? initial() : state, problems };
}

/** A state without what this mechanism does not have, and what that was. */
export function fitting(state: State, { coordinates, joints }: Description, kinds: Kind[]): Linked {
  const wrong: string[] = [];
  const names = coordinates.map(({ name }) => name);
  const one = (key: string, name: string | null, known: string[], what: string): boolean => {
    if (name === null || known.includes(name)) return true;
    wrong.push(`${key}=${name}: this mechanism has no such ${what}`);
    return false;
  };
  const pose = Object.fromEntries(Object.entries(state.pose).filter(([name]) => {
    if (!names.includes(name)) wrong.push(`pose.${name}: this mechanism has no such coordinate`);
    return names.includes(name);
  }));
  const { slice, body, kind } = state;
  const x = one("slice.x", slice.x, names, "coordinate") ? slice.x : null;
  const y = one("slice.y", slice.y, names, "coordinate") ? slice.y : null;
  const colours = ["none", ...Object.keys(NUMBERS), ...joints.map(({ name }) => name)];
  const colour = one("slice.colour", slice.colour, colours, "joint") ? slice.colour : "none";
  const three = body.axes === null || (body.axes.length === 3 && new Set(body.axes).size === 3 && body.axes.every((name) => names.includes(name)));
  if (!three) wrong.push(`body.axes=${body.axes!.join(":")}: expected three coordinates of this mechanism`);
  const kindly = one("kind", kind.name, kinds.map(({ name }) => name), "kind of workspace");
  return {
    state: {
      ...state, pose, slice: { ...slice, x, y, colour }, body: { ...body, axes: three ? body.axes : null },
      kind: kindly ? kind : initial().kind,
    },
    problems: wrong.map((what) => ({ message: `In the link, ${what}.` })),
  };
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
