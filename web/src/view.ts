// The space that the mechanism is in: camera, light, and what the pointer does.

import { AmbientLight, DirectionalLight, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { PartName } from "./colours";
import { Materials } from "./materials";
import { Motions } from "./motions";
import { Solids } from "./solids";
import type { Description } from "./types";


export class View {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(35, 1, 0.01, 1000);
  readonly controls: OrbitControls;
  private readonly renderer: WebGLRenderer;
  private readonly materials = new Materials();
  private readonly solids = new Solids(this.materials);
  private readonly motions = new Motions(this.materials);
  /** The radius of the mechanism, metres. */
  size = 1;
  private readonly centre = new Vector3();
  private drawn = false;

  constructor(private readonly host: HTMLElement) {
    this.renderer = new WebGLRenderer({ antialias: !drawnByProcessor(), alpha: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    host.append(this.renderer.domElement);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener("change", () => this.draw());
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
    this.draw();
  }

  /** Moves the bodies: 16 numbers of a matrix for each, column by column. */
  place(bytes: Uint8Array<ArrayBuffer>): void {
    this.solids.place(new Float32Array(bytes.buffer, bytes.byteOffset, bytes.byteLength / 4));
    this.motions.place((number) => this.solids.body(number));
    this.draw();
  }

  /** Looks at the whole mechanism, from the direction of the camera or from the first one. */
  fit(again = true): void {
    const points = this.solids.ends();
    if (!points.length) return;
    const sum = points.reduce((sum, point) => sum.add(point), new Vector3());
    this.centre.copy(sum.divideScalar(points.length));
    this.size = Math.max(...points.map((point) => point.distanceTo(this.centre)), 1e-9);
    const from = again
      ? this.camera.position.clone().sub(this.controls.target).normalize()
      : new Vector3(0.55, -0.75, 0.5).normalize();
    const slim = Math.min(1, this.camera.aspect);
    const distance = (0.86 * this.size) / Math.sin((this.camera.fov * Math.PI) / 360) / slim;
    this.controls.target.copy(this.centre);
    this.camera.position.copy(this.centre).addScaledVector(from, distance);
    this.camera.near = distance / 100;
    this.camera.far = distance * 100;
    this.camera.updateProjectionMatrix();
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

  /** Makes all parts but one dim; nothing shows all of them. */
  highlight(part: PartName | null): void {
    this.materials.highlight(part);
    this.draw();
  }

  /** The picture, as a PNG. */
  picture(): Promise<Blob | null> {
    this.render();
    return new Promise((resolve) => this.renderer.domElement.toBlob(resolve));
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
    document.body.dataset["frameMs"] = (performance.now() - start).toFixed(2);
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.host;
    if (!width || !height) return;
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.renderer.setSize(width, height);
    this.draw();
  }
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
