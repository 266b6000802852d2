/** The numbers at the cursor, beside the charts and in words. */

import { byId, setText } from "../view/dom.js";
import { fixed, scaleFor } from "../view/units.js";

/**
 * Returns fit(motion, seen): after a new setting or stretch of time; show(state): write the numbers
 * of a state of the motion; tell(state): the same in words.
 */
export function makeReadouts() {
  const [now, ofX, ofF, ofZ] = ["now", "x-now", "F-now", "z-now"].map(byId);
  /** @type {Partial<Record<"t" | "x" | "x_dot" | "z" | "F", Scale & {decimals: number}>>} */
  let scales = {};

  return {
    fit({ cycle, numbers, slip, p, z_s }, seen) {
      // Without friction the spring is as long as its swing.
      const longest = Math.max(z_s + (slip.overshoot?.growth ?? 0), p.v / numbers.w);
      // While the cursor moves, units and decimals stand still.
      scales = {
        t: rangeOf(seen.to, "time", seen.to - seen.from),
        x: rangeOf(p.v * seen.to, "length", p.v * (seen.to - seen.from)),
        x_dot: rangeOf(cycle.exists ? cycle.x_dot_peak : p.v, "velocity"),
        z: rangeOf(longest, "length"),
        F: rangeOf(p.k * longest, "force"),
      };
    },
    show({ t, mode, x, x_pull, x_dot, z, F }) {
      setText(now, `${fixed(t, scales.t)}, ${modeInWords(mode)}`);
      setText(ofX, `x ${fixed(x, scales.x)}, pulled end ${fixed(x_pull, scales.x)}`);
      setText(ofF, `F ${fixed(F, scales.F)}`);
      setText(ofZ, `ẋ ${fixed(x_dot, scales.x_dot)}, z ${fixed(z, scales.z)}`);
    },
    tell({ t, mode, x, x_dot, x_pull, F }) {
      return (
        `${fixed(t, scales.t)}: ${modeInWords(mode)}, mass at ${fixed(x, scales.x)}, ` +
        `pulled end at ${fixed(x_pull, scales.x)}, spring force ${fixed(F, scales.F)}, ` +
        `velocity ${fixed(x_dot, scales.x_dot)}`
      );
    },
  };
}

/** A unit for values up to `largest`, and decimals for differences of a thousandth of `range` [SI]. */
function rangeOf(largest, kind, range = largest) {
  const scale = scaleFor(largest, kind);
  const decimals = Math.ceil(3 - Math.log10(range / scale.size));
  return { ...scale, decimals: Math.min(Math.max(decimals, 0), 15) };
}

function modeInWords(mode) {
  return mode === 0 ? "sticks" : "slips";
}
