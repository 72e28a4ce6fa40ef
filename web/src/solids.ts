// The solids of all bodies. All solids of one shape and one colour are drawn at once: a mechanism has a hundred of them,
// and a call for each takes more time than its pixels.

import { BoxGeometry, CylinderGeometry, Group, InstancedMesh, Matrix4, Quaternion, SphereGeometry, Vector3 } from "three";
import type { PartName } from "./colours";
import type { Materials } from "./materials";
import type { Body, Solid } from "./types";

const GEOMETRIES = {
  cylinder: new CylinderGeometry(1, 1, 1, 16),
  ball: new SphereGeometry(1, 14, 10),
  block: new BoxGeometry(2, 1, 2),
};

const UP = new Vector3(0, 1, 0);

/** A solid of a body: its place among the instances of its mesh, and in its body. */
export interface Placed {
  mesh: InstancedMesh;
  index: number;
  body: number;
  part: PartName;
  local: Matrix4;
}

export class Solids {
  readonly group = new Group();
  private given: Body[] = [];
  /** The names of the bodies that are too near to each other. */
  private near = new Set<string>();
  private solids: Placed[] = [];
  private kept: { key: string; meshes: InstancedMesh[] } = { key: "", meshes: [] };
  /** Where the bodies are. */
  private bodies: Matrix4[] = [];
  private readonly matrix = new Matrix4();

  constructor(private readonly materials: Materials) {}

  /** Takes the bodies of a mechanism, at home. Those of the same mechanism with other dimensions are changed in place. */
  set(bodies: Body[]): void {
    this.given = bodies;
    this.bodies = bodies.map(({ origin }) => new Matrix4().setPosition(...origin));
    this.sort();
  }

  /** Takes the names of the bodies that are too near to each other. */
  setNear(names: string[]): void {
    const key = names.join("\n");
    if (key === [...this.near].join("\n")) return;
    this.near = new Set(names);
    this.sort();
  }

  /** Every solid, with its body and its place there. */
  get all(): readonly Placed[] {
    return this.solids;
  }

  /** The parts that there are. */
  parts(): Set<PartName> {
    return new Set(this.solids.map(({ part }) => part));
  }

  /** Puts each solid among those of its shape and its part. */
  private sort(): void {
    const part = (solid: Solid, body: Body) => (solid.member !== null && this.near.has(solid.member) ? "interfering" : partOf(solid, body));
    const all = this.given.flatMap((body, number) => body.solids.map((solid) => ({ solid, body: number, part: part(solid, body) })));
    const kinds = new Map<string, { shape: Solid["shape"]; part: PartName; count: number }>();
    const places = all.map(({ solid: { shape }, part }) => {
      const name = `${shape} ${part}`;
      const kind = kinds.get(name) ?? { shape, part, count: 0 };
      kinds.set(name, kind);
      return { name, index: kind.count++ };
    });
    const key = JSON.stringify([...kinds]);
    if (key !== this.kept.key) {
      this.kept.meshes.forEach((mesh) => mesh.dispose());
      const meshes = [...kinds.values()].map(({ shape, part, count }) => {
        const mesh = new InstancedMesh(GEOMETRIES[shape], this.materials.of(part), count);
        // They are as near to each other as the whole is to the camera.
        mesh.frustumCulled = false;
        return mesh;
      });
      this.kept = { key, meshes };
      this.group.clear();
      if (meshes.length) this.group.add(...meshes);
    }
    const names = [...kinds.keys()];
    this.solids = all.map(({ solid, body, part }, i) => ({
      mesh: this.kept.meshes[names.indexOf(places[i]!.name)]!, index: places[i]!.index, body, part, local: local(solid),
    }));
    this.update();
  }

  /** Moves the bodies: 16 numbers of a matrix for each, column by column. */
  place(numbers: Float32Array): void {
    this.bodies.forEach((matrix, number) => matrix.fromArray(numbers, 16 * number));
    this.update();
  }

  /** Where a body is. */
  body(number: number): Matrix4 | undefined {
    return this.bodies[number];
  }

  /** The ends of the solids of bodies: those of imaginary joints do not count for its size. */
  ends(): Vector3[] {
    const measured = this.solids.filter(({ part }) => part !== "imaginary");
    return measured.flatMap(({ body, local }) => [-0.5, 0.5].map((end) =>
      new Vector3(0, end, 0).applyMatrix4(local).applyMatrix4(this.bodies[body]!)));
  }

  private update(): void {
    for (const { mesh, index, body, local } of this.solids) mesh.setMatrixAt(index, this.matrix.multiplyMatrices(this.bodies[body]!, local));
    for (const mesh of this.kept.meshes) mesh.instanceMatrix.needsUpdate = true;
  }
}

function partOf(solid: Solid, body: Body): PartName {
  return solid.material === "link" ? (body.section ?? "lower") : solid.material;
}

/** The place of a solid in its body. */
function local({ shape, from, to, radius }: Solid): Matrix4 {
  const [start, end] = [new Vector3(...from), new Vector3(...to)];
  const axis = end.clone().sub(start);
  const length = axis.length();
  const turned = new Quaternion();
  if (length > 0) turned.setFromUnitVectors(UP, axis.divideScalar(length));
  return new Matrix4().compose(start.lerp(end, 0.5), turned, new Vector3(radius, shape === "ball" ? radius : length, radius));
}
