/* Coulomb friction with a static coefficient above the kinetic one: docs/theory.md (1), (4). */
#include "coefficients.h"
#include "coulomb_slip.h"
#include "law.h"
#include "sticking.h"

#include <math.h>

/* Set the forces of `it`, the growth of its break-away force and its `age_start`, for the settings
 * that it holds: (1), (19). */
static enum refusal coulomb_forces(struct friction *it, double *mu_k_used)
{
    const struct settings *settings = &it->settings;
    double normal;
    const enum refusal refused = normal_force(settings, &normal);
    if (refused != ACCEPTED) return refused;
    *mu_k_used = kinetic_coefficient(settings->mu_s, settings->mu_k);
    it->F_s = settings->mu_s * normal;
    it->kinetic = *mu_k_used * normal;
    /* From the coefficients, where the difference is exact when they are close. */
    it->gap = (settings->mu_s - *mu_k_used) * normal;
    if (!isfinite(it->F_s)) return NOT_FINITE;
    it->age_start = settings->age_start;
    it->dwell = (struct dwell){
        .tau_s = settings->tau_s, .strength = settings->B * normal, .t_0 = settings->t_0};
    if (settings->tau_s > 0.0) {
        it->dwell.rise = it->gap;
        it->F_s = it->kinetic;
        it->gap = 0.0;
    }
    it->varies = it->dwell.rise > 0.0 || it->dwell.strength > 0.0;
    return isfinite(it->dwell.strength) ? ACCEPTED : NOT_FINITE;
}

static enum refusal coulomb_under(struct friction *made, const struct settings *settings,
                                  const struct friction *before)
{
    struct friction it = {.settings = *settings};
    struct coulomb *own = &it.of.coulomb;
    enum refusal refused = coulomb_forces(&it, &own->mu_k_used);
    if (refused != ACCEPTED) return refused;
    const struct oscillator *old = before == NULL ? NULL : &before->of.coulomb.oscillator;
    if (old != NULL && settings->k == old->k && settings->m == old->m && settings->c == old->c)
        own->oscillator = *old;
    else
        refused = oscillator_make(&own->oscillator, settings->k, settings->m, settings->c);
    if (refused == ACCEPTED) *made = it;
    return refused;
}

static double coulomb_force(const struct friction *it, double speed)
{
    (void)speed;
    return it->kinetic;
}

static void coulomb_part(const struct friction *it, double speed, bool rises, double net,
                         double rate, struct part *made)
{
    (void)speed, (void)rises, (void)net, (void)rate;
    *made = (struct part){.band = {.high = HUGE_VAL, .friction = it->kinetic}, .v_s = 1.0};
    fall_shape_make(true, 0.0, &made->shape);
}

static enum refusal coulomb_make_slip(const struct friction *it, int mode, double z, double x_dot,
                                      double net, struct arc *made)
{
    coulomb_slip_make(&it->of.coulomb.oscillator, it->settings.v, z, x_dot, mode, net,
                      it->kinetic, made);
    return ACCEPTED;
}

static double coulomb_way(const struct friction *it, const struct arc *ended)
{
    return coulomb_slip_way_to_break_away(ended, it->gap);
}

/* What the equation of slip is made of, beside mass and direction: (3). */
static bool coulomb_same_slip(const struct friction *one, const struct friction *other)
{
    const struct settings *a = &one->settings, *b = &other->settings;
    return a->k == b->k && a->c == b->c && a->v == b->v && a->F_ext == b->F_ext &&
           one->kinetic == other->kinetic;
}

static int coulomb_remarks(const struct settings *settings, struct remark made[MOST_REMARKS])
{
    return clamp_remark(settings->mu_s, settings->mu_k, made);
}

/* The only output is mu_k_used. */
static double coulomb_output(const struct friction *it, const struct own *own, double x_dot,
                             enum reference reference)
{
    (void)own, (void)x_dot, (void)reference;
    return it->of.coulomb.mu_k_used;
}

const struct arc_functions *const ARCS[ARC_TAGS] = {
    [STICK] = &STICK_FUNCTIONS,
    [COULOMB_SLIP] = &COULOMB_SLIP_FUNCTIONS,
};

const struct law LAW = {
    .under = coulomb_under,
    .hold = sticking_hold,
    .part = coulomb_part,
    .force = coulomb_force,
    .begin = sticking_begin,
    .after = sticking_after,
    .arc = sticking_arc,
    .slip = coulomb_make_slip,
    .way_to_break_away = coulomb_way,
    .same_slip = coulomb_same_slip,
    .remarks = coulomb_remarks,
    .output = coulomb_output,
};
