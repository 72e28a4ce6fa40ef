// The line below the mechanism, and the notes of the working modes: what is reached.

import { sentence } from "./contacts";
import { byId, short } from "./dom";
import type { Description, Posture } from "./types";

/** Says whether a posture is reached: if not, which leg misses it, and by how much. */
export function showStatus(posture: Posture, { joints, modes }: Description): void {
  const status = byId("status");
  const { contacts } = posture;
  status.classList.toggle("wrong", !posture.within || (contacts?.overlap ?? false));
  const beyond = posture.beyond.map((number) => {
    const { name, limits, unit } = joints[number]!;
    const value = posture.values[number]!;
    const excess = limits ? Math.max(limits[0] - value, value - limits[1]) : 0;
    return `${name} by ${short(excess)} ${unit}`;
  });
  const within = posture.modes.filter((mode) => mode.within).length;
  const several = posture.modes.length > 1 ? ` ${within} of ${modes.length} working modes reach this pose within limits.` : "";
  const text = !posture.reached
    ? `Out of reach: ${posture.out_of_reach.map(({ leg, text }) => `${leg}, ${text}`).join("; ")}. The last pose in reach is shown.`
    : beyond.length ? `Beyond limits: ${beyond.join(", ")}.` : `In reach, within all limits.${several}`;
  const overlap = contacts?.overlap ? ` ${sentence(contacts.nearest)}` : "";
  if (status.textContent !== text + overlap) status.textContent = text + overlap;
}

/** Notes at each working mode whether it reaches the pose. */
export function showModes(posture: Posture): void {
  const reaching = new Map(posture.modes.map(({ mode, within }) => [mode, within]));
  for (const option of byId<HTMLSelectElement>("mode").options) {
    const within = reaching.get(option.value);
    const note = within === undefined ? "" : within ? " · in reach" : " · beyond limits";
    const text = (option.value || "the only one") + note;
    if (option.textContent !== text) option.textContent = text;
  }
}
