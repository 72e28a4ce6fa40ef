// The address of the page, in which the state lives.

import { toAddress } from "./link";
import type { State } from "./state";

export class Address {
  private current = "";

  /** `changed` takes what the browser has gone back or forward to. */
  constructor(private readonly changed: (hash: string) => Promise<void>) {}

  /** Listens to the browser. */
  connect(): void {
    for (const event of ["popstate", "hashchange"]) window.addEventListener(event, () => void this.recall());
  }

  /** Puts the state into the address, as a new step or in place of the last one. */
  async remember(state: State, instead = false): Promise<void> {
    // In a frame of a notebook, the page has no address of its own.
    if (location.protocol === "about:") return;
    const address = await toAddress(state);
    if (address === this.current) return;
    this.current = address;
    if (instead) history.replaceState(null, "", `#${address}`);
    else history.pushState(null, "", `#${address}`);
  }

  private async recall(): Promise<void> {
    const hash = location.hash.replace(/^#/, "");
    if (hash === this.current) return;
    this.current = hash;
    await this.changed(hash);
  }
}
