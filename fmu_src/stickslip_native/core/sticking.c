#include "sticking.h"

#include <math.h>

/* The rest test forgives rounding: 8 units in the last place of the forces it compares. */
static const double SLACK = 8.0 * 2.220446049250313e-16;

double rest_slack(double spring, double external, double break_away)
{
    return SLACK * (fabs(spring) + fabs(external) + break_away);
}

int direction_from_rest(double spring, double external, double break_away)
{
    const double force = spring + external;
    if (fabs(force) <= break_away + rest_slack(spring, external, break_away)) return 0;
    return force > 0.0 ? 1 : -1;
}

/* Whether the break-away force grows with the age of a stick. */
static bool ages(const struct friction *it)
{
    return it->dwell.rise > 0.0 || it->dwell.strength > 0.0;
}

/* The extension at which a stick of this age breaks away along the pull [m]. */
static double z_held(const struct friction *it, double age)
{
    const struct settings *settings = &it->settings;
    return (copysign(sticking_hold(it, age), settings->v) - settings->F_ext) / settings->k;
}

/* The stick from spring extension z [m]; `way` is what the force still lacks of F_s in the direction
 * of the pull [N], NULL where it is not known better than as a difference. */
static void stick_make(const struct friction *it, double z, const double *way, double age,
                       struct arc *made)
{
    const struct settings *settings = &it->settings;
    const double k = settings->k, v = settings->v;
    struct stick stick = {.k = k, .v = v, .z_end = z};
    double duration = HUGE_VAL;
    if (way != NULL) {
        stick.way = *way;
        stick.way_known = true;
    }
    if (v != 0.0) {
        stick.z_end = z_held(it, age);
        if (!ages(it)) {
            const double growth = way == NULL ? stick.z_end - z : copysign(1.0, v) * *way / k;
            /* A rest that rounding put beyond the threshold breaks away at once. */
            duration = growth / v;
            if (duration < 0.0) duration = 0.0;
        } else {
            double reach = way == NULL ? copysign(1.0, v) * (stick.z_end - z) : *way / k;
            if (reach < 0.0) reach = 0.0;
            const struct dwell dwell = dwell_extension(&it->dwell, age, k);
            duration = dwell_load_up(&dwell, reach, fabs(v));
            stick.z_end = z_held(it, age + duration);
        }
    }
    *made = (struct arc){
        .tag = STICK, .duration = duration, .z_start = z, .age = age, .of.stick = stick};
}

static void stick_start(const struct arc *arc, struct start *start)
{
    const struct stick *stick = &arc->of.stick;
    *start = (struct start){
        .known = stick->way_known, .z = arc->z_start, .force = stick->way, .age = arc->age};
}

static struct motion stick_state(const struct arc *arc, double tau)
{
    return (struct motion){.growth = arc->of.stick.v * tau, .balance = true};
}

static struct motion stick_end(const struct arc *arc)
{
    return (struct motion){.growth = arc->of.stick.z_end - arc->z_start, .balance = true};
}

/* docs/theory.md (15) */
static double stick_pull_work(const struct arc *arc, double tau)
{
    const double k = arc->of.stick.k, v = arc->of.stick.v;
    return k * (v * tau) * (arc->z_start + 0.5 * v * tau);
}

static double stick_heat(const struct arc *arc, double tau, double displacement)
{
    (void)arc, (void)tau, (void)displacement;
    return 0.0;
}

static double stick_extreme_velocity(const struct arc *arc, double tau)
{
    (void)arc, (void)tau;
    return 0.0;
}

const struct arc_functions STICK_FUNCTIONS = {
    .start = stick_start,
    .state = stick_state,
    .end = stick_end,
    .pull_work = stick_pull_work,
    .heat = stick_heat,
    .extreme_velocity = stick_extreme_velocity,
};

/* The slip from any state. */
static enum refusal slip_from(const struct friction *it, int mode, double z, double x_dot,
                              struct arc *made)
{
    const double net = it->settings.k * z + it->settings.F_ext - mode * it->kinetic;
    return LAW.slip(it, mode, z, x_dot, net, made);
}

double sticking_hold(const struct friction *it, double age)
{
    return it->F_s + dwell_growth(&it->dwell, age);
}

enum refusal sticking_begin(const struct friction *it, int mode, double z, double x_dot, double age,
                            const struct own *own, struct arc *begun)
{
    (void)own;
    if (mode != 0) return slip_from(it, mode, z, x_dot, begun);
    mode = direction_from_rest(it->settings.k * z, it->settings.F_ext, LAW.hold(it, age));
    if (mode != 0) return slip_from(it, mode, z, 0.0, begun);
    stick_make(it, z, NULL, age, begun);
    return ACCEPTED;
}

enum refusal sticking_after(const struct friction *it, const struct arc *ended, double z,
                            struct arc *following)
{
    if (ended->tag == STICK) {
        const int mode = ended->of.stick.v > 0.0 ? 1 : -1;
        const double gap = it->gap + dwell_growth(&it->dwell, ended->age + ended->duration);
        return LAW.slip(it, mode, ended->of.stick.z_end, 0.0, mode * gap, following);
    }
    const struct settings *settings = &it->settings;
    const int mode = ended->mode;
    if (direction_from_rest(settings->k * z, settings->F_ext, it->F_s) == -mode)
        return slip_from(it, -mode, z, 0.0, following);
    if (mode * settings->v > 0.0) {
        const double way = LAW.way_to_break_away(it, ended);
        stick_make(it, z, &way, 0.0, following);
    } else {
        stick_make(it, z, NULL, 0.0, following);
    }
    return ACCEPTED;
}

enum refusal sticking_arc(const struct friction *it, const struct start *start, struct arc *made)
{
    if (start->mode != 0)
        return LAW.slip(it, start->mode, start->z, start->x_dot, start->force, made);
    stick_make(it, start->z, start->known ? &start->force : NULL, start->age, made);
    return ACCEPTED;
}
