/* LuGre: bristles that bend, and slide as they are bent: docs/theory.md (34).
 *
 * Source: Canudas de Wit, Olsson, Astrom, Lischinsky, A New Model for Control of Systems with
 * Friction, IEEE Transactions on Automatic Control 40 (1995) 419, doi 10.1109/9.376053. */
#include "coefficients.h"
#include "sticking.h"
#include "whole.h"

#include <math.h>

enum { GROWTH, VELOCITY, BRISTLES };

/* Friction is never less than this part of the weight, so that bristles have a length. */
static const double LEAST_FRICTION = 1e-12;
/* Errors count from forces of this part of the weight, where there is next to no friction. */
static const double LEAST_FORCE = 0.01;
/* How much less than others the errors of a slow velocity count, which bristles damp. */
static const double SLOW = 1e5;
/* How much less the errors of heat count than those of the motion. */
static const double HEAT = 10.0;
/* By how much the velocity may grow in a stride: an implicit method steps over a break-away. */
static const double MOST_GROWTH = 30.0;
/* By how much it may fall in one that begins above v_s, which may pass the rise of friction. */
static const double MOST_FALL = 4.0;

static enum refusal lugre_under(struct friction *made, const struct settings *settings,
                                const struct friction *before)
{
    double normal;
    const enum refusal refused = normal_force(settings, &normal);
    const double used = kinetic_coefficient(settings->mu_s, settings->mu_k);
    (void)before;
    if (refused != ACCEPTED) return refused;
    *made = (struct friction){
        .settings = *settings,
        .F_s = settings->mu_s * normal,
        .kinetic = used * normal,
        .gap = (settings->mu_s - used) * normal,
        .v_stick = settings->v_stick,
    };
    made->of.lugre = (struct lugre){
        .mu_k_used = used,
        .medium = {
            .m = settings->m, .k = settings->k, .c = settings->c,
            .v = settings->v + 0.0, /* -0.0 is 0 */
            .F_ext = settings->F_ext,
            .kinetic = made->kinetic, .gap = made->gap,
            .floor = LEAST_FRICTION * settings->m * settings->g,
            .least = LEAST_FORCE * settings->m * settings->g,
            .sigma_0 = settings->sigma_0, .sigma_1 = settings->sigma_1,
            .v_s = settings->v_s, .delta = settings->delta, .v_d = settings->v_d,
            .zeta_start = settings->zeta_start,
        }};
    return isfinite(made->F_s) ? ACCEPTED : NOT_FINITE;
}

const struct medium *medium_of(const struct friction *it)
{
    return &it->of.lugre.medium;
}

struct own medium_own(const struct friction *it)
{
    return (struct own){.state = it->of.lugre.medium.zeta_start};
}

/* Bristles that hold more than friction let go faster than any stride before. */
struct own medium_changed(const struct friction *it, struct own before)
{
    const struct medium *now = &it->of.lugre.medium;
    const double most = fmax(now->kinetic + now->gap, now->floor);
    if (now->sigma_0 * fabs(before.state) > most) before.stride = 0.0;
    return before;
}

void medium_start(struct medium *it, double z, double x_dot, const struct own *own,
                  double y[COLUMNS])
{
    (void)it, (void)z;
    for (int i = 0; i < COLUMNS; i++) y[i] = 0.0;
    y[VELOCITY] = x_dot;
    y[BRISTLES] = own->state;
}

/* Steady friction at this speed [N], and its slope over the speed. */
static double steady(const struct medium *it, double speed, double *slope)
{
    const double ratio = fabs(speed) / it->v_s;
    const double power = it->delta == 2.0   ? ratio * ratio
                         : it->delta == 1.0 ? speed / it->v_s
                                            : pow(ratio, it->delta);
    const double fall = it->gap * exp(-power), force = it->kinetic + fall;
    *slope = speed == 0.0 && it->delta != 1.0 ? 0.0 : -fall * it->delta * power / speed;
    if (speed == 0.0 && it->delta == 1.0) *slope = -fall / it->v_s;
    if (force > it->floor) return force;
    *slope = 0.0;
    return it->floor;
}

void medium_field(const void *whole, const double y[COLUMNS], double rates[COLUMNS],
                  double slopes[COLUMNS][UNKNOWNS])
{
    const struct whole *of = whole;
    const struct medium *it = &of->medium;
    const double u = y[VELOCITY], zeta = y[BRISTLES], way = of->direction;
    double fall;
    const double g = steady(it, way * u, &fall);
    const double ratio = u / it->v_d;
    const double sigma_1 = it->v_d > 0.0 ? it->sigma_1 * exp(-ratio * ratio) : it->sigma_1;
    const double wear = it->sigma_0 * way * u / g; /* of the bristles [1/s] */
    const double zeta_dot = u - wear * zeta;
    const double spring = it->k * (of->start.z + y[GROWTH]) + it->F_ext;
    const double friction = it->sigma_0 * zeta + sigma_1 * zeta_dot;
    rates[GROWTH] = it->v - u;
    rates[VELOCITY] = (spring - friction - it->c * u) / it->m;
    rates[BRISTLES] = zeta_dot;
    rates[UNKNOWNS] = y[GROWTH];
    rates[UNKNOWNS + 1] =
        it->sigma_0 * zeta * (wear * zeta) + sigma_1 * zeta_dot * u + it->c * u * u;
    if (slopes == NULL) return;
    const double sigma_1_u = it->v_d > 0.0 ? -2.0 * ratio / it->v_d * sigma_1 : 0.0;
    const double wear_u = it->sigma_0 * way / g * (1.0 - way * u * fall / g);
    const double zeta_u = 1.0 - wear_u * zeta;
    const double friction_u = sigma_1 * zeta_u + sigma_1_u * zeta_dot;
    const double made[COLUMNS][UNKNOWNS] = {
        {0.0, -1.0, 0.0},
        {it->k / it->m, -(friction_u + it->c) / it->m, -(it->sigma_0 - sigma_1 * wear) / it->m},
        {0.0, zeta_u, -wear},
        {1.0, 0.0, 0.0},
        {0.0,
         it->sigma_0 * zeta * (wear_u * zeta) + friction_u * u + sigma_1 * zeta_dot +
             2.0 * it->c * u,
         2.0 * it->sigma_0 * wear * zeta - sigma_1 * wear * u},
    };
    for (int i = 0; i < COLUMNS; i++)
        for (int j = 0; j < UNKNOWNS; j++) slopes[i][j] = made[i][j];
}

