// The stage: the mechanism in space, the handles of its platform, and the workspace as a body.

import type { Vector3 } from "three";
import { BodyMesh, type BodyPanel } from "./body";
import { byId } from "./dom";
import { HandleSet, type HandleEvents } from "./handles";
import { connectView } from "./toolbar";
import type { Description, Posture, WorkspaceBody } from "./types";
import { View } from "./view";

type Pose = Record<string, number>;

export interface StageEvents extends HandleEvents {
  /** A joint is pointed at in the view; nothing where none is. */
  pointed(joint: string | null): void;
}

export class Stage {
  private readonly view = new View(byId("view"));
  private readonly handles: HandleSet;
  private readonly body = new BodyMesh();
  private description: Description | null = null;
  /** The posture that is shown. */
  private posture: Posture | null = null;

  constructor(private readonly events: StageEvents) {
    this.handles = new HandleSet(this.view, byId("view"), events);
    this.view.scene.add(this.body.mesh);
  }

  connect(): void {
    connectView({
      fit: () => this.view.fit(this.others()),
      orbit: (across, upwards, nearer) => this.view.orbit(across, upwards, nearer),
      highlight: (part) => this.view.highlight(part),
    });
    byId("view").addEventListener("pointermove", (event) => {
      if (!event.buttons) this.point(this.view.under(event));
    });
    byId("view").addEventListener("pointerleave", () => this.point(null));
    byId("names").addEventListener("change", () => this.view.draw());
    const shown = byId<HTMLInputElement>("handles");
    shown.addEventListener("change", () => {
      this.handles.group.visible = shown.checked;
      this.view.draw();
    });
  }

  /** Marks a joint in the view and in the table. */
  point(joint: string | null): void {
    this.view.point(joint);
    this.events.pointed(joint);
  }

  /** Shows a mechanism: another one, or the same one with other dimensions. */
  setMechanism(description: Description, another: boolean): void {
    this.description = description;
    this.view.setMechanism(description);
    if (another) {
      this.posture = null;
      this.body.clear();
      this.view.measure();
      this.view.first([]);
    }
  }

  /** Shows a posture that is reached: `bytes` are the places of the bodies. */
  setPosture(posture: Posture, bytes: Uint8Array<ArrayBuffer>): void {
    const { view, description } = this;
    const first = this.posture === null;
    this.posture = posture;
    view.place(bytes);
    view.setNear(posture.contacts?.near ?? []);
    if (first) view.measure();
    if (description && posture.handles) this.handles.set(description.coordinates, posture.handles, view.size);
    if (first) view.first(this.others());
  }

  /** The ends of what is shown beside the mechanism: handles and body. */
  private others(): Vector3[] {
    return [...(this.posture?.handles ? this.handles.ends() : []), ...this.body.ends()];
  }

  /** Takes the surface of a body; nothing where it was refused. */
  setBody(body: WorkspaceBody | null, bytes: Uint8Array<ArrayBuffer>): void {
    if (body) this.body.set(body, bytes);
    else this.body.clear();
  }

  /** Draws all of the body while nothing moves, and else its near side. */
  still(still: boolean): void {
    this.body.still(still);
    this.view.still(still);
  }

  /** Puts the body beside the mechanism, if it is wanted and known: `pose` is that of the posture. */
  placeBody(panel: BodyPanel, known: boolean, pose: Pose): void {
    const { view, body, description, posture } = this;
    const handles = panel.wanted && known && description ? posture?.handles : null;
    const before = body.mesh.visible;
    body.mesh.visible = Boolean(handles) && body.known;
    if (handles && description) {
      panel.setNote(body.place(panel.chosen(), description, pose, handles, view.size));
      // One that is larger than the mechanism would be seen from inside.
      if (body.mesh.visible && !before) view.takeIn(this.others());
    }
    view.draw();
  }

  picture(): HTMLCanvasElement {
    return this.view.picture();
  }
}
