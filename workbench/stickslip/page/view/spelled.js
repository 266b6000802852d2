/** Quantities as people type them, read as the command reads them: `20 mm/s`, `40 N/um`, `1e3`. */

const NUMBER = /^[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:e[+-]?\d+)?/i;
const FACTOR = /^(1|%|\p{L}+)(?:(?:\^|\*\*)?([+-]?\d{1,2})|([²³]))?$/u;
const PRODUCT = /[.·]|(?<!\*)\*(?!\*)/;

/** With so many digits the quotient of two numbers is told from the middle of two doubles. */
const MANY = 100;

/**
 * Make the reader of quantities from the command's own tables: units that take a prefix and others,
 * each with its size as a fraction and exponents of the base units; prefixes; names of quantities by
 * SI unit. read(text, unit, shown): a quantity of the dimension of `unit`; valueOf(number, unit): the
 * double, SI, nearest to a decimal number of a unit.
 */
export function makeReader({ prefixable, alone, prefixes, kinds }) {
  for (const table of [prefixable, alone, prefixes]) Object.setPrototypeOf(table, null);

  /** The unit of a spelling, or null if it is not understood. */
  function unitOf(spelling) {
    const text = spelling === "-" ? "" : spelling;
    const [above, ...below] = text.replace(/\s*([./*·])\s*/g, "$1").split("/");
    const parts = above ? above.split(PRODUCT).map((part) => factor(part, 1)) : [];
    if (below.length && !above) return null;
    // As in print, everything after the stroke stands below it.
    parts.push(...below.flatMap((each) => each.split(PRODUCT)).map((part) => factor(part, -1)));
    if (parts.includes(null)) return null;
    return parts.reduce(
      (all, part) => ({
        top: all.top * part.top,
        bottom: all.bottom * part.bottom,
        dimension: all.dimension.map((power, n) => power + part.dimension[n]),
      }),
      { top: 1n, bottom: 1n, dimension: alone[1].slice(2) },
    );
  }

  function factor(text, side) {
    const [, symbol, digits, raised] = FACTOR.exec(text) ?? [];
    if (!symbol) return null;
    const power = side * Number(digits ?? (raised === "³" ? 3 : raised === "²" ? 2 : 1));
    let [size, prefix] = [alone[symbol] ?? prefixable[symbol], [1, 1]];
    if (!size) {
      [prefix, size] = [prefixes[symbol[0]], prefixable[symbol.slice(1)]];
      if (!prefix || !size) return null;
    }
    const [top, bottom] = [0, 1].map((n) => BigInt(size[n] * prefix[n]) ** BigInt(Math.abs(power)));
    const dimension = size.slice(2).map((each) => power * each);
    return power < 0 ? { top: bottom, bottom: top, dimension } : { top, bottom, dimension };
  }

  /** The name of a quantity of this unit, such as "a force". */
  function nameOf({ dimension }) {
    return Object.keys(kinds).find((unit) => same(unitOf(unit).dimension, dimension));
  }

  return {
    /**
     * A number without a unit has the one shown. The value is the finite double nearest to it; inUnit:
     * whether the text names a unit.
     * @returns {{value?: number, wrong?: string, inUnit: boolean}}
     */
    read(text, unit, shown) {
      const typed = text.trim();
      const [number] = NUMBER.exec(typed) ?? [];
      if (number === undefined) return { wrong: "is not a finite number", inUnit: false };
      const symbol = typed.slice(number.length).trim();
      if (symbol[0] === ",") {
        return { wrong: "has a comma where the decimal point is expected", inUnit: false };
      }
      const inUnit = symbol !== "";
      const found = unitOf(symbol || shown);
      if (!found) return { wrong: `has the unknown unit “${shortened(symbol)}”`, inUnit };
      if (!same(found.dimension, unitOf(unit).dimension)) {
        const kind = nameOf(found);
        return { wrong: kind ? `is ${kinds[kind]}` : `has the unit “${symbol}”`, inUnit };
      }
      const value = scaled(number, found);
      return Number.isFinite(value)
        ? { value, inUnit }
        : { wrong: "is larger than a double can hold", inUnit };
    },
    valueOf: (number, unit) => scaled(number, unitOf(unit)),
  };
}

/** @type {(text: string) => string} short enough to be said again */
export function shortened(text) {
  return text.length > 14 ? `${text.slice(0, 12)}…` : text;
}

function same(one, other) {
  return one.every((power, n) => power === other[n]);
}

/** The double nearest to a decimal number times the size of a unit: rounded once, by `Number`. */
function scaled(number, { top, bottom }) {
  const unscaled = Number(number);
  if (top === bottom || !unscaled || !Number.isFinite(unscaled)) return unscaled;
  const [mantissa, exponent = "0"] = number.toLowerCase().split("e");
  const [whole, decimals = ""] = mantissa.replace(/[+-]/, "").split(".");
  const places = MANY + `${bottom}`.length;
  const above = BigInt(whole + decimals) * top * 10n ** BigInt(places);
  const power = Number(exponent) - decimals.length - places - 1;
  const value = Number(`${above / bottom}${above % bottom ? 1 : 0}e${power}`);
  return unscaled < 0 ? -value : value;
}
