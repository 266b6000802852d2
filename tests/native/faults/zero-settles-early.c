/* The search for the end of a slip stops at a relative step of 1e-4.
 * replaces: SETTLED
 * detected by: t_slip-course in damped-cycle
 */
const double SETTLED = 1e-4;
