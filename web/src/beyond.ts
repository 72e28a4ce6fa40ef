// A workspace that no grid holds.

import type { Fitted } from "./types";

/** The coordinates along which a workspace goes beyond the grid that was fitted. */
export function unbounded(fitted: Fitted | null): string[] {
  return fitted?.axes.filter((axis) => axis.unbounded).map(({ name }) => name) ?? [];
}

/** Says so of a number that is counted on the grid; nothing where the grid holds all. */
export function beyond(names: string[]): string {
  const list = [names.slice(0, -1).join(", "), ...names.slice(-1)].filter(Boolean).join(" and ");
  return list && `The workspace continues beyond this grid along ${list}: this is a part of it. Limit a joint to measure all.`;
}
