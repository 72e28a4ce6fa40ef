// Tables that the page saves, with columns `NAME [unit]` as opm reads them.

import type { Shown } from "./slice";
import type { AxisRequest, Description, Posture } from "./types";

type Pose = Record<string, number>;

const heading = (name: string, unit: string) => (unit ? `${name} [${unit}]` : name);
const text = (rows: (string | number)[][]) => `${rows.map((row) => row.join(",")).join("\n")}\n`;

/** A posture as one row: the coordinates, those that follow, the joints and the working mode. */
export function poseTable({ coordinates, dependent, joints }: Description, pose: Pose, posture: Posture): string {
  const head = [...coordinates, ...dependent, ...joints].map(({ name, unit }) => heading(name, unit));
  const row = [...coordinates.map(({ name, home }) => pose[name] ?? home), ...posture.dependent, ...posture.values];
  return text([[...head, "mode"], [...row, posture.mode]]);
}

/** A row for each reachable pose of a slice, with all its coordinates and the number that colours it. */
export function sliceTable({ coordinates }: Description, { x, y, pose, mask, colours }: Shown): string {
  const colour = colours ? [heading(colours.by === "condition" ? "inverse_condition" : colours.by, colours.range.unit)] : [];
  const rows: (string | number)[][] = [[...coordinates.map(({ name, unit }) => heading(name, unit)), ...colour]];
  mask.forEach((inside, number) => {
    if (!inside) return;
    const at: Pose = { ...pose, [x.name]: valueOf(x, number % x.count), [y.name]: valueOf(y, Math.floor(number / x.count)) };
    rows.push([...coordinates.map(({ name, home }) => at[name] ?? home), ...(colours ? [colours.numbers[number]!] : [])]);
  });
  return text(rows);
}

function valueOf(axis: AxisRequest, number: number): number {
  if (axis.count === 1) return axis.min;
  return Number((axis.min + ((axis.max - axis.min) * number) / (axis.count - 1)).toPrecision(12));
}
