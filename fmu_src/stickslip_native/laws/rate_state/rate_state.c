/* Friction of rate and state, regularised: docs/theory.md (35). The unknowns are the growth of the
 * spring, Q = asinh(x_dot/V_ref) and phi = ln(V_0 theta/D_c), so that velocities of any size have
 * their digits.
 *
 * Sources: Dieterich, JGR 84 (1979) 2161, doi 10.1029/JB084iB05p02161; Ruina, JGR 88 (1983) 10359,
 * doi 10.1029/JB088iB12p10359; Linker and Dieterich, JGR 97 (1992) 4923, doi 10.1029/92JB00017. */
#include "numerics.h"
#include "sticking.h"
#include "whole.h"

#include <math.h>

enum { GROWTH, Q, PHI };

/* The normal force is never less than this part of the weight. */
static const double LEAST_NORMAL = 1e-12;
/* Errors count from normal forces of this part of it. */
static const double LEAST_FORCE = 0.01;
/* By how much the logarithm of the velocity may grow in a stride: an implicit method steps over an
 * instability. */
static const double MOST_GROWTH = 3.0;
/* The velocities whose sign does not act, in parts of V_0, and the least one. */
static const double LEAST_SPEED = 1e-9, LEAST = 1e-300;
/* Up to this mu_0/a the creep at rest is faster than the least double. */
static const double MOST_LOGARITHM = 600.0;
/* A pull less than this part of a N moves nothing. */
static const double LEAST_PULL = 1e-22;

static enum refusal rate_state_under(struct friction *made, const struct settings *settings,
                                     const struct friction *before)
{
    double normal;
    const enum refusal refused = normal_force(settings, &normal);
    if (refused != ACCEPTED) return refused;
    normal = fmax(normal, LEAST_NORMAL * settings->m * settings->g);
    *made = (struct friction){
        .settings = *settings, .F_s = settings->mu_0 * normal, .v_stick = settings->v_stick};
    struct rate_state *own = &made->of.rate_state;
    own->medium = (struct medium){
        .m = settings->m,
        .k = settings->k,
        .c = settings->c,
        .v = settings->v + 0.0, /* -0.0 is 0 */
        .F_ext = settings->F_ext,
        .normal = normal,
        .least = LEAST_FORCE * settings->m * settings->g,
        .mu_0 = settings->mu_0,
        .a = settings->a,
        .b = settings->b,
        .D_c = settings->D_c,
        .V_0 = settings->V_0,
        .phi_start = log(settings->V_0 * settings->theta_start / settings->D_c),
        .evolution = (int)settings->evolution,
        .inertia = (int)settings->inertia,
    };
    if (before != NULL && settings->b > 0.0)
        own->load_effect =
            settings->alpha / settings->b * log(before->of.rate_state.medium.normal / normal);
    return isfinite(made->F_s) && isfinite(own->medium.phi_start) ? ACCEPTED : NOT_FINITE;
}

const struct medium *medium_of(const struct friction *it)
{
    return &it->of.rate_state.medium;
}

struct own medium_own(const struct friction *it)
{
    return (struct own){.state = it->of.rate_state.medium.phi_start};
}

struct own medium_changed(const struct friction *it, struct own before)
{
    before.state += it->of.rate_state.load_effect;
    return before;
}

static double velocity(const struct medium *it, double q)
{
    return it->V_ref * sinh(q);
}

/* The coefficient at a velocity. */
static double coefficient(const struct medium *it, double x_dot, double phi)
{
    const double part = log(fabs(x_dot) / (2.0 * it->V_0)) + (it->mu_0 + it->b * phi) / it->a;
    const double mu = it->a * (part > 20.0 ? part + log(2.0) : asinh(exp(part)));
    return x_dot == 0.0 ? 0.0 : copysign(mu, x_dot);
}

/* Without inertia the forces balance: of the spring, along the way [N], without its sign. */
struct balance {
    const struct medium *medium;
    double force, phi;
};

/* The speed at a coefficient, and its slope. */
static double speed_at(const struct medium *it, double mu, double phi, double *slope)
{
    const double ahead = it->V_0 * exp((mu - it->mu_0 - it->b * phi) / it->a);
    *slope = ahead * (1.0 + exp(-2.0 * mu / it->a)) / it->a;
    return ahead * -expm1(-2.0 * mu / it->a);
}

