/* A feed axis without any event: docs/feed-axis.md (1), (2) and docs/theory.md (19), (26), integrated
   by RODAS3, a stiff L-stable Rosenbrock method (Sandu and others 1997, Atmospheric Environment 31).

   Positions are deviations from the commanded one. Friction is smooth: with s = u/width it is
   F_k(|u|) tanh(8 s) + G s exp((1 - s^2)/2). The maximum is F_k + G, the static friction, at s = 1,
   and nothing is left of G from s = 6 on. What that changes, for a width of 1e-4 of the feed: at rest
   the table creeps by at most 1e-4 of the feed; the flat top delays break-away by some 3e-3/w, as if
   the gap were 0.3 % larger; a slip counts as stopped from 6e-4 of the feed on.
   Growth at rest is a state, the age, which runs below s = 2 and falls to 0 within 1e-3/w above. */
#include <math.h>

enum { MOTOR, V_D, TABLE, U, FORCE, AGE, SIZE, INTEGRAL = SIZE, LAST, FILTERED, QUEUE = FILTERED + 8 };
enum { LONGEST = 20, POINTS = 12 };

typedef struct {
    double m, k, c, N, along, mu_s, mu_k, tau_s, B, t_0, shape, v_s, delta, n_points;
    double speeds[POINTS], mu[POINTS];
    double servo, inertia, d, dry, lag, T_s, dead_time, K_v, K_p, T_n, on_table;
    double velocity_feedforward, friction_feedforward, F_max, n_filters, filters[4][5];
    double width, scale; /* of the regularisation; of the speeds [m/s] */
} Axis;

/* Kinetic friction at a speed u >= 0, and its slope. */
static double kinetic(const Axis *a, double u, double *slope) {
    double gap = a->mu_s - a->mu_k, q = u / a->v_s, fall;
    *slope = 0.0;
    if (a->shape == 1.0) {
        fall = exp(-pow(q, a->delta));
        *slope = u > 0.0 ? -a->N * gap * fall * a->delta * pow(q, a->delta - 1.0) / a->v_s : 0.0;
    } else if (a->shape == 2.0) {
        fall = 1.0 / (1.0 + q);
        *slope = -a->N * gap * fall * fall / a->v_s;
    } else if (a->shape == 3.0) {
        int n = (int)a->n_points, i = 1;
        while (i < n && u >= a->speeds[i]) i++;
        if (i == n) return a->N * a->mu[n - 1];
        double rate = (a->mu[i] - a->mu[i - 1]) / (a->speeds[i] - a->speeds[i - 1]);
        *slope = a->N * rate;
        return a->N * (a->mu[i - 1] + rate * (u - a->speeds[i - 1]));
    } else
        return a->N * a->mu_k;
    return a->N * (a->mu_k + gap * fall);
}

double sliding(const Axis *a, double u) {
    double slope;
    return kinetic(a, u, &slope);
}

/* Friction, with its derivatives by speed and age. */
static double friction(const Axis *a, double u, double age, double *by_u, double *by_age) {
    double slope, s = u / a->width, t = tanh(8.0 * s), bell = fabs(s) < 9.0 ? exp(0.5 - 0.5 * s * s) : 0.0;
    double F_k = kinetic(a, fabs(u), &slope), gap = 0.0, rate = 0.0;
    if (a->shape == 3.0) gap = a->mu_s - a->mu[0];
    if (a->shape == 0.0) {
        double left = a->tau_s > 0.0 ? exp(-age / a->tau_s) : 0.0;
        gap = (a->mu_s - a->mu_k) * (1.0 - left) + a->B * log1p(age / a->t_0);
        rate = (a->tau_s > 0.0 ? (a->mu_s - a->mu_k) * left / a->tau_s : 0.0) + a->B / (age + a->t_0);
    }
    gap *= a->N;
    *by_u = slope * fabs(t) + (F_k * 8.0 * (1.0 - t * t) + gap * (1.0 - s * s) * bell) / a->width;
    *by_age = a->N * rate * s * bell;
    return F_k * t + gap * s * bell;
}

