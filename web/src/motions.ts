// The motions of the sections: a disc for a plane, a ball for a centre, a dashed line for an axis.

import { BufferGeometry, CircleGeometry, Group, Line, Matrix4, Mesh, Object3D, SphereGeometry, Vector3 } from "three";
import type { Materials } from "./materials";
import type { Body, Description, Subspace } from "./types";

const ball = new SphereGeometry(1, 18, 12);
const disc = new CircleGeometry(1, 48);
const dashed = new Line(new BufferGeometry().setFromPoints([new Vector3(0, -0.5, 0), new Vector3(0, 0.5, 0)])).computeLineDistances();

export class Motions {
  /** What stays on the base. */
  readonly fixed = new Group();
  /** What the lower section carries. */
  readonly carried = new Group();
  /** The number of the body that carries it; nothing where there is no such body. */
  private carrier = -1;

  constructor(private readonly materials: Materials) {
    this.carried.matrixAutoUpdate = false;
  }

  set({ bodies, lower, upper, intersection }: Description): void {
    this.fixed.clear();
    this.carried.clear();
    this.carrier = bodies.findIndex((body) => body.name === "lower_platform");
    const origin = new Vector3(...(bodies[this.carrier]?.origin ?? [0, 0, 0]));
    const size = measure(bodies);
    const platform = new Vector3(...(bodies.find((body) => body.name === "platform")?.origin ?? [0, 0, 0]));
    const draw = (on: Group, space: Subspace, from: Vector3, size: number) => {
      const at = (space.point ? new Vector3(...space.point) : platform.clone()).sub(from);
      const object = this.motion(space, size);
      if (object) on.add(object);
      object?.position.copy(at);
    };
    if (lower.dimension > 1) draw(this.fixed, lower, new Vector3(), size);
    if (upper.dimension > 1) draw(this.carried, upper, origin, 0.8 * size);
    if (intersection.direction) draw(this.carried, intersection, origin, 1.2 * size);
    this.place(() => new Matrix4().setPosition(origin));
  }

  /** Moves with the body that carries it. */
  place(body: (number: number) => Matrix4 | undefined): void {
    this.carried.matrix.copy(body(this.carrier) ?? new Matrix4());
    this.carried.matrixWorldNeedsUpdate = true;
  }

  private motion(space: Subspace, size: number): Object3D | null {
    if (space.name === "spherical") {
      const centre = new Mesh(ball, this.materials.of("motions"));
      centre.scale.setScalar(0.08 * size);
      return centre;
    }
    if (!space.direction) return null;
    const direction = new Vector3(...space.direction);
    if (/plan|schoenflies/.test(space.name)) {
      const plane = new Mesh(disc, this.materials.of("motions"));
      plane.scale.setScalar(0.6 * size);
      plane.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), direction);
      return plane;
    }
    const line = new Line(dashed.geometry, this.materials.dashes);
    line.scale.setScalar(1.2 * size);
    line.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), direction);
    return line;
  }
}

/** Half the width of a mechanism. */
function measure(bodies: Body[]): number {
  const origins = bodies.filter((body) => body.solids.length).map((body) => new Vector3(...body.origin));
  const widest = Math.max(...origins.map((origin) => origin.distanceTo(origins[0] ?? origin)), 0);
  return widest > 0 ? 0.5 * widest : 0.1;
}
