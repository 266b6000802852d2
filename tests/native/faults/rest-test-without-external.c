/* The rest test looks at the spring alone and forgets the external force.
 * replaces: direction_from_rest
 * detected by: stick-within-break-away in force-pulses
 */
#include "sticking.h"

int true_direction_from_rest(double spring, double external, double break_away);

int direction_from_rest(double spring, double external, double break_away)
{
    (void)external;
    return true_direction_from_rest(spring, 0.0, break_away);
}
