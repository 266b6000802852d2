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
  let width = 0;
  return whenSeen(byId("maps"), (solution) => {
    const now = byId("maps").clientWidth;
    for (const map of maps) {
      if (now !== width) map.resize();
      map.show(solution);
    }
    width = now;
  });
}
