/* The load-up ends where the spring alone reaches the break-away force.
 * replaces: stick_make
 * detected by: onset-at-break-away in force-pulses
 */
#include "sticking.h"

void true_stick_make(const struct friction *it, double z, const double *way, double age,
                     struct arc *made);
void stick_make(const struct friction *it, double z, const double *way, double age,
                struct arc *made);

void stick_make(const struct friction *it, double z, const double *way, double age,
                struct arc *made)
{
    struct friction alone = *it;
    alone.settings.F_ext = 0.0;
    true_stick_make(&alone, z, way, age, made);
}
