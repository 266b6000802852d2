/* The clamp leaves a gap of 0.001 instead of 0.01.
 * replaces: CLAMP_GAP
 * detected by: mu_k-clamped in clamp
 */
const double CLAMP_GAP = 0.001;
