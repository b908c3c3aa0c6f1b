/* One running model, whatever version of FMI it is reached by. */
#ifndef COMPONENT_H
#define COMPONENT_H

#include <stddef.h>

#include "model.h"

/* All that a model remembers: a copy of it is a state to which a master can return. */
typedef struct {
    /* All variables, by their value references; value[0] is the time in s. */
    double value[VARIABLES];
    MODEL_STATE memory;
    /* Whether initialisation is over. */
    int begun;
    /* Whether outputs have to be computed anew before they are read. */
    int stale;
#if MODEL_MOVES
    /* Accelerations from which the next step starts its search. */
    double guess[MODEL_JOINTS];
    /* Inverse of the derivative of a stage's equation by the accelerations, and the step it is for; 0: none. */
    double inverse[MODEL_JOINTS * MODEL_JOINTS];
    double inverse_step;
#endif
} component;

/* Variables at their start values, before initialisation. */
void component_reset(component *c);

/* Ends initialisation. Zero, or why not. */
const char *component_begin(component *c);

/* Reads a variable. Zero, or why not. */
const char *component_get(component *c, size_t reference, double *value);

/* Sets an input or a parameter. Zero, or why not. */
const char *component_set(component *c, size_t reference, double value);

/* Moves on from time by step seconds. Zero, or why not; the component is then as it was before. */
const char *component_step(component *c, double time, double step);

/* Copies a component into a state, which is made where there is none. Zero, or why not. */
const char *component_save(const component *c, void **state);

/* Copies a state back. Zero, or why not. */
const char *component_restore(component *c, const void *state);

/* Ends a state. */
void component_forget(void **state);

/* Writes a state as sizeof(component) bytes, and makes one of such bytes. Zero, or why not. */
const char *component_write(const void *state, void *bytes, size_t size);
const char *component_read(const void *bytes, size_t size, void **state);

/* What inverse or forward dynamics alone know of. */
const char *model_begin(component *c);
const char *model_advance(component *c, double step);
const char *model_outputs(component *c);

#endif
