/* Short times take the closed form too, whose terms cancel there.
 * replaces: BEGINNING
 * detected by: equal-bits in 200 sequences
 */
const double BEGINNING = 1e-9;
