#include "smooth.h"

#include "band.h"
#include "coefficients.h"
#include "coulomb_slip.h"
#include "piece.h"
#include "shapes.h"

#include <math.h>

/* Half width of the band about steady sliding in which friction is its tangent, relative to the
 * speed over which its slope changes: the error of the friction is the square of it: 2^-32. */
static const double NEAR = 2.3283064365386963e-10;
/* What the neglected friction of a beginning may change the time by, relative to 1/w: 2^-58. */
static const double SOON = 3.469446951953614e-18;

bool smooth_refuses(const struct settings *settings, struct remark *made)
{
    const double mu_k = kinetic_coefficient(settings->mu_s, settings->mu_k);
    const double drop = (settings->mu_s - mu_k) * (settings->m * settings->g + settings->load);
    if (drop / settings->v_s / settings->m < HUGE_VAL) return false;
    *made = (struct remark){"v_s = %r m/s is out of range: its rate (mu_s - mu_k) N/(m v_s) leaves "
                            "the range of double-precision numbers",
                            {settings->v_s}};
    return true;
}

void smooth_make(const struct settings *settings, double mu_k_used, double normal,
                 struct smooth *made)
{
    *made = (struct smooth){
        .k = settings->k,
        .m = settings->m,
        .c = settings->c,
        .v = settings->v,
        .v_s = settings->v_s,
        .drop = (settings->mu_s - mu_k_used) * normal,
        .rest = mu_k_used * normal,
        .w = sqrt(settings->k / settings->m),
    };
    fall_shape_make(settings->shape == HYPERBOLIC, settings->delta, &made->shape);
}

/* The half width of the band about steady sliding [m/s]. */
static double nearness(const struct smooth *it, double pull)
{
    if (pull < 0.0) return 0.0;
    const double breadth = it->v_s * it->shape.breadth;
    if (!it->shape.analytic) return NEAR * (pull < breadth ? pull : breadth);
    return it->shape.flat_from == HUGE_VAL ? NEAR * (breadth + pull) : NEAR * breadth;
}

/* Whether the motion is so close to steady sliding that friction is its tangent there. */
static bool is_steady(const struct smooth *it, double speed, double net, double pull)
{
    const double near = 0.5 * nearness(it, pull);
    if (!(fabs(speed - pull) < near)) return false;
    const double force =
        net + it->drop * shape_fallen(&it->shape, speed / it->v_s) - it->c * speed;
    return fabs(force) < near * it->m * it->w;
}

/* The band about steady sliding. */
static struct band steady_band(const struct smooth *it, double pull)
{
    const double ratio = pull / it->v_s, near = nearness(it, pull);
    const double steep = shape_steepness(&it->shape, ratio);
    const double low = pull - near < 0.0 ? 0.0 : pull - near;
    const double slope = -(it->drop / it->v_s) * steep;
    const double rise = it->drop * (steep * ratio - shape_fallen(&it->shape, ratio));
    const double friction = smooth_friction(it, pull) + slope * (low - pull);
    return (struct band){low, pull + near, rise, slope, friction};
}

/* The band of speeds from 0 on in which friction has not begun to fall.
 *
 * The speed is A t + j t^2/2 with A = net/m, j = k V/m. Friction D q^delta advances the time by its
 * ratio to m A a time t, or to m j. */
static struct band beginning(const struct smooth *it, double net, double k, double pull,
                             double kinetic)
{
    const double delta = it->shape.delta, share = SOON / (it->w * it->drop);
    double high = 0.0;
    if (pull > 0.0) high = it->v_s * pow(share * k * pull, 1.0 / delta);
    if (net > 0.0) {
        const double quick = share * net * (net / (it->m * it->v_s));
        const double quickly = it->v_s * pow(quick, 1.0 / (delta + 1.0));
        if (quickly > high) high = quickly;
    }
    if (it->v_s < high) high = it->v_s;
    return (struct band){0.0, high > 0.0 ? high : it->v_s, 0.0, 0.0, kinetic};
}

void smooth_part(const struct friction *it, double speed, bool rises, double net, double rate,
                 struct part *made)
{
    const struct smooth *smooth = &it->of.stribeck.smooth;
    const double flat_from = smooth->shape.flat_from * smooth->v_s;
    *made = (struct part){.band = {.high = HUGE_VAL}, .v_s = smooth->v_s};
    fall_shape_make(true, 0.0, &made->shape);
    if (smooth->drop == 0.0) return;
    if (speed > flat_from || (speed == flat_from && rises)) {
        made->band = (struct band){flat_from, HUGE_VAL, -smooth->drop, 0.0, smooth->rest};
    } else if (speed == 0.0 && !smooth->shape.analytic) {
        made->band = beginning(smooth, net, 1.0, rate, it->kinetic);
    } else {
        made->drop = smooth->drop;
        made->shape = smooth->shape;
        made->band.high = flat_from;
    }
}

enum refusal smooth_slip(const struct friction *it, int mode, double z, double x_dot, double net,
                         struct arc *made)
{
    const struct smooth *smooth = &it->of.stribeck.smooth;
    const double v = smooth->v, speed = mode * x_dot, pull = mode * v;
    const double flat_from = smooth->shape.flat_from * smooth->v_s;
    struct oscillator oscillator = it->of.stribeck.oscillator;
    struct band band;
    if (smooth->drop == 0.0) {
        coulomb_slip_make(&oscillator, v, z, x_dot, mode, net, it->kinetic, made);
        return ACCEPTED;
    }
    if (speed >= flat_from) {
        band = (struct band){flat_from, HUGE_VAL, -smooth->drop, 0.0, smooth->rest};
    } else if (is_steady(smooth, speed, mode * net, pull)) {
        band = steady_band(smooth, pull);
        const enum refusal refused =
            oscillator_make(&oscillator, smooth->k, smooth->m, smooth->c + band.slope);
        if (refused != ACCEPTED) return refused;
    } else if (speed == 0.0 && !smooth->shape.analytic) {
        band = beginning(smooth, mode * net, smooth->k, pull, it->kinetic);
    } else {
        return piece_make(smooth, z, x_dot, mode, net, made);
    }
    band_slip_make(&oscillator, v, z, x_dot, mode, net, it->kinetic, &band, made);
    return ACCEPTED;
}
