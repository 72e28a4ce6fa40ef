// The mechanism in space: its bodies, the motions of its sections, and what the pointer does.

import {
  AmbientLight, BoxGeometry, BufferGeometry, CircleGeometry, Color, CylinderGeometry, DirectionalLight, DoubleSide,
  Group, Line, LineDashedMaterial, Mesh, MeshBasicMaterial, MeshLambertMaterial, Object3D, PerspectiveCamera,
  Scene, SphereGeometry, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { Body, Description, Solid, Subspace, Vector } from "./types";

/** The parts that have a colour, as the legend lists them. */
export const PARTS = ["base", "lower", "upper", "platform", "actuated", "passive", "imaginary", "motions"] as const;
export type PartName = (typeof PARTS)[number];

export const PART_NAMES: Record<PartName, string> = {
  base: "Base",
  lower: "Links of the lower section",
  upper: "Links of the upper section",
  platform: "Platform",
  actuated: "Actuated joints",
  passive: "Passive joints",
  imaginary: "Imaginary joints",
  motions: "Motions of the sections",
};

/** Colours that people with colour blindness tell apart, by Okabe and Ito, and greys. */
export const COLOURS: Record<PartName, string> = {
  base: "#70727a",
  lower: "#b9bec6",
  upper: "#c9b98f",
  platform: "#0072b2",
  actuated: "#d55e00",
  passive: "#56b4e9",
  imaginary: "#cc79a7",
  motions: "#009e73",
};

const round = new CylinderGeometry(1, 1, 1, 24);
const ball = new SphereGeometry(1, 24, 16);
const block = new BoxGeometry(2, 1, 2);
const disc = new CircleGeometry(1, 64);
const dashed = new BufferGeometry().setFromPoints([new Vector3(0, -0.5, 0), new Vector3(0, 0.5, 0)]);
const UP = new Vector3(0, 1, 0);

/** How dim the other parts are while one is pointed at. */
const DIM = 0.12;

export class View {
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(35, 1, 0.01, 1000);
  private readonly renderer: WebGLRenderer;
  private readonly controls: OrbitControls;
  private readonly materials = new Map<PartName, MeshLambertMaterial | MeshBasicMaterial>();
  private readonly dashes = new LineDashedMaterial({ color: COLOURS.motions, dashSize: 0.035, gapSize: 0.018 });
  private bodies: Group[] = [];
  private readonly mechanism = new Group();
  private size = 1;
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
    this.scene.add(this.camera, new AmbientLight("#ffffff", 1.4), this.mechanism);
    for (const part of PARTS) {
      const color = new Color(COLOURS[part]);
      const seeThrough = part === "imaginary" || part === "motions";
      const material = part === "motions"
        ? new MeshBasicMaterial({ color, side: DoubleSide, depthWrite: false })
        : new MeshLambertMaterial({ color });
      material.transparent = seeThrough;
      material.opacity = opacity(part);
      this.materials.set(part, material);
    }
    new ResizeObserver(() => this.resize()).observe(host);
    this.resize();
  }

  /** Shows the bodies of a mechanism; `place` puts them where they are. */
  setMechanism(description: Description): void {
    this.mechanism.clear();
    this.bodies = description.bodies.map((body) => {
      const group = new Group();
      group.matrixAutoUpdate = false;
      group.matrix.setPosition(new Vector3(...body.origin));
      for (const solid of body.solids) group.add(this.solid(solid, body));
      this.mechanism.add(group);
      return group;
    });
    this.addMotions(description);
    this.draw();
  }

  /** Moves the bodies: 16 numbers of a matrix for each, column by column. */
  place(bytes: Uint8Array<ArrayBuffer>): void {
    const numbers = new Float32Array(bytes.buffer, bytes.byteOffset, bytes.byteLength / 4);
    this.bodies.forEach((group, number) => {
      group.matrix.fromArray(numbers, 16 * number);
      group.matrixWorldNeedsUpdate = true;
    });
    this.draw();
  }

  /** Looks at the whole mechanism, from the direction of the camera or from the first one. */
  fit(again = true): void {
    const points: Vector3[] = [];
    this.bodies.forEach((group) => {
      group.updateMatrixWorld(true);
      group.children.forEach((solid) => {
        if (solid.userData["measured"]) {
          for (const end of [-0.5, 0.5]) points.push(new Vector3(0, end, 0).applyMatrix4(solid.matrixWorld));
        }
      });
    });
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
    for (const [name, material] of this.materials) {
      const dim = part !== null && part !== name;
      material.opacity = opacity(name) * (dim ? DIM : 1);
      material.transparent = dim || name === "imaginary" || name === "motions";
      material.needsUpdate = true;
    }
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

  private material(part: PartName): MeshLambertMaterial | MeshBasicMaterial {
    return this.materials.get(part)!;
  }

  private solid(solid: Solid, body: Body): Mesh {
    const part: PartName = solid.material === "link" ? (body.section ?? "lower") : solid.material;
    const [from, to] = [new Vector3(...solid.from), new Vector3(...solid.to)];
    const axis = to.clone().sub(from);
    const length = axis.length();
    const geometry = { cylinder: round, ball, block }[solid.shape];
    const mesh = new Mesh(geometry, this.material(part));
    mesh.position.copy(from).lerp(to, 0.5);
    if (length > 0) mesh.quaternion.setFromUnitVectors(UP, axis.divideScalar(length));
    mesh.scale.set(solid.radius, solid.shape === "ball" ? solid.radius : length, solid.radius);
    mesh.userData["measured"] = part !== "imaginary";
    return mesh;
  }

  /** Draws the motions of the sections: that of the lower one on the base, the others on the body that it moves. */
  private addMotions({ bodies, lower, upper, intersection }: Description): void {
    const number = bodies.findIndex((body) => body.name === "lower_platform");
    const carrier = number < 0 ? this.mechanism : this.bodies[number]!;
    const origin = number < 0 ? new Vector3() : new Vector3(...bodies[number]!.origin);
    const size = this.measure(bodies);
    const platform = bodies.find((body) => body.name === "platform")?.origin ?? [0, 0, 0];
    const draw = (on: Group, space: Subspace, at: Vector3, size: number) => {
      for (const object of this.motion(space, at, size)) on.add(object);
    };
    if (lower.dimension > 1) draw(this.mechanism, lower, new Vector3(...platform), size);
    const at = new Vector3(...platform).sub(origin);
    if (upper.dimension > 1) draw(carrier, shifted(upper, origin), at, 0.8 * size);
    if (intersection.direction) draw(carrier, shifted(intersection, origin), at, 1.2 * size);
  }

  private measure(bodies: Body[]): number {
    const origins = bodies.filter((body) => body.solids.length).map((body) => new Vector3(...body.origin));
    const widest = Math.max(...origins.map((origin) => origin.distanceTo(origins[0] ?? origin)), 0);
    return widest > 0 ? 0.5 * widest : 0.1;
  }

  /** A disc for a plane, a ball for a centre, a dashed line for an axis. */
  private motion(space: Subspace, platform: Vector3, size: number): Object3D[] {
    const made: Object3D[] = [];
    const at = space.point ? new Vector3(...space.point) : platform;
    if (space.name === "spherical") {
      const centre = new Mesh(ball, this.material("motions"));
      centre.scale.setScalar(0.08 * size);
      centre.position.copy(at);
      made.push(centre);
    } else if (space.direction && /plan|schoenflies/.test(space.name)) {
      const plane = new Mesh(disc, this.material("motions"));
      plane.scale.setScalar(0.6 * size);
      plane.position.copy(at);
      plane.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(...space.direction));
      made.push(plane);
    } else if (space.direction) {
      const line = new Line(dashed, this.dashes);
      line.computeLineDistances();
      line.scale.setScalar(1.2 * size);
      line.position.copy(at);
      line.quaternion.setFromUnitVectors(UP, new Vector3(...space.direction));
      made.push(line);
    }
    return made;
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

function opacity(part: PartName): number {
  return part === "imaginary" ? 0.5 : part === "motions" ? 0.16 : 1;
}

function shifted(space: Subspace, origin: Vector3): Subspace {
  const point = space.point ? (new Vector3(...space.point).sub(origin).toArray() as Vector) : null;
  return { ...space, point };
}