/* Rate f of the state at a commanded force and feed, and where J is given the Jacobian. */
static void rate_of(const Axis *a, const double *x, double force, double feed, double *f, double (*J)[SIZE]) {
    double by_u, by_age, F = a->k * (x[MOTOR] - x[TABLE]), loss = friction(a, x[U], x[AGE], &by_u, &by_age);
    double r = fmin(fmax(0.5 * fabs(x[U]) / a->width - 1.0, 0.0), 1.0), slip = r * r * (3.0 - 2.0 * r);
    double forget = 1e3 * sqrt(a->k / a->m), t = tanh(8.0 * x[V_D] / a->width);
    double acts = a->lag > 0.0 ? x[FORCE] : force;
    f[MOTOR] = x[V_D] - feed;
    f[V_D] = a->servo ? (acts - F - a->d * x[V_D] - a->dry * t) / a->inertia : 0.0;
    f[TABLE] = x[U] - feed;
    f[U] = (F + a->along - loss - a->c * x[U]) / a->m;
    f[FORCE] = a->lag > 0.0 ? (force - x[FORCE]) / a->lag : 0.0;
    f[AGE] = 1.0 - slip - slip * forget * x[AGE];
    if (!J) return;
    for (int i = 0; i < SIZE; i++)
        for (int j = 0; j < SIZE; j++) J[i][j] = 0.0;
    J[MOTOR][V_D] = J[TABLE][U] = 1.0;
    if (a->servo) {
        J[V_D][MOTOR] = -a->k / a->inertia;
        J[V_D][TABLE] = a->k / a->inertia;
        J[V_D][V_D] = -(a->d + a->dry * 8.0 * (1.0 - t * t) / a->width) / a->inertia;
        J[V_D][FORCE] = a->lag > 0.0 ? 1.0 / a->inertia : 0.0;
    }
    J[U][MOTOR] = a->k / a->m;
    J[U][TABLE] = -a->k / a->m;
    J[U][U] = -(by_u + a->c) / a->m;
    J[U][AGE] = -by_age / a->m;
    J[FORCE][FORCE] = a->lag > 0.0 ? -1.0 / a->lag : 0.0;
    J[AGE][AGE] = -slip * forget;
    J[AGE][U] = -copysign(3.0 * r * (1.0 - r) / a->width, x[U]) * (1.0 + forget * x[AGE]);
}

static void factor(double (*M)[SIZE], int *row) {
    for (int i = 0; i < SIZE; i++) {
        int p = i;
        for (int j = i + 1; j < SIZE; j++)
            if (fabs(M[j][i]) > fabs(M[p][i])) p = j;
        row[i] = p;
        for (int j = 0; j < SIZE; j++) {
            double swap = M[i][j];
            M[i][j] = M[p][j], M[p][j] = swap;
        }
        for (int j = i + 1; j < SIZE; j++) {
            M[j][i] /= M[i][i];
            for (int l = i + 1; l < SIZE; l++) M[j][l] -= M[j][i] * M[i][l];
        }
    }
}

static void solve(double (*M)[SIZE], const int *row, double *b) {
    for (int i = 0; i < SIZE; i++) {
        double swap = b[i];
        b[i] = b[row[i]], b[row[i]] = swap;
    }
    for (int i = 0; i < SIZE; i++)
        for (int j = 0; j < i; j++) b[i] -= M[i][j] * b[j];
    for (int i = SIZE - 1; i >= 0; i--) {
        for (int j = i + 1; j < SIZE; j++) b[i] -= M[i][j] * b[j];
        b[i] /= M[i][i];
    }
}

/* `enough` stops end a run; 0: never. */
typedef struct { double least, most, stops, enough, h; int stopped; } Record;

