/* Every step of FMI 3.0 asks for the end of the simulation.
 * replaces: fmi3DoStep
 * detected by: runs-to-the-end in default
 */
#include "fmi3_types.h"

fmi3Status true_fmi3DoStep(fmi3Instance instance, fmi3Float64 time, fmi3Float64 step,
                           fmi3Boolean no_earlier_state, fmi3Boolean *event_handling_needed,
                           fmi3Boolean *terminate_simulation, fmi3Boolean *early_return,
                           fmi3Float64 *last_successful_time);
fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 time, fmi3Float64 step,
                      fmi3Boolean no_earlier_state, fmi3Boolean *event_handling_needed,
                      fmi3Boolean *terminate_simulation, fmi3Boolean *early_return,
                      fmi3Float64 *last_successful_time);

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 time, fmi3Float64 step,
                      fmi3Boolean no_earlier_state, fmi3Boolean *event_handling_needed,
                      fmi3Boolean *terminate_simulation, fmi3Boolean *early_return,
                      fmi3Float64 *last_successful_time)
{
    const fmi3Status status =
        true_fmi3DoStep(instance, time, step, no_earlier_state, event_handling_needed,
                        terminate_simulation, early_return, last_successful_time);
    *terminate_simulation = true;
    return status;
}
