// What is written over the view: the names of the joints, the axes of the base frame, a scale, and the joint that is pointed at.

import { Matrix4, Vector3, type PerspectiveCamera } from "three";
import { byId, element, short } from "./dom";
import type { Placed } from "./solids";
import type { Body, Description } from "./types";

/** The distances of a name from its joint that are tried, and the number of directions, as `opm plot` has them. */
const DISTANCES = [10, 17, 27, 40];
const DIRECTIONS = 16;
/** Joints that are nearer to each other than this, in pixels, share their name. */
const SAME = 6;
const LINE = 13;
/** The side of a cell in which it is known whether a solid is drawn, pixels. */
const CELL = 7;
/** What it costs to lie over another name, outside of the view, and elsewhere than before, against a cell with a solid. */
const COST = { name: 60, outside: 400, moved: 3, pixel: 0.25 };
/** Half the length of a joint's axis as it is drawn, as a share of the mechanism's size. */
const AXIS = 0.3;

/** The height of a line of text below the view, with what is around it, pixels. */
const STATUS = 52;

interface Box { x: number; y: number; wide: number }

interface Room extends Box { high: number }

/** A joint: the body that it is in, and its place and axis there. */
interface Seat { joint: string; body: number; at: Vector3; axis: Vector3 | null }

/** What is drawn, from where. */
export interface Sight {
  camera: PerspectiveCamera;
  target: Vector3;
  size: number;
  body: (number: number) => Matrix4 | undefined;
  solids: readonly Placed[];
}

export class Marks {
  readonly canvas = element("canvas", { id: "marks", "aria-hidden": "true" });
  private seats: Seat[] = [];
  private unit = { symbol: "m", si: 1 };
  /** Where each joint is on the canvas. */
  private spots = new Map<string, [number, number]>();
  /** The direction and distance of each name: while something moves, names do not jump about. */
  private readonly kept = new Map<string, number>();
  /** The joint that is pointed at. */
  pointed: string | null = null;
  /** Whether something moves: what stands still looks the same however it came there. */
  moving = false;

  set({ bodies, length, coordinates }: Description): void {
    const seats = new Map<string, Seat>();
    // The last body of a joint is that on its platform side.
    bodies.forEach(({ seats: own }: Body, body) => own.forEach(({ joint, at, axis }) =>
      seats.set(joint, { joint, body, at: new Vector3(...at), axis: axis && new Vector3(...axis) })));
    this.seats = [...seats.values()];
    const si = coordinates.find(({ quantity }) => quantity === "length")?.si;
    this.unit = { symbol: length, si: si ?? UNITS[length] ?? 1 };
  }

  /** The joint at a place of the canvas, if there is one. */
  near(x: number, y: number): string | null {
    let [best, least]: [string | null, number] = [null, 9];
    for (const [joint, [a, b]] of this.spots) {
      const distance = Math.hypot(a - x, b - y);
      if (distance < least) [best, least] = [joint, distance];
    }
    return best;
  }

  draw(sight: Sight): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const context = this.canvas.getContext("2d");
    if (!context || !width) return;
    const ratio = Math.min(devicePixelRatio, 2);
    const [wide, high] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (this.canvas.width !== wide) this.canvas.width = wide;
    if (this.canvas.height !== high) this.canvas.height = high;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    const theme = getComputedStyle(document.documentElement);
    const ink = (name: string) => theme.getPropertyValue(`--${name}`).trim();
    const { camera, target, size, body } = sight;
    camera.updateMatrixWorld();
    const seen = (point: Vector3): [number, number] => {
      const { x, y } = point.clone().project(camera);
      return [((x + 1) / 2) * width, ((1 - y) / 2) * height];
    };
    const line = (...points: [number, number][]) => {
      context.beginPath();
      points.forEach(([x, y], i) => context[i ? "lineTo" : "moveTo"](x, y));
      context.stroke();
    };
    const write = (text: string, x: number, y: number, bold = false) => {
      context.font = `${bold ? "600 " : ""}12px system-ui, sans-serif`;
      [context.lineJoin, context.lineWidth, context.strokeStyle] = ["round", 3, ink("ground")];
      context.strokeText(text, x, y);
      context.fillStyle = ink(bold ? "mark" : "ink");
      context.fillText(text, x, y);
    };
    context.textBaseline = "middle";
    // Nothing is written under what lies over the view. The text below it comes and goes: one line of it counts.
    const covered = ["legend", "viewing"].map((id) => byId(id)).map(({ offsetLeft: x, offsetTop: y, offsetWidth: wide, offsetHeight: high }) =>
      ({ x, y, wide, high }));
    const corner = covered[1]!.y + covered[1]!.high;

    // The joints, and which of them share a name.
    this.spots.clear();
    const groups: { at: [number, number]; names: string[] }[] = [];
    for (const { joint, body: number, at, axis } of this.seats) {
      const matrix = body(number);
      if (!matrix) continue;
      const place = at.clone().applyMatrix4(matrix);
      const spot = seen(place);
      this.spots.set(joint, spot);
      const group = groups.find(({ at: [x, y] }) => Math.hypot(x - spot[0], y - spot[1]) < SAME);
      if (group) group.names.push(joint);
      else groups.push({ at: spot, names: [joint] });
      if (joint !== this.pointed) continue;
      [context.strokeStyle, context.lineWidth] = [ink("mark"), 2];
      context.beginPath();
      context.arc(...spot, 10, 0, 2 * Math.PI);
      context.stroke();
      if (!axis) continue;
      const along = axis.clone().transformDirection(matrix).multiplyScalar(AXIS * size);
      context.setLineDash([6, 4]);
      line(seen(place.clone().sub(along)), seen(place.clone().add(along)));
      context.setLineDash([]);
    }

