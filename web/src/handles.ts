// Handles by which the platform is dragged: an arrow for each shift, a ring for each turn, a ball for the place.

import {
  ConeGeometry, CylinderGeometry, Group, Mesh, Object3D, Plane, Quaternion, Raycaster, SphereGeometry, TorusGeometry, Vector2, Vector3,
  type Ray, type ShaderMaterial,
} from "three";
import { lit } from "./materials";
import { corners } from "./sight";
import type { Coordinate, Handles, Move } from "./types";
import type { View } from "./view";

/** Lengths, as shares of the size of the mechanism. */
const REACH = 0.3;
const THICK = 0.005;
/** They are seen through, but for the one that the pointer is over. */
const OPACITY = 0.55;

const UP = new Vector3(0, 1, 0);
const shaft = new CylinderGeometry(1, 1, 1, 8).translate(0, 0.5, 0);
const tip = new ConeGeometry(1, 1, 12);
const knob = new SphereGeometry(1, 14, 10);
const ring = new TorusGeometry(1, 0.012, 5, 40);
const wideRing = new TorusGeometry(1, 0.1, 6, 24);

interface Handle {
  /** The coordinates that it moves, with how the platform moves with each. */
  moves: { coordinate: Coordinate; move: Move }[];
  turns: boolean;
  object: Object3D;
  /** What is hit by the pointer: thicker than what is drawn. */
  target: Mesh;
  material: ShaderMaterial;
}

interface Drag {
  handle: Handle;
  at: Vector3;
  from: Vector3;
  start: Record<string, number>;
}

export interface HandleEvents {
  pose(): Record<string, number>;
  moved(values: Record<string, number>, final: boolean): void;
}

export class HandleSet {
  readonly group = new Group();
  private handles: Handle[] = [];
  private drag: Drag | null = null;
  private hovered: Handle | undefined;
  private key = "";
  private at = new Vector3();
  private readonly rays = new Raycaster();

  constructor(private readonly view: View, host: HTMLElement, private readonly events: HandleEvents) {
    view.scene.add(this.group);
    // Before the camera's controls get it.
    host.addEventListener("pointerdown", (event) => this.press(event), true);
    host.addEventListener("pointermove", (event) => this.slide(event), true);
    for (const end of ["pointerup", "pointercancel"]) host.addEventListener(end, (event) => this.release(event as PointerEvent), true);
  }

  /** Shows the handles of a pose. Those of the same coordinates are moved, and not made anew. */
  set(coordinates: Coordinate[], { at, moves }: Handles, size: number): void {
    const known = coordinates.flatMap((coordinate, i) => (moves[i] ? [{ coordinate, move: moves[i] }] : []));
    // A coordinate that shifts the platform may turn it too, by an angle that follows.
    const turns = ({ coordinate }: { coordinate: Coordinate }) => coordinate.quantity === "angle";
    const shifts = known.filter((one) => !turns(one));
    const wanted = known.map((one) => ({ moves: [one], turns: turns(one) }));
    if (shifts.length > 1) wanted.push({ moves: shifts, turns: false });
    const key = JSON.stringify(wanted.map(({ moves, turns }) => [moves.map(({ coordinate }) => coordinate.name), turns]));
    if (key !== this.key) {
      this.key = key;
      this.group.clear();
      this.handles = wanted.map((one) => this.make(one));
    }
    this.at.set(...at);
    this.group.position.copy(this.at);
    let rings = 0;
    this.handles.forEach((handle, number) => {
      handle.moves = wanted[number]!.moves;
      const { move } = handle.moves[0]!;
      if (handle.moves.length > 1) handle.object.scale.setScalar(size * 0.022);
      else {
        const axis = new Vector3(...(handle.turns ? move.turn : move.shift));
        if (axis.length() > 0) handle.object.quaternion.copy(new Quaternion().setFromUnitVectors(handle.turns ? new Vector3(0, 0, 1) : UP, axis.normalize()));
        handle.object.scale.setScalar(size * REACH * (handle.turns ? 0.55 + 0.1 * rings++ : 1));
      }
    });
  }

  /** The ends of the handles that are shown. */
  ends(): Vector3[] {
    return corners(this.group);
  }

