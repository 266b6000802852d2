/* A product of powers lacks its middle term, and no piece is checked.
 * law: stribeck
 * replaces: square_of, agrees
 * detected by: x_dot-course in speeds-stribeck
 */
#include "series.h"

double true_square_of(const double one[], int j);
double square_of(const double one[], int j);
bool agrees(const struct arc *arc, double s, double net, bool stops);

double square_of(const double one[], int j)
{
    const double square = true_square_of(one, j);
    return j % 4 == 2 ? square - one[j / 2] * one[j / 2] : square;
}

bool agrees(const struct arc *arc, double s, double net, bool stops)
{
    (void)arc, (void)s, (void)net, (void)stops;
    return true;
}
