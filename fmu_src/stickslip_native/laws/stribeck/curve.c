#include "curve.h"

#include "band.h"
#include "coulomb_slip.h"
#include "shapes.h"

#include <math.h>

/* A straight line of the curve: the speeds at which it begins and ends [m/s], its slope [s/m], and
 * the coefficient at its beginning. */
struct line {
    double low, high, slope, mu;
};

/* The value reference of the speed u of a point, from point 2 on; that of mu is the next one. */
static int speed_reference(int point)
{
    return VR_u_2 + 2 * (point - 2);
}

static double value_of(const struct settings *settings, int reference)
{
    return *(const double *)((const char *)settings + ROWS[reference].offset);
}

double curve_speed(const struct settings *settings, int point)
{
    return point == 1 ? 0.0 : value_of(settings, speed_reference(point));
}

double curve_coefficient(const struct settings *settings, int point)
{
    return point == 1 ? settings->mu_1 : value_of(settings, speed_reference(point) + 1);
}

bool curve_refuses(const struct settings *settings, struct remark *made)
{
    if (settings->mu_1 > settings->mu_s) {
        *made = (struct remark){"mu_1 = %r is out of range: it must be at most mu_s = %r",
                                {settings->mu_1, settings->mu_s}};
        return true;
    }
    for (int point = 3; point <= settings->n_points; point++) {
        const double speed = curve_speed(settings, point);
        const double before = curve_speed(settings, point - 1);
        if (speed > before) continue;
        *made = (struct remark){
            "%n = %r m/s is out of range: it must be above %n = %r m/s",
            {speed_reference(point), speed, speed_reference(point - 1), before}};
        return true;
    }
    return false;
}

bool curve_ignores(const struct settings *settings, struct remark *made)
{
    const int beyond = speed_reference((int)settings->n_points + 1);
    for (int reference = beyond; reference <= speed_reference(MOST_POINTS) + 1; reference++) {
        const double value = value_of(settings, reference);
        if (value == ROWS[reference].start) continue;
        *made = (struct remark){"%n = %r is ignored: n_points = %d",
                                {reference, value, settings->n_points}};
        return true;
    }
    return false;
}

/* The straight lines of the curve; neighbours with one slope are one line. */
static int lines_of(const struct settings *settings, struct line lines[MOST_POINTS])
{
    const int points = (int)settings->n_points;
    int count = 0;
    for (int point = 1; point < points; point++) {
        double low = curve_speed(settings, point), mu = curve_coefficient(settings, point);
        const double high = curve_speed(settings, point + 1);
        const double slope = (curve_coefficient(settings, point + 1) - mu) / (high - low);
        if (count > 0 && lines[count - 1].slope == slope) {
            count--;
            low = lines[count].low;
            mu = lines[count].mu;
        }
        lines[count++] = (struct line){low, high, slope, mu};
    }
    double last = curve_speed(settings, points), mu = curve_coefficient(settings, points);
    if (lines[count - 1].slope == 0.0) {
        count--;
        last = lines[count].low;
        mu = lines[count].mu;
    }
    lines[count++] = (struct line){last, HUGE_VAL, 0.0, mu};
    return count;
}

void curve_make(const struct settings *settings, double normal, struct curve *made)
{
    struct line lines[MOST_POINTS];
    made->count = lines_of(settings, lines);
    for (int n = 0; n < made->count; n++) {
        const struct line *line = &lines[n];
        const double rise = (line->mu - settings->mu_1) - line->slope * line->low;
        made->bands[n] = (struct band){line->low, line->high, rise * normal, line->slope * normal,
                                       line->mu * normal};
    }
}

/* The band in which a motion from this speed [m/s] goes on. `net` is the force along the slip but
 * for the damping, with the friction at standstill [N]. */
static const struct band *band_at(const struct friction *it, double speed, double net, double pull)
{
    const struct band *band = it->of.stribeck.curve.bands;
    while (speed > band->high) band++;
    if (speed == band->high) {
        const double force = (net - band->rise) - (it->settings.c + band->slope) * speed;
        if (force > 0.0 || (force == 0.0 && pull > speed)) band++;
    }
    return band;
}

void curve_part(const struct friction *it, double speed, bool rises, struct part *made)
{
    const struct band *band = it->of.stribeck.curve.bands;
    while (speed > band->high || (speed == band->high && rises)) band++;
    *made = (struct part){.band = *band, .v_s = 1.0};
    fall_shape_make(true, 0.0, &made->shape);
}

enum refusal curve_slip(const struct friction *it, int mode, double z, double x_dot, double net,
                        struct arc *made)
{
    const struct settings *settings = &it->settings;
    const double v = settings->v;
    const struct band *band = band_at(it, mode * x_dot, mode * net, mode * v);
    struct oscillator oscillator;
    const enum refusal refused =
        oscillator_make(&oscillator, settings->k, settings->m, settings->c + band->slope);
    if (refused != ACCEPTED) return refused;
    if (it->of.stribeck.curve.count == 1)
        coulomb_slip_make(&oscillator, v, z, x_dot, mode, net, it->kinetic, made);
    else
        band_slip_make(&oscillator, v, z, x_dot, mode, net, it->kinetic, band, made);
    return ACCEPTED;
}
