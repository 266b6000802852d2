/* The count of slips is a byte: a truncated integer.
 * replaces: meter_end_slip
 * detected by: n_slips-course in long-run
 */
#include "meter.h"

void true_meter_end_slip(struct meter *meter, double time);

void meter_end_slip(struct meter *meter, double time)
{
    true_meter_end_slip(meter, time);
    meter->n_slips = (unsigned char)meter->n_slips;
}
