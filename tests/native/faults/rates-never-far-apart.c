/* Two rates that are far apart are taken together, so the slower one loses digits.
 * replaces: FAR_APART
 * detected by: equal-bits in 200 sequences
 */
const double FAR_APART = 1e300;
