// The parts of a mechanism that the legend lists, and their colours.

/** The parts that have a colour, as the legend lists them. */
export const PARTS = ["base", "lower", "upper", "platform", "actuated", "passive", "imaginary", "motions", "obstacle", "interfering"] as const;
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
  obstacle: "Obstacles",
  interfering: "Bodies too near to each other",
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
  obstacle: "#997a4d",
  interfering: "#e01010",
};
