/* The search for the end of a slip stops at a relative step of 1e-4.
 * replaces: SETTLED
 * detected by: equal-bits in 50 sequences
 */
const double SETTLED = 1e-4;
