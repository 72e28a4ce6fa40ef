// From where the camera sees all of something, in the part of the view that nothing lies over.

import { InstancedMesh, Line, Matrix4, Mesh, Vector3, type Object3D } from "three";
import { byId } from "./dom";

/** A part of the view: its middle, from -1 to 1 to the right and upwards, and the shares of the width and the height it has. */
export interface Room {
  x: number;
  y: number;
  wide: number;
  high: number;
}

/** What is smaller than this share of the view is no room for a mechanism. */
const LEAST = 0.2;

/** The free parts of the view: beside the legend, and below it. */
export function rooms(host: HTMLElement): Room[] {
  const all = host.getBoundingClientRect();
  const box = (id: string) => byId(id).getBoundingClientRect();
  const [legend, viewing, status] = [box("legend"), box("viewing"), box("status")];
  const from = (left: number, top: number): Room => ({
    x: (left + all.right - all.left - all.right) / all.width,
    y: (all.top + all.bottom - top - status.top) / all.height,
    wide: (all.right - left) / all.width,
    high: (status.top - top) / all.height,
  });
  const free = [from(legend.right, viewing.bottom), from(all.left, Math.max(legend.bottom, viewing.bottom))];
  const large = free.filter(({ wide, high }) => wide > LEAST && high > LEAST);
  return large.length ? large : [{ x: 0, y: 0, wide: 1, high: 1 }];
}

/** The eye, the point about which it turns, and how far they are from each other. */
export interface Sight {
  eye: Vector3;
  target: Vector3;
  distance: number;
}

/** The nearest eye that, looking from a direction, sees all points at most at these tangents from its axis. */
export function sight(points: Vector3[], from: Vector3, up: Vector3, [wide, high]: [number, number]): Sight {
  const across = new Vector3().crossVectors(up, from).normalize();
  const upwards = new Vector3().crossVectors(from, across);
  const most = (value: (point: Vector3) => number) => points.reduce((most, point) => Math.max(most, value(point)), -Infinity);
  // A point p is seen where (p - eye) axis <= tangent (eye - p) from: the eye has at least the largest p axis + tangent p from.
  // With the same of the other side, the least depth is where both are equal, in the middle.
  const [sideways, vertical] = ([[across, wide], [upwards, high]] as const).map(([axis, tangent]) => {
    const right = most((point) => point.dot(axis) + tangent * point.dot(from));
    const left = most((point) => -point.dot(axis) + tangent * point.dot(from));
    return { middle: (right - left) / 2, depth: (right + left) / (2 * tangent) };
  }) as [{ middle: number; depth: number }, { middle: number; depth: number }];
  const depth = Math.max(sideways.depth, vertical.depth);
  const distance = Math.max(depth - (most((point) => point.dot(from)) - most((point) => -point.dot(from))) / 2, 1e-9);
  const target = from.clone().multiplyScalar(depth - distance).addScaledVector(across, sideways.middle).addScaledVector(upwards, vertical.middle);
  return { eye: target.clone().addScaledVector(from, distance), target, distance };
}

/** The corners of all that is drawn of objects, where they are in space. */
export function corners(...objects: Object3D[]): Vector3[] {
  const found: Vector3[] = [];
  const add = (one: Mesh | Line, matrix: Matrix4) => {
    const places = one.geometry.getAttribute("position");
    for (let i = 0; i < places.count; i++) found.push(new Vector3().fromBufferAttribute(places, i).applyMatrix4(matrix));
  };
  for (const object of objects) {
    object.updateWorldMatrix(true, true);
    object.traverseVisible((one) => {
      if (one instanceof InstancedMesh) {
        for (let i = 0; i < one.count; i++) {
          const matrix = new Matrix4();
          one.getMatrixAt(i, matrix);
          add(one, matrix.premultiply(one.matrixWorld));
        }
      } else if (one instanceof Mesh || one instanceof Line) add(one, one.matrixWorld);
    });
  }
  return found;
}
