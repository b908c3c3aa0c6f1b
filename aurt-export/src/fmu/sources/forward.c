/*
 * Forward dynamics: y(q, q', q'', z) = u solved for q'', z being what friction remembers.
 *
 * The method is the singly diagonally implicit Runge-Kutta method of Alexander (1977), order two, L-stable, with Newton's
 * method in its stages; steps that it cannot solve are halved. Within REST of zero velocity a joint's torque runs linearly
 * between its values at both ends, so that dry friction holds a joint that rests. A joint that breaks away under a load far
 * beyond its friction may be out of reach of Newton's method however short the step; then the range of rest is widened and
 * narrowed again, each solution being the start of the next.
 */
#include "component.h"

#include <float.h>
#include <math.h>

#define N MODEL_JOINTS
/* Half the width of the velocities that count as rest, rad/s. */
#define REST 2e-4
/* The widest range of rest, rad/s. */
#define WIDEST 1.0
/* 1 - 1/sqrt(2). */
#define GAMMA 0.29289321881345248
#define ITERATIONS 25
#define HALVINGS 8
/* What a stage may leave of its equation, relative to the torques in it. */
#define LEFT 1e-9
/* What it leaves unless rounding, or a kink of friction, lets Newton's method come no closer. */
#define CLOSE 1e-12
/* A change of acceleration from which derivatives are taken, rad/s^2. */
#define PROBE 1e-4
/* Velocity beyond which a motion has failed, rad/s. */
#define LOST 100.0

typedef struct {
    double time;
    double q[N];
    double v[N];
    double a[N];
} motion;

/* The torques of a motion that goes on from the last completed step; velocities below width count as rest. */
static void needed_torque(const component *c, const motion *at, double width, double needed[N])
{
    MODEL_STATE memory = c->memory;
    double below_v[N];
    double above_v[N];
    double below[N];
    double above[N];
    int any = 0;
    int j;
    for (j = 0; j < N; ++j) {
        const int resting = fabs(at->v[j]) < width;
        below_v[j] = resting ? -width : at->v[j];
        above_v[j] = resting ? width : at->v[j];
        any |= resting;
    }
    if (any == 0) {
        MODEL_STEP(&memory, &c->value[OF_P], at->time, at->q, at->v, at->a, needed);
        return;
    }
    MODEL_STEP(&memory, &c->value[OF_P], at->time, at->q, below_v, at->a, below);
    memory = c->memory;
    MODEL_STEP(&memory, &c->value[OF_P], at->time, at->q, above_v, at->a, above);
    for (j = 0; j < N; ++j) {
        const double share = fabs(at->v[j]) < width ? 0.5 * (1.0 + at->v[j] / width) : 0.5;
        needed[j] = below[j] + share * (above[j] - below[j]);
    }
}

/* What is left of the equation; how much that is relative to its torques. */
static double residual(const component *c, double start, double width, const motion *at, double off[N])
{
    double needed[N];
    double scale = 1e-3;
    double size = 0.0;
    int j;
    needed_torque(c, at, width, needed);
    for (j = 0; j < N; ++j) {
        const double wanted = c->value[OF_TAU + j] + c->value[OF_TAU_RATE + j] * (at->time - start);
        off[j] = needed[j] - wanted;
        scale = fabs(needed[j]) > scale ? fabs(needed[j]) : scale;
        scale = fabs(wanted) > scale ? fabs(wanted) : scale;
        /* The sum is not finite if any term is not, which a comparison would hide. */
        size = fabs(off[j]) > size || !isfinite(off[j]) ? fabs(off[j]) : size;
        if (!isfinite(off[j])) {
            return DBL_MAX;
        }
    }
    return size / scale;
}

/* Inverts a matrix by Gauss-Jordan elimination with pivots from its columns; zero if it is singular. */
static int invert(double m[N * N], double inverse[N * N])
{
    int row;
    int column;
    int k;
    for (k = 0; k < N * N; ++k) {
        inverse[k] = k / N == k % N ? 1.0 : 0.0;
    }
    for (column = 0; column < N; ++column) {
        int pivot = column;
        double divisor;
        for (row = column + 1; row < N; ++row) {
            pivot = fabs(m[row * N + column]) > fabs(m[pivot * N + column]) ? row : pivot;
        }
        divisor = m[pivot * N + column];
        if (!isfinite(divisor) || divisor == 0.0) {
            return 0;
        }
        for (k = 0; k < N; ++k) {
            const double a = m[pivot * N + k];
            const double b = inverse[pivot * N + k];
            m[pivot * N + k] = m[column * N + k];
            inverse[pivot * N + k] = inverse[column * N + k];
            m[column * N + k] = a / divisor;
            inverse[column * N + k] = b / divisor;
        }
        for (row = 0; row < N; ++row) {
            const double factor = m[row * N + column];
            if (row == column || factor == 0.0) {
                continue;
            }
            for (k = 0; k < N; ++k) {
                m[row * N + k] -= factor * m[column * N + k];
                inverse[row * N + k] -= factor * inverse[column * N + k];
            }
        }
    }
    return 1;
}

