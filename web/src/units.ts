// Angles in the units of files.

const HALF_TURNS: Record<string, number> = { deg: 180, rad: Math.PI, mrad: 1e3 * Math.PI, urad: 1e6 * Math.PI };

/** Half a turn in a unit; nothing for a unit that is none of angles. */
export function halfTurn(unit: string): number | undefined {
  return HALF_TURNS[unit];
}
