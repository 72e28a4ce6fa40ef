// The materials of the parts, which an entry of the legend can make dim.

import { Color, DoubleSide, LineDashedMaterial, MeshBasicMaterial, ShaderMaterial, type Side } from "three";
import { COLOURS, PARTS, type PartName } from "./colours";

/** How dim the other parts are while one is pointed at. */
const DIM = 0.12;

// Light from all around and from a sun beside the camera, by Lambert's law. It is computed at the corners, and not at each
// pixel: where the processor draws, that takes a third of the time. Colours are made sRGB there, too.
const VERTEX = `
uniform vec3 colour;
varying vec3 lit;
void main() {
  vec4 place = vec4(position, 1.0);
  vec3 across = normal;
  #ifdef USE_INSTANCING
    mat3 shape = mat3(instanceMatrix);
    across = shape * (normal / vec3(dot(shape[0], shape[0]), dot(shape[1], shape[1]), dot(shape[2], shape[2])));
    place = instanceMatrix * place;
  #endif
  gl_Position = projectionMatrix * (modelViewMatrix * place);
  float facing = dot(normalize(normalMatrix * across), vec3(0.325, -0.487, 0.811));
  #ifdef TWO_SIDED
    facing = abs(facing);
  #endif
  lit = pow(colour * (0.446 + 0.637 * max(facing, 0.0)), vec3(1.0 / 2.2));
}`;
const FRAGMENT = `
uniform float opacity;
varying vec3 lit;
void main() { gl_FragColor = vec4(lit * opacity, opacity); }`;

/** A material of one colour in the light. */
export function lit(colour: string, sides?: Side): ShaderMaterial {
  return new ShaderMaterial({
    uniforms: { colour: { value: new Color(colour) }, opacity: { value: 1 } },
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    premultipliedAlpha: true,
    ...(sides === undefined ? {} : { side: sides, defines: { TWO_SIDED: "" } }),
  });
}

export class Materials {
  readonly dashes = new LineDashedMaterial({ color: COLOURS.motions, dashSize: 0.035, gapSize: 0.018 });
  private readonly all = new Map<PartName, ShaderMaterial | MeshBasicMaterial>();

  constructor() {
    for (const part of PARTS) {
      const flat = () => new MeshBasicMaterial({ color: COLOURS[part], side: DoubleSide, depthWrite: false });
      this.all.set(part, part === "motions" ? flat() : lit(COLOURS[part]));
    }
    this.highlight(null);
  }

  of(part: PartName): ShaderMaterial | MeshBasicMaterial {
    return this.all.get(part)!;
  }

  /** Makes all parts but one dim; nothing shows all of them. */
  highlight(part: PartName | null): void {
    for (const [name, material] of this.all) {
      const dim = part !== null && part !== name;
      const opacity = opaque(name) * (dim ? DIM : 1);
      if (material instanceof ShaderMaterial) material.uniforms["opacity"]!.value = opacity;
      material.opacity = opacity;
      material.transparent = opacity < 1;
    }
  }
}

function opaque(part: PartName): number {
  return part === "imaginary" ? 0.5 : part === "motions" ? 0.16 : 1;
}
