// Forward kinematics: an actuated joint is moved, and the platform goes to the nearest pose that has its value.

import type { Engine } from "./engine";
import { known } from "./sweeper";
import type { Assembly, Description, Posture } from "./types";

export interface DriverEvents {
  /** From where a joint is moved; nothing where no posture is shown. */
  from(): Start | null;
  /** The assemblies for the joints, the nearest one first; none where there is no such pose. */
  found(assemblies: Assembly[], wanted: Wanted): void;
  failed(error: unknown, wanted: Wanted): void;
  /** Something was asked for, or has been answered. */
  changed(): void;
}

interface Start {
  description: Description;
  posture: Posture;
  pose: Record<string, number>;
}

/** A value that a joint is to have; it is final unless a slider is still held. */
export interface Wanted {
  name: string;
  value: number;
  final: boolean;
}

export class Driver {
  /** Whether a joint is being driven. */
  running = false;
  /** What is wanted next: what was wanted before it is not asked for any more. */
  private next: Wanted | null = null;

  constructor(private readonly engine: Engine, private readonly events: DriverEvents) {}

  /** Moves an actuated joint, and the platform to the nearest pose that this allows. */
  async drive(wanted: Wanted): Promise<void> {
    this.next = wanted;
    if (this.running) return;
    this.running = true;
    this.events.changed();
    while (this.next) {
      const now: Wanted = this.next;
      this.next = null;
      const start = this.events.from();
      if (!start) continue;
      try {
        this.events.found(await this.ask(now, start), now);
      } catch (error) {
        this.events.failed(error, now);
      }
    }
    this.running = false;
    this.events.changed();
  }

  private async ask({ name, value }: Wanted, { description, posture, pose }: Start): Promise<Assembly[]> {
    const all = description.joints.map((joint, number) => ({ joint, value: posture.values[number]! }));
    const joints = Object.fromEntries(all.filter(({ joint }) => joint.kind === "actuated").map(({ joint, value }) => [joint.name, value]));
    joints[name] = value;
    const request = { do: "forward", joints, pose: known(pose, description) };
    return (await this.engine.ask<{ assemblies: Assembly[] }>(request)).value.assemblies;
  }
}
