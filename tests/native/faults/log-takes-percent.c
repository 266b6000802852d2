/* A message is handed to the logger as a printf format with its percent signs.
 * replaces: log_message
 * detected by: call-sequences
 */
#include "fmi2_types.h"
#include "instance.h"

void log_message(const struct instance *it, enum status status, const char *category,
                 const char *text);

void log_message(const struct instance *it, enum status status, const char *category,
                 const char *text)
{
    ((fmi2CallbackLogger)it->logger)(it->environment, it->name, (fmi2Status)status, category, "%s",
                                     text);
}
