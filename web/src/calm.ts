// What need not be shown at every frame. Numbers that change sixty times a second cannot be read, and painting a table of
// them takes longer than the mechanism.

/** Milliseconds between two times. */
const PAUSE = 120;

export class Calm {
  private waiting = 0;
  private last = 0;

  constructor(private readonly action: () => void) {}

  /** Does it now, or after a pause since the last time. */
  ask(): void {
    if (this.waiting) return;
    const rest = this.last + PAUSE - performance.now();
    if (rest <= 0) this.run();
    else this.waiting = window.setTimeout(() => this.run(), rest);
  }

  /** Does it now, if it was asked for and is still waiting. */
  flush(): void {
    if (this.waiting) this.run();
  }

  private run(): void {
    clearTimeout(this.waiting);
    this.waiting = 0;
    this.last = performance.now();
    this.action();
  }
}
