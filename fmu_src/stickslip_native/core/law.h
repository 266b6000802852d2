/* The seam of friction laws: the questions of the block, and what an answer must keep.
 *
 * A law is a folder that is compiled with the core, and the law of an FMU is the one that is. It
 *
 * 1. has a header friction_law.h with `enum arc_tag`, of which STICK is the first and ARC_TAGS the
 *    last, and the unions `arc_data` and `friction_data`; struct stick is one member of the former;
 * 2. defines LAW, and ARCS with the functions of each tag;
 * 3. may use sticking.h, where the mass sticks, breaks away at a force and comes to rest, and what
 *    laws/shared has: a file there is compiled with the laws that include its header.
 *
 * It may assume that settings are constant along an arc, that arcs are passed in the order of time,
 * that an arc is asked up to its duration and not beyond, and that each value is within its bounds.
 * It leaves alone the meter, the sums of displacement, work and heat, and the faces. Nothing here
 * points to anything: a block is copied as it is. */
#ifndef STICKSLIP_LAW_H
#define STICKSLIP_LAW_H

#include "dwell.h"
#include "oscillator.h"
#include "refusal.h"
#include "remark.h"
#include "shapes.h"
#include "table.h"

#include <stdbool.h>

/* The own state of a law without a stick: whole.c. */
struct own {
    double state;        /* what the law has beside the motion of the mass */
    double stride, rows; /* what the method tries next: a length [s] and a count */
};

/* The motion at a time along an arc. */
struct motion {
    double growth;       /* of the spring since the start of the arc [m] */
    double x_dot;        /* velocity of the mass [m/s] */
    double displacement; /* of the mass since the start of the arc [m] */
    double friction;     /* on the mass, with its viscous part [N]; not set in `balance` */
    bool balance;        /* friction balances spring and external force: at rest */
    struct own own;
};

/* Where an arc starts. With the settings it determines the arc. */
struct start {
    int mode;      /* -1 slips backward, 0 sticks, +1 slips forward */
    bool known;    /* whether `force` is given */
    double z;      /* spring extension [m] */
    double x_dot;  /* velocity of the mass [m/s] */
    double force;  /* what the law knows better than as a difference of large forces [N] */
    double age;    /* time at rest before [s], 0 in a slip */
    struct own own;
};

/* A load-up to the break-away force: sticking.c. */
struct stick {
    double k, v;
    double way; /* what the force lacks of F_s in the direction of the pull [N], if way_known */
    double z_end;
    bool way_known;
};

/* A band of speeds in which friction is a straight line. */
struct band {
    double low, high; /* ends of the band [m/s]; 0 is the lowest, infinity the highest */
    double rise;      /* intercept of the line less the friction at standstill [N] */
    double slope;     /* of the line [N.s/m] */
    double friction;  /* on the line at the speed `low` [N] */
};

#include "friction_law.h"

/* The motion from one event or change of settings to the next event. */
struct arc {
    enum arc_tag tag;
    int mode;           /* -1 slips backward, 0 sticks, +1 slips forward */
    double duration;    /* [s], infinity where the arc has no end */
    double z_start;     /* spring extension at the start [m] */
    double x_dot_start; /* velocity of the mass at the start [m/s] */
    double age;         /* time at rest at the start [s], 0 in a slip */
    union arc_data of;
};

/* The functions of arcs of one tag. tau is the time since the start of the arc [s]. */
struct arc_functions {
    void (*start)(const struct arc *arc, struct start *start);
    struct motion (*state)(const struct arc *arc, double tau);
    struct motion (*end)(const struct arc *arc); /* with what is known there exactly */
    double (*pull_work)(const struct arc *arc, double tau); /* [J] */
    double (*heat)(const struct arc *arc, double tau, double displacement); /* [J] */
    double (*extreme_velocity)(const struct arc *arc, double tau); /* of slips [m/s] */
};

extern const struct arc_functions *const ARCS[ARC_TAGS];

/* A friction law under given settings. */
struct friction {
    struct settings settings;
    double F_s;         /* break-away force of a stick that has just begun [N] */
    double kinetic;     /* kinetic friction at standstill [N] */
    double gap;         /* F_s - kinetic, known better than as a difference [N] */
    struct dwell dwell; /* growth of the break-away force in stick; asked by sticking.c */
    double age_start;   /* age of a mass that is at rest when the run starts [s] */
    bool varies;        /* whether the break-away force changes along an arc */
    double v_stick;     /* of a law without a stick: one is shown below this speed [m/s] */
    union friction_data of;
};

/* Friction over speed in a band: the straight line, less drop (1 - e(u/v_s)). */
struct part {
    struct band band;
    double drop, v_s; /* [N], [m/s] */
    struct fall_shape shape;
};

struct law {
    /* Put settings in force; `before` is what held until now, or NULL. */
    enum refusal (*under)(struct friction *made, const struct settings *settings,
                          const struct friction *before);
    /* Break-away force of a stick of this age [N]. */
    double (*hold)(const struct friction *it, double age);
    /* The part of the friction over speed in which a slip from this speed goes on, upward where it
     * `rises`. A slip from rest begins under the net force [N], which grows so fast [N/s]. */
    void (*part)(const struct friction *it, double speed, bool rises, double net, double rate,
                 struct part *made);
    /* Friction of a slip at this speed, at least 0, without its viscous part [N]. */
    double (*force)(const struct friction *it, double speed);
    /* The arc that begins where the mass stands; mode 0 for a mass at rest. There is no own state
     * where a run starts. */
    enum refusal (*begin)(const struct friction *it, int mode, double z, double x_dot, double age,
                          const struct own *own, struct arc *begun);
    /* The arc that follows the end of `ended`, at spring extension z [m]. */
    enum refusal (*after)(const struct friction *it, const struct arc *ended, double z,
                          struct arc *following);
    /* The arc that starts so: the same bits as the arc that `start` was read from. */
    enum refusal (*arc)(const struct friction *it, const struct start *start, struct arc *made);
    /* The slip that starts so under the net force without damping [N]; asked by sticking.c. */
    enum refusal (*slip)(const struct friction *it, int mode, double z, double x_dot, double net,
                         struct arc *made);
    /* What the force lacks of F_s at the end of a slip [N]; asked by sticking.c. */
    double (*way_to_break_away)(const struct friction *it, const struct arc *ended);
    /* Whether both have the same equation of slip. */
    bool (*same_slip)(const struct friction *one, const struct friction *other);
    /* Write what is unusual about the settings, which are taken nevertheless, and return the count
     * of remarks. They are told together. */
    int (*remarks)(const struct settings *settings, struct remark made[MOST_REMARKS]);
    /* Write why the law refuses the settings, or a motion under them that cannot be followed, and
     * return whether it does: `under` returns LAW_REFUSES then. */
    bool (*refuses)(const struct settings *settings, struct remark *made);
    /* An output of the law by its value reference. */
    double (*output)(const struct friction *it, const struct own *own, double x_dot,
                     enum reference reference);
    /* Whether the law has no stick. Then its mass moves along the arcs of a step, never by the
     * solver of a simulator or under inputs that move, and `part`, `force`, `slip` and
     * `way_to_break_away` are not asked; mode 0 of an arc is a spring that grows. */
    bool whole;
};

/* The law that is linked. */
extern const struct law LAW;

/* m g + load [N]; LIFTED_OFF where the load would lift the mass. */
enum refusal normal_force(const struct settings *settings, double *normal);

#endif