  private make({ moves, turns }: Pick<Handle, "moves" | "turns">): Handle {
    const material = lit("#e69f00");
    // They are seen through everything else.
    [material.depthTest, material.transparent] = [false, true];
    material.uniforms["opacity"]!.value = OPACITY;
    const object = new Group();
    object.renderOrder = 2;
    let target: Mesh;
    if (moves.length > 1) {
      object.add(new Mesh(knob, material));
      target = new Mesh(knob);
      target.scale.setScalar(1.8);
    } else if (turns) {
      object.add(new Mesh(ring, material));
      target = new Mesh(wideRing);
    } else {
      const [stem, head] = [new Mesh(shaft, material), new Mesh(tip, material)];
      stem.scale.set(THICK / REACH, 1, THICK / REACH);
      head.scale.set(0.05, 0.15, 0.05);
      head.position.y = 1;
      object.add(stem, head);
      target = new Mesh(shaft);
      target.scale.set(0.09, 1.12, 0.09);
    }
    // It is hit, but not drawn.
    target.visible = false;
    object.add(target);
    this.group.add(object);
    return { moves, turns, object, target, material };
  }

  private ray(event: PointerEvent): Ray {
    const box = this.view.canvas.getBoundingClientRect();
    const place = new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    this.rays.setFromCamera(place, this.view.camera);
    return this.rays.ray;
  }

  private under(event: PointerEvent): Handle | undefined {
    if (!this.group.visible || event.target !== this.view.canvas) return undefined;
    this.ray(event);
    this.group.updateMatrixWorld(true);
    const [hit] = this.rays.intersectObjects(this.handles.map(({ target }) => target), false);
    return this.handles.find(({ target }) => target === hit?.object);
  }

  private press(event: PointerEvent): void {
    const handle = this.under(event);
    if (!handle || event.button !== 0) return;
    const from = this.point(handle, this.at, this.ray(event));
    if (!from) return;
    event.stopPropagation();
    this.view.canvas.setPointerCapture(event.pointerId);
    this.drag = { handle, at: this.at.clone(), from, start: this.events.pose() };
  }

  private slide(event: PointerEvent): void {
    if (this.drag) {
      event.stopPropagation();
      this.move(event, false);
      return;
    }
    if (event.buttons) return;
    const handle = this.under(event);
    if (handle === this.hovered) return;
    this.hovered = handle;
    const names = handle?.moves.map(({ coordinate }) => coordinate.name).join(", ");
    this.view.canvas.style.cursor = handle ? "grab" : "";
    this.view.canvas.title = names ? `Drag to change ${names}` : "";
    for (const { material: { uniforms } } of this.handles) uniforms["opacity"]!.value = OPACITY;
    if (handle) handle.material.uniforms["opacity"]!.value = 1;
    this.view.draw();
  }

  private release(event: PointerEvent): void {
    if (!this.drag) return;
    event.stopPropagation();
    this.move(event, true);
    this.drag = null;
  }

  /** Where the pointer is on the line, or in the plane, of a handle. */
  private point(handle: Handle, at: Vector3, ray: Ray): Vector3 | null {
    const axes = handle.moves.map(({ move }) => new Vector3(...(handle.turns ? move.turn : move.shift)).normalize());
    const [axis, second] = axes as [Vector3, Vector3 | undefined];
    if (handle.turns || second) {
      const normal = handle.turns ? axis : axes.length === 2 ? axis.clone().cross(second!).normalize() : ray.direction.clone();
      return ray.intersectPlane(new Plane().setFromNormalAndCoplanarPoint(normal, at), new Vector3());
    }
    // The place on the line that is nearest to the ray.
    const across = ray.direction.clone().cross(axis);
    if (across.lengthSq() < 1e-6) return null;
    const way = at.clone().sub(ray.origin);
    return at.clone().addScaledVector(axis, way.cross(ray.direction).dot(across) / across.lengthSq());
  }

  private move(event: PointerEvent, final: boolean): void {
    const { handle, at, from, start } = this.drag!;
    const now = this.point(handle, at, this.ray(event));
    if (!now) return;
    const values: Record<string, number> = {};
    for (const { coordinate: { name, si }, move } of handle.moves) {
      let change: number;
      if (handle.turns) {
        const axis = new Vector3(...move.turn).normalize();
        const [before, after] = [from.clone().sub(at), now.clone().sub(at)];
        change = Math.atan2(before.clone().cross(after).dot(axis), before.dot(after)) / Math.hypot(...move.turn);
      } else {
        const shift = new Vector3(...move.shift);
        change = now.clone().sub(from).dot(shift) / shift.lengthSq();
      }
      values[name] = Number((start[name]! + change / si).toPrecision(5));
    }
    this.events.moved(values, final);
  }
}