    const named = byId<HTMLInputElement>("names").checked;
    if (named) this.names(groups, [width, height - STATUS, covered], drawn(sight, seen), context, line, write, ink("quiet"));
    else if (this.pointed && this.spots.has(this.pointed)) {
      const [x, y] = this.spots.get(this.pointed)!;
      write(this.pointed, x + 14, y, true);
    }

    // The axes of the base frame, as the camera sees their directions.
    const from: [number, number] = [width - 56, corner + 48];
    const turned = camera.quaternion.clone().invert();
    (["x", "y", "z"] as const).forEach((name, i) => {
      const way = new Vector3().setComponent(i, 1).applyQuaternion(turned);
      const to = (reach: number): [number, number] => [from[0] + reach * way.x, from[1] - reach * way.y];
      [context.strokeStyle, context.lineWidth] = [ink("quiet"), 1.5];
      line(from, to(28));
      context.textAlign = "center";
      write(name, ...to(36));
    });

    // A length, as it is seen where the camera looks.
    const pixels = height / (2 * Math.tan((camera.fov * Math.PI) / 360) * camera.position.distanceTo(target));
    const most = 110 / (pixels * this.unit.si);
    const power = 10 ** Math.floor(Math.log10(most));
    const length = power * [5, 2, 1].find((times) => times * power <= most)!;
    const [right, far, low] = [width - 14, length * this.unit.si * pixels, corner + 118];
    [context.strokeStyle, context.lineWidth] = [ink("quiet"), 1.5];
    line([right - far, low - 5], [right - far, low], [right, low], [right, low - 5]);
    context.textAlign = "right";
    write(`${short(length)} ${this.unit.symbol}`, right - 2, low - 10);
  }

  /** Writes the names beside their joints, clear of each other and of the solids as far as possible. */
  private names(
    groups: { at: [number, number]; names: string[] }[], [width, height, covered]: [number, number, Room[]], solid: Set<number>,
    context: CanvasRenderingContext2D, line: (...points: [number, number][]) => void,
    write: (text: string, x: number, y: number, bold?: boolean) => void, leader: string,
  ): void {
    context.textAlign = "left";
    const taken: Box[] = [];
    for (const { at: [x, y], names } of groups) {
      const bold = this.pointed !== null && names.includes(this.pointed);
      context.font = "12px system-ui, sans-serif";
      const text = names.join(", ");
      const wide = context.measureText(text).width;
      const before = this.moving ? this.kept.get(names[0]!) : undefined;
      let best = { cost: Infinity, box: { x, y, wide }, choice: 0 };
      DISTANCES.forEach((distance, far) => {
        for (let direction = 0; direction < DIRECTIONS; direction++) {
          const angle = (2 * Math.PI * direction) / DIRECTIONS;
          // The nearest point of the text's box is at the distance.
          const box = { wide, x: x + distance * Math.cos(angle) - (wide / 2) * (1 - Math.cos(angle)), y: y - (distance + LINE / 2) * Math.sin(angle) };
          const choice = far * DIRECTIONS + direction;
          let cost = COST.pixel * distance + (choice === before ? 0 : COST.moved);
          cost += COST.name * taken.filter((other) => overlap(box, other)).length;
          const under = ({ x, y, wide: across, high }: Room) =>
            box.x < x + across && x < box.x + wide && box.y - LINE / 2 < y + high && y < box.y + LINE / 2;
          if (box.x < 2 || box.x + wide > width - 2 || box.y < LINE || box.y > height - LINE || covered.some(under)) cost += COST.outside;
          for (let a = Math.floor(box.x / CELL); a <= (box.x + wide) / CELL; a++) {
            for (const b of [box.y - LINE / 3, box.y + LINE / 3]) if (solid.has(cell(a, Math.floor(b / CELL)))) cost++;
          }
          if (cost < best.cost) best = { cost, box, choice };
        }
      });
      this.kept.set(names[0]!, best.choice);
      const { box } = best;
      taken.push(box);
      const end: [number, number] = [Math.min(Math.max(x, box.x), box.x + wide), Math.min(Math.max(y, box.y - LINE / 2), box.y + LINE / 2)];
      if (Math.hypot(end[0] - x, end[1] - y) > DISTANCES[0]! + 1) {
        [context.strokeStyle, context.lineWidth] = [leader, 0.7];
        line([x, y], end);
      }
      write(text, box.x, box.y, bold);
    }
  }
}

/** Units of length, metres: for a mechanism without a coordinate that is one. */
const UNITS: Record<string, number> = { mm: 1e-3, cm: 1e-2, in: 0.0254 };

const cell = (column: number, row: number) => row * 4096 + column;

/** The cells in which the axis of a solid is. */
function drawn({ solids, body }: Sight, seen: (point: Vector3) => [number, number]): Set<number> {
  const cells = new Set<number>();
  const matrix = new Matrix4();
  for (const { body: number, local } of solids) {
    const place = body(number);
    if (!place) continue;
    matrix.multiplyMatrices(place, local);
    const [from, to] = [-0.5, 0.5].map((end) => seen(new Vector3(0, end, 0).applyMatrix4(matrix))) as [[number, number], [number, number]];
    const steps = Math.min(400, Math.ceil(Math.hypot(to[0] - from[0], to[1] - from[1]) / CELL));
    for (let i = 0; i <= steps; i++) {
      const share = steps ? i / steps : 0;
      cells.add(cell(Math.floor((from[0] + share * (to[0] - from[0])) / CELL), Math.floor((from[1] + share * (to[1] - from[1])) / CELL)));
    }
  }
  return cells;
}

function overlap(a: Box, b: Box): boolean {
  return a.x < b.x + b.wide + 3 && b.x < a.x + a.wide + 3 && Math.abs(a.y - b.y) < LINE + 1;
}