/* A stage from q and v on: v' = v + h a, q' = q + h v'. */
typedef struct {
    const double *q;
    const double *v;
    double time;
    double h;
    double start;
    /* Velocities that count as rest. */
    double width;
} stage;

static void with_acceleration(const stage *s, motion *at)
{
    int j;
    at->time = s->time;
    for (j = 0; j < N; ++j) {
        at->v[j] = s->v[j] + s->h * at->a[j];
        at->q[j] = s->q[j] + s->h * at->v[j];
    }
}

/* The inverse of the derivative of the stage's equation by the accelerations; zero if there is none. */
static int derivative(component *c, const stage *s, const motion *here, const double off[N])
{
    double matrix[N * N];
    double changed[N];
    int row;
    int column;
    for (column = 0; column < N; ++column) {
        motion at = *here;
        const double probe = PROBE * (1.0 + fabs(at.a[column]));
        at.a[column] += probe;
        with_acceleration(s, &at);
        (void)residual(c, s->start, s->width, &at, changed);
        for (row = 0; row < N; ++row) {
            matrix[row * N + column] = (changed[row] - off[row]) / probe;
        }
    }
    return invert(matrix, c->inverse);
}

/* Solves the stage for its accelerations, from those in here on. Zero if that does not succeed. */
static int solve(component *c, const stage *s, motion *here)
{
    double off[N];
    double size;
    int no_closer = 0;
    int iteration;
    int j;
    int k;
    with_acceleration(s, here);
    size = residual(c, s->start, s->width, here, off);
    for (iteration = 0; iteration < ITERATIONS; ++iteration) {
        const int known = c->inverse_step == s->h && c->inverse_step != 0.0 && iteration < 4;
        double share = 1.0;
        double next_size = 0.0;
        double next_off[N];
        double change[N];
        motion next = *here;
        if (size <= CLOSE || (no_closer != 0 && size <= LEFT)) {
            return 1;
        }
        c->inverse_step = 0.0;
        if (known == 0 && derivative(c, s, here, off) == 0) {
            return 0;
        }
        for (j = 0; j < N; ++j) {
            change[j] = 0.0;
            for (k = 0; k < N; ++k) {
                change[j] += c->inverse[j * N + k] * off[k];
            }
        }
        for (;;) {
            for (j = 0; j < N; ++j) {
                next.a[j] = here->a[j] - share * change[j];
            }
            with_acceleration(s, &next);
            next_size = residual(c, s->start, s->width, &next, next_off);
            /* Derivatives of an earlier step get one chance; the last try is taken as it is, since a jump may have to be
               crossed uphill. */
            if (next_size < 0.9 * size || known != 0 || share < 0.05) {
                break;
            }
            share *= 0.5;
        }
        if (next_size <= 0.3 * size) {
            c->inverse_step = s->h;
        }
        no_closer = known == 0 && next_size > 0.3 * size;
        if (next_size < size || (known == 0 && size > LEFT)) {
            *here = next;
            size = next_size;
            for (j = 0; j < N; ++j) {
                off[j] = next_off[j];
            }
        }
    }
    c->inverse_step = 0.0;
    return size <= LEFT;
}

/* The same, if need be by way of wider ranges of rest. */
static int solve_by_all_means(component *c, const stage *s, motion *here)
{
    motion at = *here;
    stage wide = *s;
    double width = WIDEST;
    if (solve(c, s, &at) != 0) {
        *here = at;
        return 1;
    }
    at = *here;
    for (;;) {
        wide.width = width > REST ? width : REST;
        c->inverse_step = 0.0;
        if (solve(c, &wide, &at) == 0) {
            return 0;
        }
        if (width <= REST) {
            *here = at;
            return 1;
        }
        width *= 0.5;
    }
}

/* One step, or parts of it where it cannot be solved. Zero if that does not succeed. */
static int step_of(component *c, motion *state, double start, double length, int halvings)
{
    const double within = GAMMA * length;
    const double rest = length - within;
    motion first = *state;
    motion end;
    double q[N];
    double v[N];
    int solved;
    int j;
    stage s;
    s.q = state->q;
    s.v = state->v;
    s.time = state->time + within;
    s.h = within;
    s.start = start;
    s.width = REST;
    solved = halvings > 0 ? solve(c, &s, &first) : solve_by_all_means(c, &s, &first);
    if (solved != 0) {
        for (j = 0; j < N; ++j) {
            q[j] = state->q[j] + rest * first.v[j];
            v[j] = state->v[j] + rest * first.a[j];
        }
        s.q = q;
        s.v = v;
        s.time = state->time + length;
        end = first;
        solved = halvings > 0 ? solve(c, &s, &end) : solve_by_all_means(c, &s, &end);
    }
    if (solved != 0) {
        double unused[N];
        *state = end;
        MODEL_STEP(&c->memory, &c->value[OF_P], end.time, end.q, end.v, end.a, unused);
        return 1;
    }
    if (halvings == 0) {
        return 0;
    }
    return step_of(c, state, start, 0.5 * length, halvings - 1) != 0
           && step_of(c, state, start, 0.5 * length, halvings - 1) != 0;
}

