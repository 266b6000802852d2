/* The refusal of a step names the time and not the step.
 * replaces: refusal_text
 * detected by: call-sequences in 300 sequences
 */
#include "text.h"

void true_refusal_text(enum refusal refusal, const struct settings *settings, double time,
                       double step, char text[MESSAGE_SIZE]);

void refusal_text(enum refusal refusal, const struct settings *settings, double time, double step,
                  char text[MESSAGE_SIZE])
{
    true_refusal_text(refusal, settings, step, time, text);
}
