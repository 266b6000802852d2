/* T is written at the first break-away already, with the time since the start.
 * replaces: meter_start
 * detected by: T-course in overdamped-turn
 */
#include "meter.h"

void meter_start(struct meter *meter, double time)
{
    *meter = (struct meter){.t_event = time, .seen_break_away = true};
}