/* The velocity at which the bristles bend under the pull [m/s]. */
static double creep(const struct medium *it)
{
    const double force = it->kinetic + it->gap > it->floor ? it->kinetic + it->gap : it->floor;
    const double pull = it->k * fabs(it->v) / it->sigma_0;
    const double least = 1e-6 * force / sqrt(it->m * it->sigma_0);
    return pull > least ? pull : least;
}

void medium_scales(const struct medium *it, struct system *system)
{
    const double force = it->kinetic + it->gap > it->floor ? it->kinetic + it->gap : it->floor;
    const double whole = fmax(force, it->least), bend = 10.0 * force / it->sigma_0;
    const double length = whole / it->k, fast = fmax(fabs(it->v), whole / sqrt(it->m * it->k));
    system->heat = HEAT * whole * length;
    system->scales[GROWTH] = (struct scale){length, 0.0, length};
    system->scales[VELOCITY] = (struct scale){SLOW * creep(it), SLOW, fast};
    system->scales[BRISTLES] = (struct scale){bend, 1.0, HUGE_VAL};
}

bool medium_reach(const void *whole, const double from[COLUMNS], const double to[COLUMNS])
{
    const struct whole *of = whole;
    const double before = fabs(from[VELOCITY]), after = of->direction * to[VELOCITY];
    if (before > of->medium.v_s && after < before / MOST_FALL) return false;
    return after <= MOST_GROWTH * (before + creep(&of->medium));
}

struct speed medium_speed(const struct medium *it, const double y[COLUMNS],
                          const double rates[COLUMNS])
{
    (void)it;
    return (struct speed){y[VELOCITY], rates[VELOCITY]};
}

double medium_least_speed(const struct medium *it)
{
    return creep(it);
}

double medium_friction(const struct whole *whole, const double y[COLUMNS], double *own)
{
    double rates[COLUMNS];
    const struct medium *it = &whole->medium;
    medium_field(whole, y, rates, NULL);
    *own = y[BRISTLES];
    return it->m * rates[VELOCITY] - (it->k * (whole->start.z + y[GROWTH]) + it->F_ext);
}

static int lugre_remarks(const struct settings *settings, struct remark made[MOST_REMARKS])
{
    const double used = kinetic_coefficient(settings->mu_s, settings->mu_k);
    int count = clamp_remark(settings->mu_s, settings->mu_k, made);
    const double needed = settings->sigma_1 * (settings->mu_s - used) / used;
    if (settings->v_d == 0.0 && needed > settings->c)
        made[count++] = (struct remark){
            "sigma_1 (mu_s - mu_k)/mu_k = %r N.s/m is above c = %r N.s/m: friction may give energy "
            "(it is not passive); a larger c, a smaller sigma_1 or v_d above 0 mends it",
            {needed, settings->c}};
    /* sigma_1(v) v <= 4 g(v) is enough; the left side is largest at v_d/sqrt(2). */
    const double most = exp(-0.5) / sqrt(2.0) * settings->sigma_1 * settings->v_d;
    const double enough = 4.0 * used * (settings->m * settings->g + settings->load);
    if (most > enough)
        made[count++] = (struct remark){
            "sigma_1 v_d exp(-1/2)/sqrt(2) = %r N may be above 4 mu_k N = %r N: friction may give "
            "energy (it may not be passive); a smaller sigma_1 or v_d mends it",
            {most, enough}};
    return count;
}

static double lugre_output(const struct friction *it, const struct own *own, double x_dot,
                           enum reference reference)
{
    (void)x_dot;
    switch (reference) {
    case VR_zeta: return own->state;
    case VR_E_bristles: return 0.5 * it->settings.sigma_0 * own->state * own->state;
    default: return it->of.lugre.mu_k_used;
    }
}

const struct arc_functions *const ARCS[ARC_TAGS] = {
    [STICK] = &STICK_FUNCTIONS,
    [WHOLE] = &WHOLE_FUNCTIONS,
};

const struct law LAW = {
    .under = lugre_under,
    .hold = whole_hold,
    .begin = whole_begin,
    .after = whole_after,
    .arc = whole_arc,
    .same_slip = whole_same_slip,
    .remarks = lugre_remarks,
    .output = lugre_output,
    .whole = true,
};
