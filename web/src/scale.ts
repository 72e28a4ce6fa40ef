// Scales: the colours of a slice, and round numbers beside them.

import { element } from "./dom";

/** The numbers that colour a slice but for joints, by the names that opm gives them. */
export const NUMBERS = { condition: "1 / condition number", lti: "local transmission index", clearance: "clearance of bodies" };

/** The scale of colours as a column of pixels, the highest on top. */
export function scaleColumn(): HTMLCanvasElement {
  const column = element("canvas", { width: 1, height: 128 });
  const context = column.getContext("2d")!;
  for (let i = 0; i < 128; i++) {
    context.fillStyle = `rgb(${cividis(1 - i / 127).join()})`;
    context.fillRect(0, i, 1, 1);
  }
  return column;
}

/** Red, green and blue as the pixel of a canvas. */
export function pixel([red = 0, green = 0, blue = 0]: number[]): number {
  return ((255 << 24) | (blue << 16) | (green << 8) | red) >>> 0;
}

/** Round numbers between two ends, about five of them. */
export function nice(low: number, high: number): number[] {
  if (!(high > low)) return [low];
  const rough = (high - low) / 5;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5, 10].find((times) => times * power >= rough) ?? 10);
  const ticks: number[] = [];
  for (let i = Math.ceil(low / step); i * step <= high * (1 + 1e-9) + 1e-12; i++) ticks.push(Number((i * step).toPrecision(10)));
  return ticks;
}

/** Colours from dark to bright that everybody tells apart: points of the scale cividis (Nunez, Anderton, Renslow 2018). */
const SCALE = [[0, 32, 77], [60, 77, 110], [124, 123, 120], [187, 173, 108], [255, 234, 70]];

export function cividis(share: number): number[] {
  const place = Math.min(1, Math.max(0, share)) * (SCALE.length - 1);
  const low = Math.min(SCALE.length - 2, Math.floor(place));
  return SCALE[low]!.map((value, i) => Math.round(value + (SCALE[low + 1]![i]! - value) * (place - low)));
}

