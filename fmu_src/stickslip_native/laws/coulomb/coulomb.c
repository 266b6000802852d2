/* Coulomb friction with a static coefficient above the kinetic one: docs/theory.md (1), (4). */
#include "coefficients.h"
#include "coulomb_slip.h"
#include "law.h"
#include "sticking.h"

#include <math.h>

static enum refusal coulomb_under(struct friction *made, const struct settings *settings,
                                  const struct friction *before)
{
    double normal;
    enum refusal refused = normal_force(settings, &normal);
    if (refused != ACCEPTED) return refused;
    struct friction it = {.settings = *settings};
    struct coulomb *own = &it.of.coulomb;
    own->mu_k_used = kinetic_coefficient(settings->mu_s, settings->mu_k);
    it.F_s = settings->mu_s * normal;
    it.kinetic = own->mu_k_used * normal;
    /* From the coefficients, where the difference is exact when they are close. */
    it.gap = (settings->mu_s - own->mu_k_used) * normal;
    if (!isfinite(it.F_s)) return NOT_FINITE;
    const struct oscillator *old = before == NULL ? NULL : &before->of.coulomb.oscillator;
    if (old != NULL && settings->k == old->k && settings->m == old->m && settings->c == old->c)
        own->oscillator = *old;
    else
        refused = oscillator_make(&own->oscillator, settings->k, settings->m, settings->c);
    if (refused == ACCEPTED) *made = it;
    return refused;
}

static void coulomb_make_slip(const struct friction *it, int mode, double z, double x_dot,
                              double net, struct arc *made)
{
    coulomb_slip_make(&it->of.coulomb.oscillator, it->settings.v, z, x_dot, mode, net,
                      it->kinetic, made);
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

/* The kinetic coefficient is clamped. */
static bool coulomb_warns(const struct settings *settings)
{
    return is_clamped(settings->mu_s, settings->mu_k);
}

static double coulomb_output(const struct friction *it, enum reference reference)
{
    return reference == VR_mu_k_used ? it->of.coulomb.mu_k_used : 0.0;
}

const struct arc_functions *const ARCS[ARC_TAGS] = {
    [STICK] = &STICK_FUNCTIONS,
    [COULOMB_SLIP] = &COULOMB_SLIP_FUNCTIONS,
};

const struct law LAW = {
    .own_count = 0,
    .under = coulomb_under,
    .hold = sticking_hold,
    .begin = sticking_begin,
    .after = sticking_after,
    .arc = sticking_arc,
    .slip = coulomb_make_slip,
    .way_to_break_away = coulomb_way,
    .same_slip = coulomb_same_slip,
    .warns = coulomb_warns,
    .output = coulomb_output,
};
