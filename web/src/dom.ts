// Elements of the page, and numbers as text.

type Child = Node | string | null | undefined;

/** A new element with these properties, attributes (names with a dash, `role`, `for`) and children. */
export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  properties: Record<string, unknown> = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.includes("-") || name === "role" || name === "for" || name === "scope") made.setAttribute(name, String(value));
    else Object.assign(made, { [name]: value });
  }
  made.append(...children.filter((child): child is Node | string => child != null));
  return made;
}

/** The element with this id, which the page has. */
export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no #${id}`);
  return found as T;
}

/** How many places after the point are told of a number, in the units of any file: what is nearer to zero is rounding. */
const PLACES = 9;
const ROUNDING = 10 ** -PLACES;

/** A number to at most six significant digits, without trailing zeros. */
export function short(value: number): string {
  if (Math.abs(value) < ROUNDING) return "0";
  return Math.abs(value) >= 1e7 ? value.toExponential(4) : String(Number(value.toPrecision(6)) + 0);
}

/** A number as a field shows it, which has room for it: to nine significant digits, and no finer than rounding. */
export function field(value: number): string {
  return String(Number(Number(value.toPrecision(9)).toFixed(PLACES)) + 0);
}

/** A whole number with its digits in groups of three. */
export function grouped(value: number): string {
  return String(value).replace(/\B(?=(\d{3})+(?!\d))/g, ",");
}

/** The number in a field; nothing if it is empty or no number. */
export function numberIn(input: HTMLInputElement): number | undefined {
  return input.value.trim() === "" || Number.isNaN(input.valueAsNumber) ? undefined : input.valueAsNumber;
}

/** The field in which something was typed that is not entered yet. */
let typed: EventTarget | null = null;
// Before the fields themselves hear of it.
window.addEventListener("input", ({ target }) => (typed = target), true);
for (const end of ["change", "focusout"]) window.addEventListener(end, () => (typed = null), true);

/** Whether somebody is typing in an element. */
export function typing(element: EventTarget | null): boolean {
  return element !== null && element === typed && element === document.activeElement;
}

/** Sets a field, unless somebody is typing in it. */
export function show(input: HTMLInputElement, value: number | undefined): void {
  if (typing(input)) return;
  const text = value === undefined ? "" : field(value);
  if (input.value !== text) input.value = text;
}

/** Lets the browser save a file. */
export function save(name: string, content: BlobPart, type: string): void {
  const place = URL.createObjectURL(new Blob([content], { type }));
  const link = element("a", { href: place, download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(place), 1000);
}
