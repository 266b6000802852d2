/* The power series along a slip under friction that falls smoothly with speed.
 *
 * With q = u/v_s and the shape e(q) (shapes.h) the equation of slip is, in s = tau/H,
 *
 *     (j + 1) q_(j+1) = A (R_j - D e_j) - C q_j,   (j + 1) R_(j+1) = -S q_j,
 *
 * where A = H/(m v_s), C = H c/m, S = H k v_s; where j = 0, D is added to the first bracket and
 * H k s v to the second right side. Where D and C grow in proportion to the time, products with the
 * coefficient before come beside theirs. For the shapes
 *
 * - Stribeck: p = q^delta, e = exp(-p), d_j = j p_j, j e_j = -sum_i d_i e_(j-i); p is q itself, a
 *   chain of products, or, where delta is not whole,
 *   j q_0 p_j = sum_i (delta i - (j - i)) q_i p_(j-i);
 * - hyperbolic: (1 + q_0) e_j = -sum_i q_i e_(j-i),
 *
 * i from 1 to j (Knuth, The Art of Computer Programming, vol. 2, 4.7). Each sum is added up from the
 * lowest i on, its first term first; the sum of a square is twice its lower half, and the middle
 * term. */
#ifndef STICKSLIP_SERIES_H
#define STICKSLIP_SERIES_H

#include "shapes.h"

/* Highest power of the series of the speed; that of friction goes up to one less. */
enum { ORDER = 26 };

/* Where a series starts, and the factors of its recurrences. */
struct expansion {
    double q, inner, fall, fallen; /* q_0, p_0, e_0, 1 - e_0 */
    double driving;        /* R_0 + D (1 - e_0) [N] */
    double A, D, C, S;
    double pulled; /* H k s v [N] */
    /* Where inputs move: what D and C gain in a time H, half of what `pulled` does; else 0. */
    double D_gained, C_gained, pulled_gained;
};

/* Compute the coefficients of q, up to ORDER, and of e, up to ORDER - 1. */
void series_expand(const struct fall_shape *shape, const struct expansion *given,
                   double q[ORDER + 1], double e[ORDER]);

#endif
