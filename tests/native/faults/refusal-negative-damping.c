/* A damping below zero is taken: the range is that of another row.
 * replaces: in_range
 * detected by: refuses-c-negative
 */
#include "text.h"

bool true_in_range(const struct row *row, double value);

bool in_range(const struct row *row, double value)
{
    return true_in_range(row == &ROWS[VR_c] ? &ROWS[VR_F_ext] : row, value);
}
