// A worker that follows the mechanism of the page: which file is open there, and with which changes.

import { Engine } from "./engine";
import type { Description } from "./types";

/** A mechanism file: the one that the page carries, or another one. */
export interface PageFile {
  name: string;
  text: string;
}

export class Follower {
  readonly engine: Engine;
  /** The text that is open there, and its changes. */
  text: string | null = null;
  changes = "";

  constructor(worker: string, library: ArrayBuffer) {
    this.engine = new Engine(worker, library);
  }

  /** Opens a mechanism there, or changes the one that is open; nothing if it is there already. */
  async agree({ name, text }: PageFile, asked: Record<string, number[]>): Promise<Description | null> {
    const changes = JSON.stringify(asked);
    if (this.text === text && this.changes === changes) return null;
    if (this.text !== text) {
      const { value } = await this.engine.ask<Description>({ do: "open", name, text, changes: asked });
      [this.text, this.changes] = [text, changes];
      return value;
    }
    // Even if it is refused: the same would be refused again.
    this.changes = changes;
    return (await this.engine.ask<Description>({ do: "change", changes: asked })).value;
  }
}

/** Runs a step until there is nothing left to do; to be started in the meantime is one more round. */
export class Loop {
  running = false;
  /** Whether there is one more round to come. */
  again = false;

  constructor(
    private readonly step: () => Promise<void>,
    private readonly failed: (error: unknown) => void,
    private readonly done: () => void,
  ) {}

  async start(): Promise<void> {
    this.again = true;
    if (this.running) return;
    this.running = true;
    while (this.again) {
      this.again = false;
      try {
        await this.step();
      } catch (error) {
        this.failed(error);
      }
    }
    this.running = false;
    this.done();
  }
}