/* Integrate over a span in which force and feed are constant. */
static void integrate(const Axis *a, double *x, double span, double force, double feed, Record *record) {
    static const double A[4][3] = {{0, 0, 0}, {0, 0, 0}, {2, 0, 0}, {2, 0, 1}};
    static const double C[4][3] = {{0, 0, 0}, {4, 0, 0}, {1, -1, 0}, {1, -1, -8.0 / 3.0}};
    double w = sqrt(a->k / a->m), J[SIZE][SIZE], f0[SIZE];
    double tol[SIZE] = {1e-6 * a->scale / w, 1e-6 * a->scale, 1e-6 * a->scale / w, 1e-6 * a->scale,
                        1e-6 * a->scale * w * (a->servo ? a->inertia : 1.0), 1e-5 / w};
    if (record->h <= 0.0) record->h = 1e-3 / w;
    for (double done = 0.0; done < span;) {
        double h = fmin(record->h, span - done), K[4][SIZE], M[SIZE][SIZE], next[SIZE], error = 0.0;
        int row[SIZE], last = h >= span - done;
        rate_of(a, x, force, feed, f0, J);
        for (int i = 0; i < SIZE; i++)
            for (int j = 0; j < SIZE; j++) M[i][j] = (i == j ? 2.0 / h : 0.0) - J[i][j];
        factor(M, row);
        for (int i = 0; i < 4; i++) {
            for (int n = 0; n < SIZE; n++) {
                next[n] = x[n];
                for (int j = 0; j < i; j++) next[n] += A[i][j] * K[j][n];
            }
            if (i < 2)
                for (int n = 0; n < SIZE; n++) K[i][n] = f0[n];
            else
                rate_of(a, next, force, feed, K[i], 0);
            for (int n = 0; n < SIZE; n++)
                for (int j = 0; j < i; j++) K[i][n] += C[i][j] / h * K[j][n];
            solve(M, row, K[i]);
        }
        for (int n = 0; n < SIZE; n++) {
            double slack = n == U && fabs(x[U]) < 9.0 * a->width ? fmin(tol[n], 0.05 * a->width) : tol[n];
            if (n == AGE) slack += 1e-5 * x[n];
            next[n] += K[3][n];
            error += K[3][n] / slack * K[3][n] / slack;
        }
        error = sqrt(error);
        if (!(error <= 1e6)) error = 1e6;
        if (error <= 1.0) {
            for (int n = 0; n < SIZE; n++) x[n] = next[n];
            done = last ? span : done + h;
            record->least = fmin(record->least, x[U]);
            record->most = fmax(record->most, x[U]);
            if (!record->stopped && x[U] < 6.0 * a->width) record->stops += 1.0, record->stopped = 1;
            if (record->stopped && x[U] > 0.1 * feed) record->stopped = 0;
        }
        double grow = fmin(5.0, fmax(0.1, 0.85 * pow(error + 1e-12, -1.0 / 3.0)));
        if (error > 1.0 || !last || grow < 1.0) record->h = h * grow;
        else record->h = fmax(record->h, h * grow);
    }
}

/* What the controller commands at a sample, as (2). */
static double command(const Axis *a, double *x, double feed, double before) {
    double e = -(a->on_table ? x[TABLE] : x[MOTOR]), v_m = before + (x[MOTOR] - x[LAST]) / a->T_s;
    double lack = a->K_v * e + a->velocity_feedforward * feed - v_m;
    double step = a->T_n > 0.0 ? a->K_p * a->T_s / a->T_n * lack : 0.0;
    double force = a->K_p * lack + x[INTEGRAL] + step + a->friction_feedforward, within;
    x[LAST] = x[MOTOR];
    within = fmin(fmax(force, -a->F_max), a->F_max);
    if (within == force || within * step <= 0.0) x[INTEGRAL] += step;
    for (int i = 0; i < (int)a->n_filters; i++) {
        const double *q = a->filters[i];
        double *memory = x + FILTERED + 2 * i, in = within;
        within = q[0] * in + memory[0];
        memory[0] = q[1] * in - q[3] * within + memory[1];
        memory[1] = q[2] * in - q[4] * within;
    }
    return within;
}

/* Go on for n samples; the feed goes straight from one value to another. The queue holds commands,
   the latest first. A rigid drive takes samples of 1/w. */
void run(const Axis *a, double *x, long n, double from, double to, Record *record) {
    double T_s = a->servo ? a->T_s : sqrt(a->m / a->k), before = from;
    int whole = a->servo ? (int)floor(a->dead_time / T_s + 1e-9) : 0;
    double rest = a->servo ? fmax(a->dead_time - whole * T_s, 0.0) : 0.0, *queue = x + QUEUE;
    for (long i = 0; i < n && (record->enough == 0.0 || record->stops < record->enough); i++) {
        double feed = from + (to - from) * (i + 1.0) / n;
        if (a->servo) {
            for (int j = LONGEST - 1; j > 0; j--) queue[j] = queue[j - 1];
            queue[0] = command(a, x, feed, before);
        } else
            x[V_D] = feed;
        if (rest > 1e-9 * T_s) integrate(a, x, rest, queue[whole + 1], feed, record);
        integrate(a, x, T_s - rest, queue[whole], feed, record);
        before = feed;
    }
}
