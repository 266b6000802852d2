/** The maps: the jump over the speed, and the plane of stiffness and speed. */

import { byId } from "../view/dom.js";
import { whenSeen } from "../view/seen.js";
import { makeJumpMap } from "./jumpmap.js";
import { makePlane } from "./plane.js";

/** @type {(page: Page) => (solution: Solution) => void} returns what shows a solution */
export function makeMaps(page) {
  const maps = [makeJumpMap(byId("jump-map")), makePlane(byId("plane"), page)];
  let sized = false;
  /** @param {Solution} solution */
  const show = (solution) => {
    if (sized) for (const map of maps) map.show(solution);
  };
  const resizes = new ResizeObserver(() => {
    for (const { frame } of maps) frame.resize();
    sized = true;
    show(page.solution());
  });
  for (const { frame } of maps) resizes.observe(frame.svg);
  return whenSeen(byId("maps"), show);
}
