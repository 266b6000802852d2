#include "extrapolation.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Errors of a stride, relative. */
static const double TOLERANCE = 1e-11;
/* A stride grows and shrinks by no more than this, and aims at this part of the tolerance. */
static const double GROWTH = 8.0, AIM = 0.3;
/* A stride shorter than this part of the first one tried is none. */
static const double SHORTEST = 1e-30;
/* The first row of the table that is trusted. */
enum { FIRST_ROW = 2 };

/* Sub-steps of each row. */
static int count_of(int row)
{
    return row + 2;
}

/* Sub-steps of all rows up to this one, and one for the slopes. */
static double work_of(int row)
{
    return 1.0 + 0.5 * (row + 1) * (row + 4);
}

/* The inverse of 1 - step * slopes, by cofactors. */
static void invert(const double slopes[COLUMNS][UNKNOWNS], double step,
                   double inverse[UNKNOWNS][UNKNOWNS])
{
    double a[UNKNOWNS][UNKNOWNS];
    for (int i = 0; i < UNKNOWNS; i++)
        for (int j = 0; j < UNKNOWNS; j++) a[i][j] = (i == j ? 1.0 : 0.0) - step * slopes[i][j];
    for (int i = 0; i < UNKNOWNS; i++)
        for (int j = 0; j < UNKNOWNS; j++) {
            const int k = (i + 1) % UNKNOWNS, l = (i + 2) % UNKNOWNS;
            const int m = (j + 1) % UNKNOWNS, n = (j + 2) % UNKNOWNS;
            inverse[j][i] = a[k][m] * a[l][n] - a[k][n] * a[l][m];
        }
    const double whole =
        a[0][0] * inverse[0][0] + a[0][1] * inverse[1][0] + a[0][2] * inverse[2][0];
    for (int i = 0; i < UNKNOWNS; i++)
        for (int j = 0; j < UNKNOWNS; j++) inverse[i][j] /= whole;
}

/* The rates and slopes where a stride begins. */
struct origin {
    double rates[COLUMNS], slopes[COLUMNS][UNKNOWNS];
};

/* Go `length` in so many equal sub-steps. */
static void march(const struct system *system, const double from[COLUMNS],
                  const struct origin *origin, double length, int count, double to[COLUMNS])
{
    const double step = length / count;
    double inverse[UNKNOWNS][UNKNOWNS], rates[COLUMNS], move[UNKNOWNS];
    invert(origin->slopes, step, inverse);
    memcpy(rates, origin->rates, sizeof rates);
    memcpy(to, from, sizeof rates);
    for (int n = 0; n < count; n++) {
        if (n > 0) system->field(system->context, to, rates, NULL);
        for (int i = 0; i < UNKNOWNS; i++)
            move[i] = step * (inverse[i][0] * rates[0] + inverse[i][1] * rates[1] +
                              inverse[i][2] * rates[2]);
        for (int i = UNKNOWNS; i < COLUMNS; i++) {
            const double *slope = origin->slopes[i];
            to[i] += step * (rates[i] + slope[0] * move[0] + slope[1] * move[1] +
                             slope[2] * move[2]);
        }
        for (int i = 0; i < UNKNOWNS; i++) to[i] += move[i];
    }
}

/* Add a row to the table, whose last line is kept; `before` becomes the entry before the last. */
static void add_row(const struct system *system, const double from[COLUMNS],
                    const struct origin *origin, double length, int row,
                    double table[MOST_ROWS][COLUMNS], double before[COLUMNS])
{
    double entry[COLUMNS];
    march(system, from, origin, length, count_of(row), entry);
    for (int column = 0; column <= row; column++) {
        const double ratio = (double)count_of(row) / count_of(row - column - 1);
        double kept[COLUMNS];
        memcpy(kept, table[column], sizeof kept);
        memcpy(table[column], entry, sizeof kept);
        if (column == row) break;
        memcpy(before, entry, sizeof kept);
        for (int i = 0; i < COLUMNS; i++) entry[i] += (entry[i] - kept[i]) / (ratio - 1.0);
    }
}

