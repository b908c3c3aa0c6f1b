/* Variables of a running model: what can be read and set, and when. */
#include "component.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* 0: never set, 1: set at any time, 2: set before initialisation ends. */
static const unsigned char settable[VARIABLES] = MODEL_SETTABLE;
static const double start_value[VARIABLES] = MODEL_START;

void component_reset(component *c)
{
    /* States that are compared or written byte by byte have no undefined ones between their parts. */
    unsigned char *bytes = (unsigned char *)c;
    size_t k;
    for (k = 0; k < sizeof *c; ++k) {
        bytes[k] = 0;
    }
    for (k = 0; k < VARIABLES; ++k) {
        c->value[k] = start_value[k];
    }
    MODEL_RESET(&c->memory);
    c->stale = 1;
}

const char *component_begin(component *c)
{
    const char *problem = model_begin(c);
    if (problem == NULL) {
        c->begun = 1;
    }
    return problem;
}

const char *component_get(component *c, size_t reference, double *value)
{
    const char *problem = NULL;
    if (reference >= VARIABLES) {
        return "there is no variable of this value reference";
    }
    if (c->stale != 0 && settable[reference] == 0 && reference != 0) {
        problem = model_outputs(c);
        if (problem != NULL) {
            return problem;
        }
        c->stale = 0;
    }
    *value = c->value[reference];
    return NULL;
}

const char *component_set(component *c, size_t reference, double value)
{
    if (reference >= VARIABLES) {
        return "there is no variable of this value reference";
    }
    if (settable[reference] == 0) {
        return "outputs and the time cannot be set";
    }
    if (settable[reference] == 2 && c->begun != 0) {
        return "this parameter is fixed once initialisation is over";
    }
    if (!isfinite(value)) {
        return "a value is not finite";
    }
    c->value[reference] = value;
    c->stale = 1;
    return NULL;
}

const char *component_step(component *c, double time, double step)
{
    const component before = *c;
    const char *problem = NULL;
    int k;
    if (c->begun == 0) {
        return "a step before the end of initialisation";
    }
    if (!isfinite(time) || !(fabs(time - c->value[0]) <= 1e-6 * (1.0 + fabs(time)))) {
        return "the step does not begin where the last one ended";
    }
    if (!(step >= 0.0) || !isfinite(step)) {
        return "the length of a step is negative or not finite";
    }
    c->value[0] = time;
    problem = model_advance(c, step);
    for (k = 0; problem == NULL && k < VARIABLES; ++k) {
        if (!isfinite(c->value[k])) {
            problem = "a variable is not finite after the step";
        }
    }
    if (problem != NULL) {
        *c = before;
    } else {
        c->value[0] = time + step;
    }
    return problem;
}

const char *component_save(const component *c, void **state)
{
    return component_read(c, sizeof *c, state);
}

const char *component_restore(component *c, const void *state)
{
    if (state == NULL) {
        return "there is no state to return to";
    }
    (void)memcpy(c, state, sizeof *c);
    return NULL;
}

void component_forget(void **state)
{
    if (state != NULL) {
        free(*state);
        *state = NULL;
    }
}

const char *component_write(const void *state, void *bytes, size_t size)
{
    if (state == NULL || size < sizeof(component)) {
        return "a state does not fit into the bytes that are given";
    }
    (void)memcpy(bytes, state, sizeof(component));
    return NULL;
}

const char *component_read(const void *bytes, size_t size, void **state)
{
    if (size != sizeof(component)) {
        return "these bytes are no state of this model";
    }
    if (*state == NULL) {
        *state = malloc(sizeof(component));
    }
    if (*state == NULL) {
        return "there is no memory for a state";
    }
    (void)memcpy(*state, bytes, sizeof(component));
    return NULL;
}
