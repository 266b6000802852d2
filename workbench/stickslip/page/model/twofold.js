/**
 * Sums, products and quotients with twice the digits of a double, as unevaluated sums [high, low]:
 * the date of a break-away is known to a part of a slip however late it is.
 *
 * T. J. Dekker, Numer. Math. 18 (1971) 224-242, doi:10.1007/BF01397083.
 */

/** @typedef {[high: number, low: number]} Twofold in the unit of the quantity */

/**
 * a + b, exactly.
 *
 * @param {number} a
 * @param {number} b in the unit of a
 * @returns {Twofold}
 */
export function twoSum(a, b) {
  const sum = a + b;
  const shadow = sum - a;
  return [sum, a - (sum - shadow) + (b - shadow)];
}

/**
 * a b, exactly, for numbers far from overflow and underflow.
 *
 * @param {number} a
 * @param {number} b
 * @returns {Twofold}
 */
export function twoProduct(a, b) {
  const product = a * b;
  const [ah, al] = halves(a);
  const [bh, bl] = halves(b);
  return [product, al * bl - (product - ah * bh - al * bh - ah * bl)];
}

/**
 * A twofold number times a double, to about 31 digits.
 *
 * @param {Twofold} number
 * @param {number} factor
 * @returns {Twofold}
 */
export function twofoldTimes([high, low], factor) {
  const [product, error] = twoProduct(high, factor);
  return twoSum(product, error + low * factor);
}

/**
 * A twofold number plus another, to about 31 digits.
 *
 * @param {Twofold} number
 * @param {Twofold} other in the unit of the first
 * @returns {Twofold}
 */
export function twofoldPlus([high, low], [otherHigh, otherLow]) {
  const [sum, error] = twoSum(high, otherHigh);
  return twoSum(sum, error + low + otherLow);
}

/**
 * The quotient of two twofold numbers, to about 31 digits.
 *
 * @param {Twofold} numerator
 * @param {Twofold} denominator not 0
 * @returns {Twofold}
 */
export function twofoldOver(numerator, denominator) {
  const first = numerator[0] / denominator[0];
  const [high, low] = twofoldPlus(numerator, twofoldTimes(denominator, -first));
  return twoSum(first, (high + low) / denominator[0]);
}

/**
 * A double as the sum of two that have half its digits each.
 *
 * @param {number} a
 * @returns {Twofold}
 */
function halves(a) {
  const large = 134217729 * a;
  const high = large - (large - a);
  return [high, a - high];
}
