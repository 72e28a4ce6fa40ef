// The workspace as a body in three coordinates, in the space of the mechanism.

import { BufferAttribute, BufferGeometry, DoubleSide, FrontSide, Matrix4, Mesh, Vector3, type ShaderMaterial } from "three";
import { beyond } from "./beyond";
import { byId, element, grouped } from "./dom";
import { lit } from "./materials";
import type { BodyState } from "./state";
import type { Description, Handles, WorkspaceBody } from "./types";

/** How high the range of an angle is drawn, as a share of the size of the mechanism. */
const HEIGHT = 0.9;

/** The directions for coordinates that are no positions, in the order in which they are taken. */
const FREE = [new Vector3(0, 0, 1), new Vector3(1, 0, 0), new Vector3(0, 1, 0)];

export class BodyMesh {
  readonly mesh: Mesh<BufferGeometry, ShaderMaterial>;
  private ranges: [number, number][] = [];
  private corners = 0;

  constructor() {
    const material = lit("#009e73", DoubleSide);
    material.uniforms["opacity"]!.value = 0.42;
    material.transparent = true;
    material.depthWrite = false;
    this.mesh = new Mesh(new BufferGeometry(), material);
    this.mesh.matrixAutoUpdate = false;
    this.mesh.frustumCulled = false;
    this.mesh.visible = false;
  }

  /** Takes a surface; the buffers stay the same where they are large enough, and the part that is used is sent. */
  set({ corners, triangles, ranges }: WorkspaceBody, bytes: Uint8Array<ArrayBuffer>): void {
    [this.ranges, this.corners] = [ranges, corners];
    const { geometry } = this.mesh;
    const vectors = (place: number) => new Float32Array(bytes.buffer, bytes.byteOffset + 12 * corners * place, 3 * corners);
    this.send("position", vectors(0));
    this.send("normal", vectors(1));
    const numbers = new Uint32Array(bytes.buffer, bytes.byteOffset + 24 * corners, 3 * triangles);
    let { index } = geometry;
    if (!index || index.count < numbers.length) geometry.setIndex(index = new BufferAttribute(new Uint32Array(Math.ceil(1.5 * numbers.length)), 1));
    put(index, numbers);
    geometry.setDrawRange(0, numbers.length);
  }

  /** Draws its far side too, or its near side alone: where the processor draws, that is what a frame of it takes. */
  still(still: boolean): void {
    this.mesh.material.side = still ? DoubleSide : FrontSide;
  }

  /** Whether there is a surface. */
  get known(): boolean {
    return this.corners > 0;
  }

  /** The corners of the surface that is shown, where they are in space. */
  ends(): Vector3[] {
    const places = this.mesh.geometry.getAttribute("position") as BufferAttribute | undefined;
    if (!places || !this.mesh.visible) return [];
    return Array.from({ length: this.corners }, (_, i) => new Vector3().fromBufferAttribute(places, i).applyMatrix4(this.mesh.matrix));
  }

  /** Draws nothing until the next surface. */
  clear(): void {
    this.corners = 0;
    this.mesh.geometry.setDrawRange(0, 0);
  }

  /** Puts the body where its coordinates are positions, and tells how the others are drawn. */
  place(names: string[], description: Description, pose: Record<string, number>, handles: Handles, size: number): string {
    const directions: (Vector3 | null)[] = names.map((name) => {
      const number = description.coordinates.findIndex((coordinate) => coordinate.name === name);
      const [coordinate, move] = [description.coordinates[number], handles.moves[number]];
      const shift = new Vector3(...(move?.shift ?? [0, 0, 0]));
      return coordinate?.quantity === "length" && Math.abs(shift.length() - 1) < 1e-6 ? shift : null;
    });
    const notes: string[] = [];
    const used = directions.filter((direction) => direction !== null);
    const columns = names.map((name, i) => {
      const known = directions[i];
      if (known) return known;
      const free = FREE.map((axis) => used.reduce((rest, one) => rest.addScaledVector(one, -rest.dot(one)), axis.clone()));
      const direction = (free.find((rest) => rest.length() > 0.3) ?? free[0]!).normalize();
      used.push(direction);
      const [low, high] = this.ranges[i] ?? [0, 1];
      const { unit } = description.coordinates.find((coordinate) => coordinate.name === name)!;
      notes.push(`${name} (${unit}) ${Math.abs(direction.z) > 0.7 ? "upwards" : "sideways"}`);
      return direction.multiplyScalar((HEIGHT * size) / (high - low || 1));
    });
    const [a, b, c] = columns as [Vector3, Vector3, Vector3];
    const at = new Vector3(...handles.at);
    names.forEach((name, i) => {
      const { home, si } = description.coordinates.find((coordinate) => coordinate.name === name)!;
      at.addScaledVector(columns[i]!, -(pose[name] ?? home) * si);
    });
    this.mesh.matrix = new Matrix4().makeBasis(a, b, c).setPosition(at);
    this.mesh.matrixWorldNeedsUpdate = true;
    if (!notes.length) return "It is in the base frame, for the platform's point.";
    const others = names.filter((_, i) => directions[i]);
    const where = others.length ? `${others.join(" and ")} in the base frame; ` : "";
    return `${where}${notes.join(", ")}: no position, so that it has no place of its own there. The platform is at the present values.`;
  }

