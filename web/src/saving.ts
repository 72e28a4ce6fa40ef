// What the page saves.

import { save } from "./dom";
import type { Engine } from "./engine";
import type { SlicePanel } from "./slice";
import type { Stage } from "./stage";
import { poseTable, sliceTable } from "./tables";
import type { Description, Posture } from "./types";

/** What there is to save. */
export interface Shown {
  description: Description;
  engine: Engine;
  slice: SlicePanel;
  stage: Stage;
  /** The posture that is shown, and its pose: one out of reach has no joints. */
  posture: Posture | null;
  reached: Record<string, number>;
}

/** Saves what an entry of the menu stands for. */
export async function saveEntry(entry: string, { description, engine, slice, stage, posture, reached }: Shown): Promise<void> {
  const { name } = description;
  if (entry === "mechanism") {
    save(`${name}.toml`, (await engine.ask<string>({ do: "file" })).value, "application/toml");
  } else if (entry === "slice-csv" && slice.shown) {
    save(`${name}-slice.csv`, sliceTable(description, slice.shown), "text/csv");
  } else if (entry === "slice-svg") save(`${name}-slice.svg`, slice.svg(), "image/svg+xml");
  else if (entry === "picture") {
    const picture = await new Promise<Blob | null>((resolve) => stage.picture().toBlob(resolve));
    if (picture) save(`${name}.png`, picture, "image/png");
  } else if (entry === "pose" && posture) {
    save(`${name}-pose.csv`, poseTable(description, reached, posture), "text/csv");
  }
}