/* The error of an entry, relative to the tolerance. */
static double error_of(const struct system *system, const double from[COLUMNS],
                       const double to[COLUMNS], const double before[COLUMNS])
{
    double worst = fabs(to[COLUMNS - 1] - before[COLUMNS - 1]) / system->heat;
    if (!(worst >= 0.0)) worst = HUGE_VAL;
    for (int i = 0; i < UNKNOWNS; i++) {
        const double size = fmax(fabs(from[i]), fabs(to[i]));
        const struct scale *scale = &system->scales[i];
        const double most = fmin(scale->most, scale->least + scale->gain * size);
        const double error = fabs(to[i] - before[i]) / most;
        if (!(error <= worst)) worst = error;
    }
    return worst / TOLERANCE;
}

void stride_to(const struct system *system, const double from[COLUMNS], struct stride stride,
               double to[COLUMNS])
{
    double table[MOST_ROWS][COLUMNS], before[COLUMNS];
    struct origin origin;
    system->field(system->context, from, origin.rates, origin.slopes);
    for (int row = 0; row < stride.rows; row++)
        add_row(system, from, &origin, stride.length, row, table, before);
    memcpy(to, table[stride.rows - 1], COLUMNS * sizeof *to);
}

/* The length at which the error of a row would be as it shall be. */
static double length_for(double length, double error, int row)
{
    const double factor = pow(AIM / error, 1.0 / (row + 1));
    return length * (factor < GROWTH ? factor > 1.0 / GROWTH ? factor : 1.0 / GROWTH : GROWTH);
}

/* A row of the table: the stride whose error it would meet, and the work for a unit of time. */
struct row_cost {
    double length, work;
};

/* The row to aim at next where row `last` of the table was the last one. */
static int row_for_less(const struct row_cost cost[MOST_ROWS], int last)
{
    if (last > FIRST_ROW && cost[last - 1].work < 0.8 * cost[last].work) return last - 1;
    if (last + 2 < MOST_ROWS && cost[last].work < 0.9 * cost[last - 1].work) return last + 1;
    return last;
}

bool stride_far(const struct system *system, const double from[COLUMNS], struct stride *tried,
                double to[COLUMNS], struct stride *next)
{
    const double shortest = SHORTEST * tried->length;
    struct origin origin;
    int aim = tried->rows - 1 < FIRST_ROW ? FIRST_ROW : tried->rows - 1;
    double length = tried->length;
    system->field(system->context, from, origin.rates, origin.slopes);
    while (length > shortest) {
        double table[MOST_ROWS][COLUMNS], before[COLUMNS], error = HUGE_VAL;
        struct row_cost cost[MOST_ROWS] = {{length, HUGE_VAL}};
        int row = 0;
        for (;; row++) {
            add_row(system, from, &origin, length, row, table, before);
            if (row == 0) continue;
            error = error_of(system, from, table[row], before);
            cost[row].length = length_for(length, error, row);
            cost[row].work = work_of(row) / cost[row].length;
            if (!(error < HUGE_VAL) || row > aim || row + 1 == MOST_ROWS) break;
            if (row >= aim - 1 && row >= FIRST_ROW && error <= 1.0) break;
            /* Two rows more, or one, would not do. */
            const double still = (double)count_of(aim) / count_of(0);
            const double more = row == aim - 1 ? still * count_of(aim + 1) / count_of(0) : still;
            if (row >= aim - 1 && error > more * more) break;
        }
        if (error <= 1.0 && system->reach(system->context, from, table[row])) {
            *tried = (struct stride){.length = length, .rows = row + 1};
            memcpy(to, table[row], sizeof before);
            aim = row_for_less(cost, row);
            next->rows = aim + 1;
            next->length =
                aim > row ? cost[row].length * work_of(aim) / work_of(row) : cost[aim].length;
            return true;
        }
        if (row > aim) row = aim;
        if (row > FIRST_ROW && cost[row - 1].work < 0.9 * cost[row].work) row--;
        aim = row > FIRST_ROW ? row : FIRST_ROW;
        length = error < HUGE_VAL ? fmin(cost[row].length, 0.5 * length) : length / GROWTH;
    }
    return false;
}
