// How far the bodies of the mechanism are from each other and from obstacles.

import { byId, numberIn, show } from "./dom";
import type { Contacts, Description } from "./types";

export class ContactPanel {
  private readonly field = byId<HTMLInputElement>("clearance");

  constructor(changed: (clearance: number | null) => void) {
    this.field.addEventListener("change", () => changed(numberIn(this.field) ?? null));
  }

  build({ length }: Description): void {
    byId("clearance-unit").textContent = length;
  }

  update(clearance: number | null): void {
    show(this.field, clearance ?? undefined);
  }

  /** Says which two bodies are nearest; nothing before there is a pose. */
  setContacts(contacts: Contacts | null): void {
    const nearest = byId("nearest");
    nearest.textContent = contacts ? sentence(contacts.nearest) : "";
    nearest.classList.toggle("wrong", contacts?.overlap ?? false);
    const aside = byId("set-aside");
    aside.textContent = contacts?.set_aside ? sentence(contacts.set_aside) : "";
    aside.hidden = !aside.textContent;
  }
}

/** A text with a capital at its start, and a full stop. */
export function sentence(text: string): string {
  return `${text.charAt(0).toUpperCase()}${text.slice(1)}.`;
}
