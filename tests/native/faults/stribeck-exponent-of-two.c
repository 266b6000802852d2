/* Every exponent is taken for 2.
 * law: stribeck
 * replaces: fall_shape_make
 * detected by: F_friction-course in speeds-between
 */
#include "shapes.h"

void true_fall_shape_make(bool is_hyperbolic, double delta, struct fall_shape *made);

void fall_shape_make(bool is_hyperbolic, double delta, struct fall_shape *made)
{
    (void)delta;
    true_fall_shape_make(is_hyperbolic, 2.0, made);
}
