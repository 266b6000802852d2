/* The work of the pulling end in stick is force at the start times way.
 * replaces: stick_pull_work
 * detected by: energy-balance in default
 */
#include "sticking.h"

double stick_pull_work(const struct arc *arc, double tau);

double stick_pull_work(const struct arc *arc, double tau)
{
    return arc->of.stick.k * arc->z_start * arc->of.stick.v * tau;
}
