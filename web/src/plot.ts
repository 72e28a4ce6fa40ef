// A joint over time, with its limits, a cursor, and where the mechanism cannot follow.

import { short } from "./dom";
import { nice } from "./scale";

export interface Curve {
  label: string;
  times: Float32Array;
  values: Float32Array;
  limits: [number, number] | null;
  /** Times at which something is violated. */
  wrong: { start: number; end: number }[];
}

const MARGIN = { left: 46, right: 6, top: 20, bottom: 20 };

/** Draws a curve on a canvas, and a cursor at a time. */
export function plot(canvas: HTMLCanvasElement, curve: Curve | null, time: number): void {
  const { clientWidth, clientHeight } = canvas;
  const context = canvas.getContext("2d");
  if (!context || !clientWidth) return;
  const ratio = Math.min(devicePixelRatio, 2);
  const [wide, high] = [Math.round(clientWidth * ratio), Math.round(clientHeight * ratio)];
  if (canvas.width !== wide) canvas.width = wide;
  if (canvas.height !== high) canvas.height = high;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  const theme = getComputedStyle(document.documentElement);
  const ink = (name: string) => theme.getPropertyValue(`--${name}`).trim();
  context.fillStyle = ink("ground");
  context.fillRect(0, 0, clientWidth, clientHeight);
  if (!curve || curve.times.length < 2) return;
  const { times, values, limits, wrong, label } = curve;
  const [first, last] = [times[0]!, times[times.length - 1]!];
  let [low, high2] = [Infinity, -Infinity];
  for (const value of values) if (!Number.isNaN(value)) [low, high2] = [Math.min(low, value), Math.max(high2, value)];
  // Limits are a part of the picture where they are near.
  const span = Math.max(high2 - low, 1e-9);
  for (const limit of limits ?? []) if (limit > low - span && limit < high2 + span) [low, high2] = [Math.min(low, limit), Math.max(high2, limit)];
  if (!(high2 >= low)) return;
  const pad = 0.06 * Math.max(high2 - low, 1e-9);
  [low, high2] = [low - pad, high2 + pad];
  const { left, right, top, bottom } = MARGIN;
  const [width, height] = [clientWidth - left - right, clientHeight - top - bottom];
  const across = (t: number) => left + ((t - first) / (last - first)) * width;
  const upwards = (value: number) => top + height - ((value - low) / (high2 - low)) * height;
  context.fillStyle = ink("wrong-ground");
  for (const { start, end } of wrong) context.fillRect(across(start) - 1, top, Math.max(2, across(end) - across(start)), height);
  context.strokeStyle = ink("wrong");
  context.setLineDash([4, 3]);
  for (const limit of limits ?? []) {
    if (limit < low || limit > high2) continue;
    context.beginPath();
    context.moveTo(left, upwards(limit));
    context.lineTo(left + width, upwards(limit));
    context.stroke();
  }
  context.setLineDash([]);
  context.strokeStyle = ink("edge");
  context.lineWidth = 1.5;
  context.beginPath();
  let pen = false;
  for (let i = 0; i < times.length; i++) {
    const value = values[i]!;
    if (!Number.isNaN(value)) context[pen ? "lineTo" : "moveTo"](across(times[i]!), upwards(value));
    pen = !Number.isNaN(value);
  }
  context.stroke();
  context.strokeStyle = ink("mark");
  context.beginPath();
  context.moveTo(across(time), top);
  context.lineTo(across(time), top + height);
  context.stroke();
  context.strokeStyle = ink("line");
  context.strokeRect(left + 0.5, top + 0.5, width - 1, height - 1);
  context.fillStyle = ink("quiet");
  context.font = "11px system-ui, sans-serif";
  context.textAlign = "right";
  for (const value of nice(low, high2)) context.fillText(short(value), left - 4, upwards(value) + 4);
  context.textAlign = "center";
  for (const t of nice(first, last)) context.fillText(`${short(t)}`, across(t), top + height + 14);
  context.textAlign = "left";
  context.fillText(`${label} over seconds`, left, 13);
}

/** The time at a place of the plot. */
export function timeAt(canvas: HTMLCanvasElement, curve: Curve, clientX: number): number {
  const box = canvas.getBoundingClientRect();
  const share = (clientX - box.left - MARGIN.left) / Math.max(1, box.width - MARGIN.left - MARGIN.right);
  const [first, last] = [curve.times[0]!, curve.times[curve.times.length - 1]!];
  return first + Math.min(1, Math.max(0, share)) * (last - first);
}
