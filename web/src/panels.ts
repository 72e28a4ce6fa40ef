// The panels beside the view: fields for what is asked for, and what has been computed.

import { Assemblies } from "./assemblies";
import { unbounded } from "./beyond";
import { BodyPanel } from "./body";
import { Calm } from "./calm";
import { ContactPanel } from "./contacts";
import { DimensionPanel } from "./dimensions";
import { byId, element } from "./dom";
import { JointTable } from "./joints";
import { KindPanel } from "./kinds";
import { Player } from "./play";
import { PosePanel } from "./pose";
import { SlicePanel } from "./slice";
import type { State } from "./state";
import { showModes, showStatus } from "./status";
import type { Assembly, Counted, Description, Fitted, Kind, KindCount, Posture, ShippedMotion } from "./types";

type Pose = Record<string, number>;

export interface PanelEvents {
  /** A part of the state is to be another one. */
  set(patch: Partial<State>, final: boolean): void;
  /** Some coordinates of the pose are. */
  move(values: Pose, final: boolean): void;
  /** A dimension is. */
  change(name: string, values: number[], final: boolean): void;
  /** An actuated joint is to have a value. */
  drive(name: string, value: number, final: boolean): void;
  /** A joint is pointed at in the table; nothing where none is. */
  pointed(joint: string | null): void;
  /** The platform is to be in an assembly. */
  assemble(assembly: Assembly, final: boolean): void;
  /** A motion places the platform. */
  follow(pose: Pose, mode: string, final: boolean): void;
  /** A field has something that it cannot have, with the reason; nothing where that is right again. */
  refused(why: string | null): void;
  /** A link names a motion that is not there. */
  unknownMotion(name: string): void;
  /** Every coordinate of the pose. */
  pose(): Pose;
}

export class Panels {
  readonly joints: JointTable;
  readonly slice: SlicePanel;
  readonly body: BodyPanel;
  readonly kinds: KindPanel;
  readonly player: Player;
  readonly assemblies: Assemblies;
  private readonly pose: PosePanel;
  private readonly dimensions: DimensionPanel;
  private readonly contacts: ContactPanel;
  private readonly table = new Calm(() => this.joints.update(this.posture, this.counted));
  /** The posture that is shown. */
  private posture: Posture | null = null;
  private counted: Counted | null = null;

  constructor(events: PanelEvents) {
    this.pose = new PosePanel({ moved: (name, value, final) => events.move({ [name]: value }, final) });
    this.joints = new JointTable({ driven: events.drive, pointed: events.pointed });
    this.contacts = new ContactPanel((clearance) => events.set({ clearance }, true));
    this.dimensions = new DimensionPanel({ changed: events.change });
    this.slice = new SlicePanel({ sliced: (slice, final) => events.set({ slice }, final), placed: events.move, refused: events.refused });
    this.body = new BodyPanel((body) => events.set({ body }, true));
    this.kinds = new KindPanel((kind) => events.set({ kind }, true));
    this.player = new Player({
      chosen: (motion) => events.set({ motion }, true), placed: events.follow, unknown: events.unknownMotion, pose: events.pose,
    });
    this.assemblies = new Assemblies(events.assemble);
  }

  /** Makes the fields of a mechanism. */
  build(description: Description, kinds: Kind[], motions: ShippedMotion[], motion: State["motion"]): void {
    this.posture = null;
    this.assemblies.set([], false);
    for (const panel of [this.pose, this.dimensions, this.slice, this.body, this.contacts]) panel.build(description);
    this.contacts.setContacts(null);
    this.kinds.build(kinds, description.angle);
    this.player.build(description, motions, motion);
    byId("mode").replaceChildren(...description.modes.map((mode) => element("option", { value: mode }, mode || "the only one")));
  }

  /** Makes the table of joints, whose limits are dimensions. */
  buildJoints(description: Description): void {
    this.joints.build(description);
    this.joints.update(this.posture, this.counted);
  }

  /** Shows the state. */
  update(state: State, description: Description, axes: Parameters<SlicePanel["update"]>[1], pose: Pose): void {
    const { changes, slice, body, kind, mode, motion, clearance } = state;
    this.pose.update(description, pose);
    this.dimensions.update(description, changes);
    this.slice.update(slice, axes, pose);
    this.body.update(body);
    this.contacts.update(clearance);
    this.kinds.update(kind);
    this.player.update(motion);
    if (!this.kinds.wanted) this.slice.setKind(null);
    byId<HTMLSelectElement>("mode").value = mode ?? description.home_mode;
  }

  /** Shows a posture, and where it is out of reach what is missing; the last one that was reached stays then. */
  setPosture(posture: Posture, description: Description): void {
    if (posture.reached) {
      this.posture = posture;
      this.contacts.setContacts(posture.contacts);
    }
    showStatus(posture, description);
    showModes(posture);
    this.table.ask();
  }

  /** Takes a grid: the first one for a mechanism file, or another one; nothing while the first one is not there. */
  setFitted(fitted: Fitted | null, first: boolean): void {
    if (fitted) this.pose.setRanges(fitted.axes);
    else this.slice.setWhole(this.counted = null);
    // Sinusoids that somebody has typed stay.
    if (fitted && first) this.player.setRanges(fitted.axes);
    this.slice.setBeyond(unbounded(fitted));
  }

  setCounted(counted: Counted | null): void {
    this.counted = counted;
    this.slice.setWhole(counted);
    this.table.ask();
  }

  setKind(count: KindCount | null): void {
    this.kinds.setCount(count);
    this.slice.setKind(count);
  }

  /** Says that no pose of the platform has the value of a joint, which is put back. */
  refuseJoint(name: string, why: string | null): void {
    this.joints.restore(name, this.posture);
    if (why === null) return;
    byId("status").classList.add("wrong");
    byId("status").textContent = why;
  }

  /** Draws what has colours of its own. */
  draw(): void {
    this.slice.draw();
    this.player.draw();
  }

  /** Shows all that waits. */
  flush(): void {
    this.table.flush();
  }
}