  /** Puts vectors into an attribute, which has room for them. */
  private send(name: string, vectors: Float32Array): void {
    const { geometry } = this.mesh;
    let attribute = geometry.getAttribute(name) as BufferAttribute | undefined;
    if (!attribute || attribute.array.length < vectors.length) {
      attribute = new BufferAttribute(new Float32Array(3 * Math.ceil(0.5 * vectors.length)), 3);
      geometry.setAttribute(name, attribute);
    }
    put(attribute, vectors);
  }
}

function put(attribute: BufferAttribute, numbers: Float32Array | Uint32Array): void {
  attribute.array.set(numbers);
  attribute.clearUpdateRanges();
  attribute.addUpdateRange(0, numbers.length);
  attribute.needsUpdate = true;
}

/** The controls of the body. */
export class BodyPanel {
  private readonly show = byId<HTMLInputElement>("body-show");
  private readonly others = byId<HTMLSelectElement>("body-others");
  private readonly axes = [0, 1, 2].map((i) => byId<HTMLSelectElement>(`body-${i}`));
  private state!: BodyState;

  constructor(changed: (body: BodyState) => void) {
    this.show.addEventListener("change", () => changed({ ...this.state, show: this.show.checked }));
    this.others.addEventListener("change", () => changed({ ...this.state, others: this.others.value as BodyState["others"] }));
    this.axes.forEach((select, i) => select.addEventListener("change", () => {
      const names = this.axes.map(({ value }) => value);
      // A coordinate cannot be on two axes: they change places.
      const before = this.chosen();
      const twice = names.findIndex((name, other) => other !== i && name === select.value);
      if (twice >= 0) names[twice] = before[i]!;
      changed({ ...this.state, axes: names });
    }));
  }

  private names: string[] = [];

  build({ coordinates }: Description): void {
    this.names = coordinates.map(({ name }) => name);
    const none = this.names.length < 3;
    byId("body-panel").hidden = none;
    this.show.disabled = none;
    this.show.parentElement!.title = none ? "A body needs three coordinates" : "";
    for (const select of this.axes) select.replaceChildren(...this.names.map((name) => element("option", { value: name }, name)));
  }

  /** The coordinates of the body: what was set, and else the first three. */
  chosen(): string[] {
    const { axes } = this.state;
    const usable = axes && axes.length === 3 && new Set(axes).size === 3 && axes.every((name) => this.names.includes(name));
    return usable ? axes : this.names.slice(0, 3);
  }

  /** Whether there is a body to show. */
  get wanted(): boolean {
    return this.state.show && this.names.length >= 3;
  }

  update(state: BodyState): void {
    this.state = state;
    this.show.checked = state.show;
    this.others.value = state.others;
    this.chosen().forEach((name, i) => (this.axes[i]!.value = name));
    byId("body-facts").hidden = !this.wanted;
  }

  /** Takes a body, with the coordinates along which the workspace goes beyond the grid; nothing where it was refused. */
  setBody(body: WorkspaceBody | null, past: string[]): void {
    byId("body-beyond").textContent = body ? beyond(past) : "";
    if (!body) {
      byId("body-count").textContent = "–";
      return;
    }
    const { inside, points, poses } = body;
    byId("body-count").textContent = `${inside} of ${points} points, from ${grouped(poses)} poses`;
  }

  setNote(note: string): void {
    const box = byId("body-note");
    if (box.textContent !== note) box.textContent = note;
  }
}
