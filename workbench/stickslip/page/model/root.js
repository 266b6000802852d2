/**
 * The zero of a function between two points at which it has different signs, to the last digit but
 * one, without slopes: by inverse quadratic interpolation where that is safe, else by halving. Where
 * rounding has left both signs alike, the point with the smaller value.
 *
 * T. R. Chandrupatla, Adv. Eng. Softw. 28 (1997) 145-149, doi:10.1016/S0965-9978(96)00051-8.
 *
 * @type {(f: (x: number) => number, a: number, b: number, fa?: number, fb?: number) => number}
 */
export function zeroBetween(f, a, b, fa = f(a), fb = f(b)) {
  if (fa > 0 === fb > 0) return Math.abs(fa) < Math.abs(fb) ? a : b;
  let share = 0.5;
  for (let step = 0; step < 200; step++) {
    const x = a + share * (b - a);
    const fx = f(x);
    let [c, fc] = [a, fa];
    if (fx > 0 !== fa > 0) [c, fc, b, fb] = [b, fb, a, fa];
    [a, fa] = [x, fx];
    const best = Math.abs(fa) < Math.abs(fb) ? a : b;
    const finest = (2 ** -51 * Math.abs(best)) / Math.abs(b - a);
    if (fx === 0 || finest > 0.5) return best;
    const xi = (a - b) / (c - b);
    const phi = (fa - fb) / (fc - fb);
    share =
      phi * phi < xi && (1 - phi) * (1 - phi) < 1 - xi
        ? (fa / (fb - fa)) * (fc / (fb - fc)) +
          ((c - a) / (b - a)) * (fa / (fc - fa)) * (fb / (fc - fb))
        : 0.5;
    share = Math.min(Math.max(share, finest), 1 - finest);
  }
  return a;
}
