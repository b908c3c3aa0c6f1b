/* Inverse dynamics: the torque of a motion, with the memory of friction. */
#include "component.h"

#include <math.h>

const char *model_begin(component *c)
{
    MODEL_RESET(&c->memory);
    c->stale = 1;
    return NULL;
}

/* The sample at the present time becomes the last one that friction remembers. */
const char *model_advance(component *c, double step)
{
    const double *v = c->value;
    (void)step;
    MODEL_STEP(&c->memory, &v[OF_P], v[0], &v[OF_Q], &v[OF_QD], &v[OF_QDD], &c->value[OF_TAU]);
    c->stale = 0;
    return NULL;
}

/* The torque at the present inputs, which friction does not yet remember. */
const char *model_outputs(component *c)
{
    MODEL_STATE memory = c->memory;
    const double *v = c->value;
    int j;
    MODEL_STEP(&memory, &v[OF_P], v[0], &v[OF_Q], &v[OF_QD], &v[OF_QDD], &c->value[OF_TAU]);
    for (j = 0; j < MODEL_JOINTS; ++j) {
        if (!isfinite(c->value[OF_TAU + j])) {
            return "the torque of these inputs is not finite";
        }
    }
    return NULL;
}
