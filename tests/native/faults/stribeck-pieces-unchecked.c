/* The force of the law is not looked at where a piece ends, and pieces are twice as long.
 * law: stribeck
 * replaces: agrees, TAIL
 * detected by: x_dot-course in speeds-stribeck
 */
#include "piece.h"

extern const double TAIL;
const double TAIL = 1e-9;

bool agrees(const struct arc *arc, double s, double net, bool stops);

bool agrees(const struct arc *arc, double s, double net, bool stops)
{
    (void)arc, (void)s, (void)net, (void)stops;
    return true;
}
