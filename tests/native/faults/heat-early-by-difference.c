/* In heavy damping the heat takes its closed form early, where its terms cancel.
 * replaces: EARLY
 * detected by: equal-bits in 250 sequences
 */
const double EARLY = 0.0;
