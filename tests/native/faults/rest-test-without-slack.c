/* The rest test takes rounding for motion.
 * replaces: SLACK
 * detected by: equal-bits in 60 sequences
 */
const double SLACK = 0.0;
