/* Friction that depends on the speed of slip, in three shapes: docs/theory.md (1), (4). */
#include "band.h"
#include "coefficients.h"
#include "coulomb_slip.h"
#include "curve.h"
#include "law.h"
#include "piece.h"
#include "smooth.h"
#include "sticking.h"

#include <math.h>

static bool is_curve(const struct settings *settings)
{
    return settings->shape == CURVE;
}

static int stribeck_remarks(const struct settings *settings, struct remark made[MOST_REMARKS])
{
    int count = 0;
    if (!is_curve(settings)) return clamp_remark(settings->mu_s, settings->mu_k, made);
    if (settings->mu_k != ROWS[VR_mu_k].start)
        made[count++] = (struct remark){
            "mu_k = %r is ignored: shape is 3 (Curve), whose friction is mu_1 to mu_%d",
            {settings->mu_k, settings->n_points}};
    if (curve_ignores(settings, &made[count])) count++;
    return count;
}

static bool stribeck_refuses(const struct settings *settings, struct remark *made)
{
    return is_curve(settings) ? curve_refuses(settings, made) : smooth_refuses(settings, made);
}

static enum refusal curve_under(struct friction *it, const struct settings *settings)
{
    struct stribeck *own = &it->of.stribeck;
    struct remark why;
    if (curve_refuses(settings, &why)) return LAW_REFUSES;
    const enum refusal refused = normal_force(settings, &own->normal);
    if (refused != ACCEPTED) return refused;
    own->mu_k_used = curve_coefficient(settings, (int)settings->n_points);
    it->F_s = settings->mu_s * own->normal;
    it->kinetic = settings->mu_1 * own->normal;
    it->gap = (settings->mu_s - settings->mu_1) * own->normal;
    if (!isfinite(it->F_s)) return NOT_FINITE;
    curve_make(settings, own->normal, &own->curve);
    return ACCEPTED;
}

static enum refusal smooth_under(struct friction *it, const struct settings *settings)
{
    struct stribeck *own = &it->of.stribeck;
    struct remark why;
    enum refusal refused = normal_force(settings, &own->normal);
    if (refused != ACCEPTED) return refused;
    own->mu_k_used = kinetic_coefficient(settings->mu_s, settings->mu_k);
    it->F_s = it->kinetic = settings->mu_s * own->normal;
    if (!isfinite(it->F_s)) return NOT_FINITE;
    refused = oscillator_make(&own->oscillator, settings->k, settings->m, settings->c);
    if (refused != ACCEPTED) return refused;
    if (smooth_refuses(settings, &why)) return LAW_REFUSES;
    smooth_make(settings, own->mu_k_used, own->normal, &own->smooth);
    return ACCEPTED;
}

static enum refusal stribeck_under(struct friction *made, const struct settings *settings,
                                   const struct friction *before)
{
    (void)before;
    struct friction it = {.settings = *settings};
    const enum refusal refused =
        is_curve(settings) ? curve_under(&it, settings) : smooth_under(&it, settings);
    if (refused == ACCEPTED) *made = it;
    return refused;
}

static double stribeck_force(const struct friction *it, double speed)
{
    const struct band *band = it->of.stribeck.curve.bands;
    if (!is_curve(&it->settings)) return smooth_friction(&it->of.stribeck.smooth, speed);
    while (speed > band->high) band++;
    return it->kinetic + (band->rise + band->slope * speed);
}

static void stribeck_part(const struct friction *it, double speed, bool rises, double net,
                          double rate, struct part *made)
{
    if (is_curve(&it->settings))
        curve_part(it, speed, rises, made);
    else
        smooth_part(it, speed, rises, net, rate, made);
}

static enum refusal stribeck_slip(const struct friction *it, int mode, double z, double x_dot,
                                  double net, struct arc *made)
{
    return is_curve(&it->settings) ? curve_slip(it, mode, z, x_dot, net, made)
                                   : smooth_slip(it, mode, z, x_dot, net, made);
}

/* What follows the end of an arc: in a slip that goes on, its next arc. */
static enum refusal stribeck_after(const struct friction *it, const struct arc *ended, double z,
                                   struct arc *following)
{
    const int mode = ended->mode;
    const double growth = z - ended->z_start;
    if (ended->tag == BAND_SLIP && ended->of.band.leaves != 0)
        return stribeck_slip(it, mode, z, mode * band_slip_exit_speed(ended),
                             band_slip_net_at_end(ended, growth), following);
    if (ended->tag == PIECE && ended->of.piece.leaves)
        return stribeck_slip(it, mode, z, mode * piece_exit_speed(ended),
                             piece_net_at_end(ended, growth), following);
    return sticking_after(it, ended, z, following);
}

static double stribeck_way(const struct friction *it, const struct arc *ended)
{
    return ended->tag == PIECE ? piece_way_to_break_away(ended, it->gap)
                               : coulomb_slip_way_to_break_away(ended, it->gap);
}

/* What the equation of slip is made of, beside mass, direction, shape and fixed points. */
static bool stribeck_same_slip(const struct friction *one, const struct friction *other)
{
    const struct settings *a = &one->settings, *b = &other->settings;
    if (!(a->k == b->k && a->c == b->c && a->v == b->v && a->F_ext == b->F_ext)) return false;
    const struct stribeck *ours = &one->of.stribeck, *theirs = &other->of.stribeck;
    if (is_curve(a)) return ours->normal == theirs->normal;
    return ours->smooth.drop == theirs->smooth.drop && ours->smooth.rest == theirs->smooth.rest &&
           a->v_s == b->v_s && a->delta == b->delta;
}

/* The only output is mu_k_used. */
static double stribeck_output(const struct friction *it, const struct own *own, double x_dot,
                              enum reference reference)
{
    (void)own, (void)x_dot;
    (void)reference;
    return it->of.stribeck.mu_k_used;
}

const struct arc_functions *const ARCS[ARC_TAGS] = {
    [STICK] = &STICK_FUNCTIONS,
    [COULOMB_SLIP] = &COULOMB_SLIP_FUNCTIONS,
    [BAND_SLIP] = &BAND_SLIP_FUNCTIONS,
    [PIECE] = &PIECE_FUNCTIONS,
};

const struct law LAW = {
    .under = stribeck_under,
    .hold = sticking_hold,
    .part = stribeck_part,
    .force = stribeck_force,
    .begin = sticking_begin,
    .after = stribeck_after,
    .arc = sticking_arc,
    .slip = stribeck_slip,
    .way_to_break_away = stribeck_way,
    .same_slip = stribeck_same_slip,
    .remarks = stribeck_remarks,
    .refuses = stribeck_refuses,
    .output = stribeck_output,
};
