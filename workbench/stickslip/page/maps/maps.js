/** The maps: the jump over the speed, and the plane of stiffness and speed. */

import { byId } from "../view/dom.js";
import { whenSeen } from "../view/seen.js";
import { makeJumpMap } from "./jumpmap.js";
import { makePlane } from "./plane.js";

/**
 * @import { Page } from "../main.js"
 * @import { Solution } from "../view/solution.js"
 */

/**
 * Bring the maps to life.
 *
 * @param {Page} page
 * @returns {(solution: Solution) => void} shows a solution
 */
export function makeMaps(page) {
  const maps = [makeJumpMap(byId("jump-map")), makePlane(byId("plane"), page)];
  let sized = false;
  /** @param {Solution} solution */
  const show = (solution) => {
    if (sized) for (const map of maps) map.show(solution);
  };
  const resizes = new ResizeObserver(() => {
    for (const { svg, resize } of maps) resize(svg.clientWidth, svg.clientHeight);
    sized = true;
    show(page.solution());
  });
  for (const { svg } of maps) resizes.observe(svg);
  return whenSeen(byId("maps"), show);
}
