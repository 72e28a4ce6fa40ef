// The changes of the mechanism that can be undone and done again.

type Changes = Record<string, number[]>;

export class Undo {
  private done: Changes[] = [];
  private undone: Changes[] = [];
  /** The changes at the last step. */
  settled: Changes = {};

  /** Starts anew with these changes. */
  reset(changes: Changes): void {
    [this.done, this.undone, this.settled] = [[], [], changes];
  }

  /** Takes changes as one more step. */
  step(changes: Changes): void {
    if (JSON.stringify(changes) === JSON.stringify(this.settled)) return;
    this.done.push(this.settled);
    this.undone = [];
    this.settled = changes;
  }

  get canUndo(): boolean {
    return this.done.length > 0;
  }

  get canRedo(): boolean {
    return this.undone.length > 0;
  }

  /** The changes before the last step, or those after it, if there are any. */
  go(back: boolean): Changes | undefined {
    const [from, to] = back ? [this.done, this.undone] : [this.undone, this.done];
    const changes = from.pop();
    if (!changes) return undefined;
    to.push(this.settled);
    this.settled = changes;
    return changes;
  }
}
