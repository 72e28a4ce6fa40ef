// The space that the mechanism is in: camera, light, and what the pointer does.

import { AmbientLight, Box3, DirectionalLight, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { PartName } from "./colours";
import { element } from "./dom";
import { Materials } from "./materials";
import { Marks } from "./marks";
import { nameLinks, showParts } from "./legend";
import { Motions } from "./motions";
import { corners, rooms, sight, type Room } from "./sight";
import { Solids } from "./solids";
import type { Description } from "./types";

/** The direction from which a mechanism is seen first. */
const FIRST = new Vector3(0.55, -0.75, 0.5);
/** How high the eye is at most, for flat mechanisms: seen from the side, they would be small. */
const HIGHEST = 1.1;

/** The share of the width and the height of its room that what the view fits has. */
const SHARE = 0.94;

export class View {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(35, 1, 0.01, 1000);
  readonly controls: OrbitControls;
  private readonly renderer: WebGLRenderer;
  private readonly materials = new Materials();
  private readonly solids = new Solids(this.materials);
  private readonly motions = new Motions(this.materials);
  private readonly marks = new Marks();
  /** The radius of the mechanism, metres. */
  size = 1;
  private drawn = false;
  /** The part of the view in whose middle the camera looks. */
  private room: Room = { x: 0, y: 0, wide: 1, high: 1 };

  constructor(private readonly host: HTMLElement) {
    this.renderer = new WebGLRenderer({ antialias: !drawnByProcessor(), alpha: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    host.append(this.renderer.domElement);
    host.after(this.marks.canvas);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener("change", () => this.draw());
    this.controls.addEventListener("start", () => this.still(false));
    this.controls.addEventListener("end", () => this.still(true));
    const sun = new DirectionalLight("#ffffff", 2);
    sun.position.set(0.4, -0.6, 1);
    this.camera.add(sun);
    const light = new AmbientLight("#ffffff", 1.4);
    this.scene.add(this.camera, light, this.solids.group, this.motions.fixed, this.motions.carried);
    new ResizeObserver(() => this.resize()).observe(host);
    this.resize();
  }

  /** What has been drawn on. */
  get canvas(): HTMLCanvasElement {
    return this.renderer.domElement;
  }

  /** Shows the bodies of a mechanism; `place` puts them where they are. */
  setMechanism(description: Description): void {
    this.solids.set(description.bodies);
    this.motions.set(description);
    this.marks.set(description);
    nameLinks(!description.upper.dimension);
    showParts(this.solids.parts());
    this.draw();
  }

  /** Moves the bodies: 16 numbers of a matrix for each, column by column. */
  place(bytes: Uint8Array<ArrayBuffer>): void {
    this.solids.place(new Float32Array(bytes.buffer, bytes.byteOffset, bytes.byteLength / 4));
    this.motions.place((number) => this.solids.body(number));
    this.draw();
  }

  /** Measures the mechanism as it is now. */
  measure(): void {
    const points = this.solids.ends();
    if (points.length) this.size = radius(points);
  }

  /** Looks at the whole mechanism and these points from the first direction. */
  first(others: Vector3[]): void {
    const { x, y, z } = new Box3().setFromPoints(this.corners()).getSize(new Vector3());
    const height = Math.min(HIGHEST, Math.max(FIRST.z, (0.4 * Math.max(x, y)) / Math.max(z, 1e-9)));
    this.look(others, FIRST.clone().setZ(height).normalize());
  }

  /** Looks at the whole mechanism and these points from the direction of the camera. */
  fit(others: Vector3[]): void {
    this.look(others, this.camera.position.clone().sub(this.controls.target).normalize());
  }

  /** Looks at the mechanism and these points, if they are not all seen. */
  takeIn(others: Vector3[]): void {
    this.camera.updateMatrixWorld();
    const seen = (point: Vector3) => {
      const { x, y } = point.clone().project(this.camera);
      return Math.max(Math.abs(x), Math.abs(y)) <= 1;
    };
    if (![...this.corners(), ...others].every(seen)) this.fit(others);
  }

  private corners(): Vector3[] {
    return corners(this.solids.group, this.motions.fixed, this.motions.carried);
  }

  private look(others: Vector3[], from: Vector3): void {
    const points = [...this.corners(), ...others];
    if (!points.length) return;
    const { clientWidth, clientHeight } = this.host;
    const tangent = SHARE * Math.tan((this.camera.fov * Math.PI) / 360);
    const aspect = clientWidth && clientHeight ? clientWidth / clientHeight : 1;
    const sights = rooms(this.host).map((room) =>
      ({ room, ...sight(points, from, this.camera.up, [tangent * aspect * room.wide, tangent * room.high]) }));
    // What is seen from nearer is larger.
    const { room, eye, target, distance } = sights.reduce((best, one) => (one.distance < best.distance ? one : best));
    this.room = room;
    this.controls.target.copy(target);
    this.camera.position.copy(eye);
    this.camera.near = distance / 100;
    this.camera.far = distance * 100;
    this.project();
    this.controls.update();
    this.draw();
  }

  /** Turns the camera about the mechanism, and moves it nearer: for the keyboard. */
  orbit(across: number, upwards: number, nearer = 1): void {
    const arm = this.camera.position.clone().sub(this.controls.target);
    arm.applyAxisAngle(new Vector3(0, 0, 1), across);
    const side = new Vector3().crossVectors(arm, this.camera.up).normalize();
    const turned = arm.clone().applyAxisAngle(side, upwards);
    if (Math.abs(turned.clone().normalize().z) < 0.995) arm.copy(turned);
    this.camera.position.copy(this.controls.target).addScaledVector(arm, nearer);
    this.controls.update();
    this.draw();
  }

  /** Takes the names of the bodies that are too near to each other. */
  setNear(names: string[]): void {
    this.solids.setNear(names);
    showParts(this.solids.parts());
    this.draw();
  }

  /** Makes all parts but one dim; nothing shows all of them. */
  highlight(part: PartName | null): void {
    this.materials.highlight(part);
    this.draw();
  }

  /** Whether nothing moves. */
  still(still: boolean): void {
    this.marks.moving = !still;
    this.draw();
  }

  /** Marks a joint; nothing marks none. */
  point(joint: string | null): void {
    if (joint === this.marks.pointed) return;
    this.marks.pointed = joint;
    this.draw();
  }

  /** The joint under the pointer. */
  under({ clientX, clientY }: PointerEvent): string | null {
    const box = this.canvas.getBoundingClientRect();
    return this.marks.near(clientX - box.left, clientY - box.top);
  }

  /** The picture, with what is written over it. */
  picture(): HTMLCanvasElement {
    this.render();
    const { width, height } = this.canvas;
    const both = element("canvas", { width, height });
    // What is drawn by a graphics card is not always printed.
    const context = both.getContext("2d", { willReadFrequently: true })!;
    for (const one of [this.canvas, this.marks.canvas]) context.drawImage(one, 0, 0, width, height);
    return both;
  }

  /** Draws at the next frame. */
  draw(): void {
    if (this.drawn) return;
    this.drawn = true;
    requestAnimationFrame(() => this.render());
  }

  private render(): void {
    this.drawn = false;
    const start = performance.now();
    this.renderer.render(this.scene, this.camera);
    const { camera, size, controls: { target }, solids } = this;
    this.marks.draw({ camera, target, size, body: (number) => solids.body(number), solids: solids.all });
    document.body.dataset["frameMs"] = (performance.now() - start).toFixed(2);
  }

  /** Puts what the camera looks at into the middle of its room. */
  private project(): void {
    const { clientWidth: width, clientHeight: height } = this.host;
    if (!width || !height) return;
    this.camera.setViewOffset(width, height, (-this.room.x * width) / 2, (this.room.y * height) / 2, width, height);
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.host;
    if (!width || !height) return;
    this.project();
    this.renderer.setSize(width, height);
    this.draw();
  }
}

/** The radius of a ball about the middle of points that holds them all. */
function radius(points: Vector3[]): number {
  const centre = new Box3().setFromPoints(points).getCenter(new Vector3());
  return points.reduce((radius, point) => Math.max(radius, point.distanceTo(centre)), 1e-9);
}

/** Whether there is no graphics card: smooth edges would take four times as long. */
function drawnByProcessor(): boolean {
  const context = document.createElement("canvas").getContext("webgl2");
  const name = String(context?.getParameter(context.RENDERER));
  const detail = context?.getExtension("WEBGL_debug_renderer_info");
  const more = detail ? String(context?.getParameter(detail.UNMASKED_RENDERER_WEBGL)) : "";
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name + more);
}
