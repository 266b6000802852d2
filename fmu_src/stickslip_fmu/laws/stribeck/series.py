"""The power series along a slip under friction that falls smoothly with speed.

With ``q = u/v_s`` and the shape ``e(q)`` (`shapes`) the equation of slip is, in ``s = tau/H``,

``(j + 1) q_(j+1) = A (R_j - D e_j) - C q_j``,  ``(j + 1) R_(j+1) = -S q_j``,

where ``A = H/(m v_s)``, ``C = H c/m``, ``S = H k v_s``; where j = 0, D is added to the first
bracket and ``H k s v`` to the second right side. For the shapes

- Stribeck: ``p = q^delta``, ``e = exp(-p)``, ``d_j = j p_j``, ``j e_j = -sum_i d_i e_(j-i)``;
  p is q itself, a chain of products, or, where delta is not whole,
  ``j q_0 p_j = sum_i (delta i - (j - i)) q_i p_(j-i)``;
- hyperbolic: ``(1 + q_0) e_j = -sum_i q_i e_(j-i)``,

i from 1 to j (Knuth, The Art of Computer Programming, vol. 2, 4.7). Each sum is added up from the
lowest i on, its first term first; the sum of a square is twice its lower half, and the middle term.

The recurrences are written out as one function without loops: loops take three times as long, and
a change of an input at every step asks for a series every time.
"""

from functools import lru_cache
from typing import Any, Callable, Dict, Iterable, List, Tuple

ORDER = 26
"""Highest power of the speed's series; that of e goes up to one less."""

# Exponents up to this one are chains of products where they are whole.
MOST_WHOLE = 8


Expand = Callable[..., Tuple[List[float], List[float], List[Tuple[float, float]]]]
"""Computes the series.

Arguments: q_0, q_0^delta, e_0, the force R_0 + D (1 - e_0), A, D, C, S, H k s v, delta, v_s.
Returns the coefficients of the speed v_s q, of s^0 first, up to ORDER; those of e, up to ORDER - 1;
and, from the highest power of the speed down to s^1, pairs of the coefficient u_j of the speed and
of u_j/(j + 1).
"""


@lru_cache(maxsize=None)
def expansion_of(kind: str) -> Expand:
    """Return the function that computes the coefficients.

    Parameters
    ----------
    kind
        "hyperbolic", "power" for an exponent that is not whole, or the whole exponent.
    """
    expand: Expand = _function("expand", _source(kind))
    return expand


def _function(name: str, source: str) -> Any:
    scope: Dict[str, Any] = {}
    exec(compile(source, f"<{name} of {__name__}>", "exec"), scope)
    return scope[name]


def _product_source() -> str:
    names = ", ".join(f"{name}{j}" for name in "ab" for j in range(ORDER))
    sums = (_sum(f"a{i} * b{j - i}" for i in range(j + 1)) for j in range(ORDER))
    lines = [
        "def product(a, b):",
        f"{names} = (*a, *b)",
        f"return [{', '.join(sums)}]",
    ]
    return "\n    ".join(lines)


def _source(kind: str) -> str:
    lines = ["def expand(q0, p0, e0, driving, A, D, C, S, pulled, delta, v_s):"]
    chain = () if kind in ("hyperbolic", "power") else products(int(kind))
    lines += [f"x{number}_0 = {_factors(chain, number, 0)}" for number in range(len(chain))]
    lines += ["q1 = A * driving - C * q0", "r1 = pulled - S * q0"]
    for j in range(1, ORDER):
        lines += _shape_lines(kind, chain, j)
        lines.append(f"q{j + 1} = (A * (r{j} - D * e{j}) - C * q{j}) / {j + 1}.0")
        lines.append(f"r{j + 1} = -(S * q{j}) / {j + 1}.0")
    lines += [f"q{j} = v_s * q{j}" for j in range(ORDER + 1)]
    speeds = ", ".join(f"q{j}" for j in range(ORDER + 1))
    shape = ", ".join(f"e{j}" for j in range(ORDER))
    pairs = ", ".join(f"(q{j}, q{j} / {j + 1}.0)" for j in range(ORDER, 0, -1))
    lines.append(f"return [{speeds}], [{shape}], [{pairs}]")
    return "\n    ".join(lines)


def _shape_lines(kind: str, chain: Tuple[Tuple[int, int], ...], j: int) -> List[str]:
    """Return the statements for the coefficients j of the shape."""
    if kind == "hyperbolic":
        return [f"e{j} = -({_sum(f'q{i} * e{j - i}' for i in range(1, j + 1))}) * e0"]
    lines = []
    if kind == "power":
        terms = (f"(delta * {i}.0 - {j - i}.0) * q{i} * p{j - i}" for i in range(1, j + 1))
        lines.append(f"p = p{j} = ({_sum(terms)}) / ({j}.0 * q0)")
    else:
        lines += [f"x{number}_{j} = {_factors(chain, number, j)}" for number in range(len(chain))]
        lines.append(f"p = {_name(len(chain) - 1, j)}")
    lines.append(f"d{j} = {j}.0 * p")
    lines.append(f"e{j} = -({_sum(f'd{i} * e{j - i}' for i in range(1, j + 1))}) / {j}.0")
    return lines


def _sum(terms: Iterable[str]) -> str:
    return " + ".join(terms)


def _name(number: int, j: int) -> str:
    """Return the name of the coefficient j of a product of the chain; -1 is q itself."""
    return f"q{j}" if number < 0 else f"x{number}_{j}"


def _factors(chain: Tuple[Tuple[int, int], ...], number: int, j: int) -> str:
    """Return the coefficient j of a product of the chain; a square has half the terms."""
    one, other = chain[number]
    if one != other:
        return _sum(f"{_name(one, i)} * {_name(other, j - i)}" for i in range(j + 1))
    half = _sum(f"{_name(one, i)} * {_name(one, j - i)}" for i in range((j + 1) // 2))
    middle = f"{_name(one, j // 2)} * {_name(one, j // 2)}"
    if not half:
        return middle
    return f"2.0 * ({half})" + (f" + {middle}" if j % 2 == 0 else "")


def products(exponent: int) -> Tuple[Tuple[int, int], ...]:
    """Return the products that make q^exponent, by its binary digits from the highest down.

    Each is the positions of its two factors among the products before, -1 for q.
    """
    chain: List[Tuple[int, int]] = []
    for digit in bin(exponent)[3:]:
        last = len(chain) - 1
        chain.append((last, last))
        if digit == "1":
            chain.append((last + 1, -1))
    return tuple(chain)


product: Callable[[Iterable[float], Iterable[float]], List[float]] = _function(
    "product", _product_source()
)
"""Returns the first ORDER coefficients of the product of two series that are given so far."""