static void balance_graph(const void *context, double at, double *value, double *slope)
{
    const struct balance *it = context;
    double steeper;
    const double speed = speed_at(it->medium, at, it->phi, &steeper);
    *value = it->force - it->medium->normal * at - it->medium->c * speed;
    *slope = -it->medium->normal - it->medium->c * steeper;
}

/* The velocity without inertia. */
static double balanced(const struct medium *it, double z, double phi)
{
    const double force = it->k * z + it->F_ext;
    const struct balance balance = {it, fabs(force), phi};
    double mu = balance.force / it->normal, slope;
    if (mu < LEAST_PULL * it->a) return 0.0;
    if (it->c > 0.0) mu = falling_zero(balance_graph, &balance, 0.0, mu);
    return copysign(speed_at(it, mu, phi, &slope), force);
}

/* Where the logarithm of the velocity becomes the velocity [m/s]: as in mu, where rounding of the
 * forces would else be seen near rest, but not where damping or v is less. */
static double reference(const struct medium *it, double phi)
{
    double most = it->V_0 * exp(-fmax((it->mu_0 + it->b * phi) / it->a, 0.0));
    if (it->c > 0.0) most = fmin(most, it->a * it->normal / it->c);
    if (it->v != 0.0) most = fmin(most, fabs(it->v));
    return fmax(most, LEAST);
}

void medium_start(struct medium *it, double z, double x_dot, const struct own *own,
                  double y[COLUMNS])
{
    for (int i = 0; i < COLUMNS; i++) y[i] = 0.0;
    y[PHI] = own->state;
    it->V_ref = reference(it, own->state);
    y[Q] = asinh((it->inertia == INERTIA ? x_dot : balanced(it, z, own->state)) / it->V_ref);
}

void medium_field(const void *whole, const double y[COLUMNS], double rates[COLUMNS],
                  double slopes[COLUMNS][UNKNOWNS])
{
    const struct whole *of = whole;
    const struct medium *it = &of->medium;
    const double a = it->a, b = it->b, c = it->c, normal = it->normal, phi = y[PHI];
    const double u = velocity(it, y[Q]), u_q = hypot(u, it->V_ref);
    const double mu = coefficient(it, u, phi), bent = tanh(mu / a);
    const double psi = it->mu_0 + b * phi;
    /* Slopes of mu. */
    const double steepest = fmin(exp(psi / a) / (2.0 * it->V_0), 1.0 / LEAST);
    const double mu_q = fabs(u) > LEAST ? a * bent * u_q / u : a * it->V_ref * steepest;
    const double mu_phi = b * bent;
    /* Rate of the state, and its slopes. */
    const double speed = of->direction * u;
    double phi_dot, phi_u, phi_phi;
    if (it->evolution == AGING) {
        phi_phi = -it->V_0 / it->D_c * exp(-phi);
        phi_dot = -phi_phi - speed / it->D_c;
        phi_u = -of->direction / it->D_c;
    } else {
        const double steady = log((speed > LEAST ? speed : LEAST) / it->V_0) + phi;
        phi_dot = -speed / it->D_c * steady;
        phi_u = -of->direction / it->D_c * (steady + 1.0);
        phi_phi = -speed / it->D_c;
    }
    const double friction = normal * mu + c * u;
    /* Q' = part / all, with or without inertia. */
    const bool heavy = it->inertia == INERTIA;
    const double net = it->k * (of->start.z + y[GROWTH]) + it->F_ext - friction;
    const double part = heavy ? net / it->m : it->k * (it->v - u) - normal * mu_phi * phi_dot;
    const double all = heavy ? u_q : normal * mu_q + c * u_q;
    const double q_dot = part / all;
    rates[GROWTH] = it->v - u;
    rates[Q] = q_dot;
    rates[PHI] = phi_dot;
    rates[UNKNOWNS] = y[GROWTH];
    rates[UNKNOWNS + 1] = friction * u;
    if (slopes == NULL) return;
    const double phi_q = phi_u * u_q, friction_q = normal * mu_q + c * u_q;
    double part_q = -friction_q / it->m, part_phi = -normal * mu_phi / it->m;
    double all_q = u, all_phi = 0.0;
    if (!heavy) {
        /* Slopes of `bent`; where it is 1 they vanish. */
        const double turn = (1.0 - bent * bent) / a, bent_q = turn * mu_q, bent_phi = turn * mu_phi;
        const double ratio = fabs(u) > LEAST ? u_q / u : 0.0;
        part_q = -it->k * u_q - normal * b * (bent_q * phi_dot + bent * phi_q);
        part_phi = -normal * b * (bent_phi * phi_dot + bent * phi_phi);
        all_q = normal * a * (bent_q * ratio + bent * (1.0 - ratio * ratio)) + c * u;
        all_phi = normal * a * bent_phi * ratio;
    }
    const double made[COLUMNS][UNKNOWNS] = {
        {0.0, -u_q, 0.0},
        {heavy ? it->k / it->m / all : 0.0, (part_q - q_dot * all_q) / all,
         (part_phi - q_dot * all_phi) / all},
        {0.0, phi_q, phi_phi},
        {1.0, 0.0, 0.0},
        {0.0, friction_q * u + friction * u_q, normal * mu_phi * u},
    };
    for (int i = 0; i < COLUMNS; i++)
        for (int j = 0; j < UNKNOWNS; j++) slopes[i][j] = made[i][j];
}

