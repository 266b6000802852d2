/**
 * Sums, products and quotients with twice the digits of a double, as unevaluated sums [high, low]:
 * the date of a break-away is known to a part of a slip however late it is.
 *
 * T. J. Dekker, Numer. Math. 18 (1971) 224-242, doi:10.1007/BF01397083.
 */

/** @type {(a: number, b: number) => Twofold} a + b, exactly */
export function twoSum(a, b) {
  const sum = a + b;
  const shadow = sum - a;
  return [sum, a - (sum - shadow) + (b - shadow)];
}

/** @type {(a: number, b: number) => Twofold} a b, exactly, far from overflow and underflow */
export function twoProduct(a, b) {
  const product = a * b;
  const [ah, al] = halves(a);
  const [bh, bl] = halves(b);
  return [product, al * bl - (product - ah * bh - al * bh - ah * bl)];
}

/** @type {(number: Twofold, factor: number) => Twofold} to about 31 digits, as what follows */
export function twofoldTimes([high, low], factor) {
  const [product, error] = twoProduct(high, factor);
  return twoSum(product, error + low * factor);
}

/** @type {(number: Twofold, other: Twofold) => Twofold} */
export function twofoldPlus([high, low], [otherHigh, otherLow]) {
  const [sum, error] = twoSum(high, otherHigh);
  return twoSum(sum, error + low + otherLow);
}

/** @type {(numerator: Twofold, denominator: Twofold) => Twofold} */
export function twofoldOver(numerator, denominator) {
  const first = numerator[0] / denominator[0];
  const [high, low] = twofoldPlus(numerator, twofoldTimes(denominator, -first));
  return twoSum(first, (high + low) / denominator[0]);
}

/** @type {(a: number) => Twofold} a as the sum of two doubles that have half its digits each */
function halves(a) {
  const large = 134217729 * a;
  const high = large - (large - a);
  return [high, a - high];
}
