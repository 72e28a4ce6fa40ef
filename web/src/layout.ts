// Where the panels are: on a narrow screen the slice is above the joints, and on paper the view is a picture.

import { byId, element } from "./dom";

/** The screens on which all is in one column, as in the style. */
const NARROW = "(max-width: 1000px), (max-height: 520px)";

/** Moves panels to where they belong, now and when the screen changes; `picture` is the view as it is printed. */
export function connectLayout(picture: () => HTMLCanvasElement): void {
  const narrow = matchMedia(NARROW);
  const place = () => {
    if (narrow.matches) byId("joints-panel").before(byId("workspace"));
    else byId("right").prepend(byId("workspace"));
  };
  narrow.addEventListener("change", place);
  place();
  const printed = element("div", { id: "printed" });
  byId("stage").prepend(printed);
  // A browser prints nothing of what a graphics card has drawn.
  window.addEventListener("beforeprint", () => printed.replaceChildren(picture()));
}