void medium_scales(const struct medium *it, struct system *system)
{
    const double length = it->a * fmax(it->normal, it->least) / it->k;
    system->heat = HUGE_VAL;
    system->scales[GROWTH] = (struct scale){length, 0.0, length};
    system->scales[Q] = system->scales[PHI] = (struct scale){1.0, 0.0, 1.0};
}

bool medium_reach(const void *whole, const double from[COLUMNS], const double to[COLUMNS])
{
    (void)whole;
    return fabs(to[Q]) - fabs(from[Q]) <= MOST_GROWTH;
}

struct speed medium_speed(const struct medium *it, const double y[COLUMNS],
                          const double rates[COLUMNS])
{
    const double x_dot = velocity(it, y[Q]);
    return (struct speed){x_dot, hypot(x_dot, it->V_ref) * rates[Q]};
}

double medium_least_speed(const struct medium *it)
{
    return LEAST_SPEED * it->V_0;
}

double medium_friction(const struct whole *whole, const double y[COLUMNS], double *own)
{
    const struct medium *it = &whole->medium;
    const double x_dot = velocity(it, y[Q]);
    *own = y[PHI];
    return -(it->normal * coefficient(it, x_dot, y[PHI]) + it->c * x_dot);
}

static int rate_state_remarks(const struct settings *settings, struct remark made[MOST_REMARKS])
{
    if (settings->inertia == INERTIA || settings->x_dot_start == 0.0) return 0;
    made[0] = (struct remark){"x_dot_start = %r is ignored: without inertia the velocity follows "
                              "from z_start and theta_start",
                              {settings->x_dot_start}};
    return 1;
}

static bool rate_state_refuses(const struct settings *settings, struct remark *made)
{
    const double logarithm = settings->mu_0 / settings->a;
    *made = (struct remark){"a = %r is out of range for this motion: mu_0/a = %r is above 600, and "
                            "the creep at rest slower than double-precision numbers can follow",
                            {settings->a, logarithm}};
    return logarithm > MOST_LOGARITHM;
}

static double rate_state_output(const struct friction *it, const struct own *own, double x_dot,
                                enum reference reference)
{
    const struct medium *medium = &it->of.rate_state.medium;
    if (reference == VR_mu) return coefficient(medium, x_dot, own->state);
    return medium->D_c / medium->V_0 * exp(own->state);
}

const struct arc_functions *const ARCS[ARC_TAGS] = {
    [STICK] = &STICK_FUNCTIONS,
    [WHOLE] = &WHOLE_FUNCTIONS,
};

const struct law LAW = {
    .under = rate_state_under,
    .hold = whole_hold,
    .begin = whole_begin,
    .after = whole_after,
    .arc = whole_arc,
    .same_slip = whole_same_slip,
    .remarks = rate_state_remarks,
    .refuses = rate_state_refuses,
    .output = rate_state_output,
    .whole = true,
};
