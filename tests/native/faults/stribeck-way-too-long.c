/* After a piece that stops forward, the way to break-away is a thousandth too long.
 * law: stribeck
 * replaces: piece_way_to_break_away
 * detected by: t_stick-course in speeds-stribeck
 */
#include "piece.h"

double true_piece_way_to_break_away(const struct arc *ended, double gap);

double piece_way_to_break_away(const struct arc *ended, double gap)
{
    const double way = true_piece_way_to_break_away(ended, gap);
    return ended->mode > 0 ? 1.001 * way : way;
}
