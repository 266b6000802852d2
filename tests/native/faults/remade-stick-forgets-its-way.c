/* A stick that is remade from a state takes what is left to break-away as a difference of forces.
 * replaces: sticking_arc
 * detected by: serialized-state-to-the-bit in default
 */
#include "sticking.h"

enum refusal true_sticking_arc(const struct friction *it, const struct start *start,
                               struct arc *made);

enum refusal sticking_arc(const struct friction *it, const struct start *start, struct arc *made)
{
    struct start less = *start;
    if (less.mode == 0) less.known = false;
    return true_sticking_arc(it, &less, made);
}
