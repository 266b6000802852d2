/* A state that is written as bytes forgets how old the stick is.
 * replaces: stick_start
 * detected by: serialized-state-to-the-bit in dwell-first-stick
 */
#include "sticking.h"

void true_stick_start(const struct arc *arc, struct start *start);
void stick_start(const struct arc *arc, struct start *start);

void stick_start(const struct arc *arc, struct start *start)
{
    true_stick_start(arc, start);
    start->age = 0.0;
}
