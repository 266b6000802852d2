/* The motion is right, but t_event is the end of the step that holds the event.
 * replaces: advance_through, meter_break_away, meter_end_slip
 * detected by: t_event-course in default
 */
#include "block.h"

enum refusal true_advance_through(struct block *block, double time, double step);
enum refusal advance_through(struct block *block, double time, double step);
void true_meter_break_away(struct meter *meter, double time);
void true_meter_end_slip(struct meter *meter, double time);

static double end_of_step;

enum refusal advance_through(struct block *block, double time, double step)
{
    end_of_step = time + step;
    return true_advance_through(block, time, step);
}

void meter_break_away(struct meter *meter, double time)
{
    (void)time;
    true_meter_break_away(meter, end_of_step);
}

void meter_end_slip(struct meter *meter, double time)
{
    (void)time;
    true_meter_end_slip(meter, end_of_step);
}
