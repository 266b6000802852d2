/* Friction that depends on the speed of slip: the data of its slips and of the law itself. */
#ifndef STICKSLIP_FRICTION_LAW_H
#define STICKSLIP_FRICTION_LAW_H

#include "coulomb_slip_data.h"
#include "series.h"

#include <stdbool.h>

enum shape { STRIBECK_SHAPE = 1, HYPERBOLIC, CURVE };

enum { MOST_POINTS = 12 };

/* A slip up to its end, or up to where its speed leaves a band: band.c. */
struct band_slip {
    struct coulomb_slip coulomb;
    struct band band;
    double base;           /* net force at the start with the friction at standstill [N] */
    double floor, ceiling; /* the ends of the band, widened by rounding [m/s] */
    int leaves; /* +1 where the arc ends at the upper end, -1 at the lower one, else 0 */
    bool steady; /* whether the slip is exactly steady on a falling line, and so stays */
};

/* Friction that falls smoothly with speed, on its mass and spring: smooth.c. */
struct smooth {
    double k, m, c, v, w;
    double v_s;  /* speed of the fall [m/s] */
    double drop; /* friction at standstill less that of high speeds [N] */
    double rest; /* friction of high speeds [N] */
    struct fall_shape shape;
};

/* A piece of a slip under such friction: piece.c. */
struct piece {
    struct smooth law;
    double net;            /* force at the start with the friction at standstill [N] */
    double scale;             /* unit of the time in the series [s] */
    double speeds[ORDER + 1]; /* series of the speed [m/s] */
    double fall[ORDER];       /* series of the shape */
    double last_speed;        /* speed at the end [m/s] */
    double last_way;          /* way at the end beyond that at the speed of the start [m] */
    bool leaves;              /* whether the slip goes on after the piece */
};

/* A measured curve under given settings: curve.c. */
struct curve {
    struct band bands[MOST_POINTS]; /* from the speed 0 on */
    int count;
};

/* The law under given settings: stribeck.c. */
struct stribeck {
    double normal;                /* normal force [N] */
    double mu_k_used;             /* friction coefficient of high speeds */
    struct curve curve;           /* where the shape is one */
    struct smooth smooth;         /* else, with its oscillator */
    struct oscillator oscillator;
};

enum arc_tag { STICK, COULOMB_SLIP, BAND_SLIP, PIECE, ARC_TAGS };

union arc_data {
    struct stick stick;
    struct coulomb_slip coulomb;
    struct band_slip band;
    struct piece piece;
};

union friction_data {
    struct stribeck stribeck;
};

#endif
