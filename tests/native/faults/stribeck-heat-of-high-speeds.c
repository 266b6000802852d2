/* The heat of a piece is that of the friction of high speeds.
 * law: stribeck
 * replaces: piece_heat
 * detected by: energy-balance in speeds-stribeck
 */
#include "piece.h"

double true_piece_heat(const struct arc *arc, double tau, double displacement);
double piece_heat(const struct arc *arc, double tau, double displacement);

double piece_heat(const struct arc *arc, double tau, double displacement)
{
    struct arc other = *arc;
    for (int j = 0; j < ORDER; j++) other.of.piece.fall[j] = 0.0;
    return true_piece_heat(&other, tau, displacement);
}