static void read_state(const component *c, motion *state)
{
    int j;
    state->time = c->value[0];
    for (j = 0; j < N; ++j) {
        state->q[j] = c->value[OF_Q + j];
        state->v[j] = c->value[OF_QD + j];
        state->a[j] = c->guess[j];
    }
}

/* Accelerations with which a step would begin, for whoever reads them; the motion does not depend on them. */
static int accelerations(const component *c, double a[N])
{
    component copy = *c;
    motion state;
    motion at;
    stage s;
    int j;
    read_state(c, &state);
    s.q = state.q;
    s.v = state.v;
    s.time = state.time;
    s.h = GAMMA * c->value[OF_MAX_STEP];
    s.start = state.time;
    s.width = REST;
    at = state;
    if (solve_by_all_means(&copy, &s, &at) == 0) {
        return 0;
    }
    for (j = 0; j < N; ++j) {
        a[j] = at.a[j];
    }
    return 1;
}

const char *model_begin(component *c)
{
    double still[N] = {0.0};
    double at_rest[N];
    double moved[N];
    MODEL_STATE memory;
    int j;
    for (j = 0; j < N; ++j) {
        c->value[OF_Q + j] = c->value[OF_Q_START + j];
        c->value[OF_QD + j] = c->value[OF_QD_START + j];
        c->guess[j] = 0.0;
    }
    if (!(c->value[OF_MAX_STEP] >= 1e-6)) {
        return "max_step_s is below a microsecond";
    }
    MODEL_RESET(&memory);
    MODEL_STEP(&memory, &c->value[OF_P], 0.0, &c->value[OF_Q], still, still, at_rest);
    for (j = 0; j < N; ++j) {
        double unit[N] = {0.0};
        unit[j] = 1.0;
        MODEL_RESET(&memory);
        MODEL_STEP(&memory, &c->value[OF_P], 0.0, &c->value[OF_Q], still, unit, moved);
        if (!(moved[j] - at_rest[j] > 0.0)) {
            return "what the model needs to accelerate a joint, its inertia, is not positive at the start";
        }
    }
    c->inverse_step = 0.0;
    MODEL_RESET(&c->memory);
    MODEL_STEP(&c->memory, &c->value[OF_P], c->value[0], &c->value[OF_Q], &c->value[OF_QD], still, moved);
    c->stale = 1;
    return NULL;
}

const char *model_advance(component *c, double step)
{
    const double start = c->value[0];
    /* A distance that rounding has made a little longer is not worth another step. */
    const double wanted = ceil(step / c->value[OF_MAX_STEP] - 1e-6);
    const double pieces = wanted > 1.0 ? wanted : 1.0;
    double piece;
    motion state;
    int j;
    if (step == 0.0) {
        return NULL;
    }
    if (pieces > 1e9) {
        return "the step is too long for max_step_s";
    }
    read_state(c, &state);
    for (piece = 0.0; piece < pieces; piece += 1.0) {
        if (step_of(c, &state, start, step / pieces, HALVINGS) == 0) {
            return "the accelerations of a step could not be solved for";
        }
        for (j = 0; j < N; ++j) {
            if (!(fabs(state.v[j]) <= LOST)) {
                return "a joint turns with more than 100 rad/s";
            }
        }
    }
    for (j = 0; j < N; ++j) {
        c->value[OF_Q + j] = state.q[j];
        c->value[OF_QD + j] = state.v[j];
        c->value[OF_QDD + j] = state.a[j];
        c->guess[j] = state.a[j];
    }
    c->stale = 0;
    return NULL;
}

const char *model_outputs(component *c)
{
    double a[N];
    int j;
    if (c->begun == 0) {
        for (j = 0; j < N; ++j) {
            c->value[OF_Q + j] = c->value[OF_Q_START + j];
            c->value[OF_QD + j] = c->value[OF_QD_START + j];
        }
    }
    if (accelerations(c, a) == 0) {
        return "the accelerations at the present state could not be solved for";
    }
    for (j = 0; j < N; ++j) {
        c->value[OF_QDD + j] = a[j];
    }
    return NULL;
}
