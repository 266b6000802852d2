/* The heat of damping takes its closed form also where its terms cancel.
 * replaces: SHORT
 * detected by: equal-bits in 50 sequences
 */
const double SHORT = 1e-3;
