/* Every step allocates memory that nobody frees.
 * replaces: instance_step
 * detected by: call-sequences in 300 sequences
 */
#include "instance.h"

#include <stdlib.h>

bool true_instance_step(struct instance *it, double time, double step, bool starts);

bool instance_step(struct instance *it, double time, double step, bool starts)
{
    static double *last;
    double *times = malloc(64 * sizeof *times);
    if (times != NULL) {
        for (int n = 0; n < 64; n++) times[n] = time;
        last = times;
    }
    return true_instance_step(it, time, step, starts) && last != NULL;
}
