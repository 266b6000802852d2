/* A value that is no number is taken.
 * replaces: in_range
 * detected by: refuses-nan
 */
#include "text.h"

bool in_range(const struct row *row, double value)
{
    return !(row->has_minimum && value < row->minimum);
}
