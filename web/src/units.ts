// The units of files.

const FACTORS: Record<string, number> = { m: 1, cm: 0.01, mm: 0.001, in: 0.0254, rad: 1, deg: Math.PI / 180 };

/** The SI value of one unit. */
export function factor(unit: string): number {
  return FACTORS[unit] ?? 1;
}
