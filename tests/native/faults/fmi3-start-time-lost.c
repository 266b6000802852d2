/* The start time of FMI 3.0, which comes with the initialization, is lost.
 * replaces: fmi3EnterInitializationMode, instance_step
 * detected by: starts-at-start-time
 */
#include "fmi3_types.h"
#include "instance.h"

bool true_instance_step(struct instance *it, double time, double step, bool starts);
fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean tolerance_defined,
                                       fmi3Float64 tolerance, fmi3Float64 start_time,
                                       fmi3Boolean stop_time_defined, fmi3Float64 stop_time);

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean tolerance_defined,
                                       fmi3Float64 tolerance, fmi3Float64 start_time,
                                       fmi3Boolean stop_time_defined, fmi3Float64 stop_time)
{
    (void)tolerance_defined, (void)tolerance, (void)start_time;
    (void)stop_time_defined, (void)stop_time;
    return instance_enter_initialization(instance) ? fmi3OK : fmi3Error;
}

bool instance_step(struct instance *it, double time, double step, bool starts)
{
    (void)starts;
    return true_instance_step(it, time, step, false);
}
