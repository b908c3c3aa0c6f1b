/* The functions of FMI 2.0 co-simulation around a component. */
#include "fmi2.h"

#include <stdlib.h>
#include <string.h>

#include "component.h"

typedef struct {
    component component;
    fmi2CallbackLogger logger;
    fmi2ComponentEnvironment environment;
    char *name;
    int logging;
} instance;

static fmi2Status report(instance *i, const char *problem)
{
    if (problem == NULL) {
        return fmi2OK;
    }
    if (i->logger != NULL && i->logging != 0) {
        i->logger(i->environment, i->name, fmi2Error, "logStatusError", "%s", problem);
    }
    return fmi2Error;
}

EXPORT const char *NAME(fmi2GetTypesPlatform)(void)
{
    return "default";
}

EXPORT const char *NAME(fmi2GetVersion)(void)
{
    return "2.0";
}

EXPORT fmi2Status NAME(fmi2SetDebugLogging)(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    (void)n;
    (void)categories;
    ((instance *)c)->logging = on;
    return fmi2OK;
}

EXPORT fmi2Component NAME(fmi2Instantiate)(fmi2String name, fmi2Type type, fmi2String token, fmi2String resources,
                                           const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                                           fmi2Boolean logging)
{
    instance *i = NULL;
    (void)resources;
    (void)visible;
    if (name == NULL || token == NULL || type != fmi2CoSimulation || strcmp(token, MODEL_TOKEN) != 0) {
        return NULL;
    }
    i = (instance *)calloc(1, sizeof *i);
    if (i == NULL) {
        return NULL;
    }
    i->name = (char *)malloc(strlen(name) + 1);
    if (i->name == NULL) {
        free(i);
        return NULL;
    }
    (void)strcpy(i->name, name);
    if (functions != NULL) {
        i->logger = functions->logger;
        i->environment = functions->componentEnvironment;
    }
    i->logging = logging;
    component_reset(&i->component);
    return i;
}

EXPORT void NAME(fmi2FreeInstance)(fmi2Component c)
{
    if (c != NULL) {
        free(((instance *)c)->name);
        free(c);
    }
}

EXPORT fmi2Status NAME(fmi2SetupExperiment)(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                                            fmi2Real start, fmi2Boolean has_stop, fmi2Real stop)
{
    (void)has_tolerance;
    (void)tolerance;
    (void)has_stop;
    (void)stop;
    ((instance *)c)->component.value[0] = start;
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2EnterInitializationMode)(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2ExitInitializationMode)(fmi2Component c)
{
    return report((instance *)c, component_begin(&((instance *)c)->component));
}

EXPORT fmi2Status NAME(fmi2Terminate)(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2Reset)(fmi2Component c)
{
    component_reset(&((instance *)c)->component);
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2GetReal)(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Real value[])
{
    instance *i = (instance *)c;
    const char *problem = NULL;
    size_t k;
    for (k = 0; k < n && problem == NULL; ++k) {
        problem = component_get(&i->component, r[k], &value[k]);
    }
    return report(i, problem);
}

EXPORT fmi2Status NAME(fmi2SetReal)(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Real value[])
{
    instance *i = (instance *)c;
    const char *problem = NULL;
    size_t k;
    for (k = 0; k < n && problem == NULL; ++k) {
        problem = component_set(&i->component, r[k], value[k]);
    }
    return report(i, problem);
}

/* All variables are real. */
#define NO_VALUES(Type)                                                                                              \
    EXPORT fmi2Status NAME(fmi2Get##Type)(fmi2Component c, const fmi2ValueReference r[], size_t n,                  \
                                          fmi2##Type value[])                                                       \
    {                                                                                                                \
        (void)r;                                                                                                     \
        (void)value;                                                                                                 \
        return report((instance *)c, n == 0 ? NULL : "all variables are real");                                     \
    }                                                                                                                \
    EXPORT fmi2Status NAME(fmi2Set##Type)(fmi2Component c, const fmi2ValueReference r[], size_t n,                  \
                                          const fmi2##Type value[])                                                 \
    {                                                                                                                \
        (void)r;                                                                                                     \
        (void)value;                                                                                                 \
        return report((instance *)c, n == 0 ? NULL : "all variables are real");                                     \
    }

NO_VALUES(Integer)
NO_VALUES(Boolean)
NO_VALUES(String)

EXPORT fmi2Status NAME(fmi2GetFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    return report((instance *)c, component_save(&((instance *)c)->component, state));
}

EXPORT fmi2Status NAME(fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state)
{
    return report((instance *)c, component_restore(&((instance *)c)->component, state));
}

EXPORT fmi2Status NAME(fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    (void)c;
    component_forget(state);
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    (void)c;
    (void)state;
    *size = sizeof(component);
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2SerializeFMUstate)(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    return report((instance *)c, component_write(state, bytes, size));
}

EXPORT fmi2Status NAME(fmi2DeSerializeFMUstate)(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                                fmi2FMUstate *state)
{
    return report((instance *)c, component_read(bytes, size, state));
}

EXPORT fmi2Status NAME(fmi2GetDirectionalDerivative)(fmi2Component c, const fmi2ValueReference unknown[], size_t n,
                                                     const fmi2ValueReference known[], size_t m,
                                                     const fmi2Real seed[], fmi2Real value[])
{
    (void)unknown;
    (void)n;
    (void)known;
    (void)m;
    (void)seed;
    (void)value;
    return report((instance *)c, "directional derivatives are not provided");
}

EXPORT fmi2Status NAME(fmi2SetRealInputDerivatives)(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                                    const fmi2Integer order[], const fmi2Real value[])
{
    (void)r;
    (void)order;
    (void)value;
    return report((instance *)c, n == 0 ? NULL : "derivatives of inputs are not taken");
}

EXPORT fmi2Status NAME(fmi2GetRealOutputDerivatives)(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                                     const fmi2Integer order[], fmi2Real value[])
{
    (void)r;
    (void)order;
    (void)value;
    return report((instance *)c, n == 0 ? NULL : "derivatives of outputs are not provided");
}

EXPORT fmi2Status NAME(fmi2DoStep)(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_return)
{
    (void)no_return;
    return report((instance *)c, component_step(&((instance *)c)->component, time, step));
}

EXPORT fmi2Status NAME(fmi2CancelStep)(fmi2Component c)
{
    return report((instance *)c, "steps are not asynchronous");
}

EXPORT fmi2Status NAME(fmi2GetStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
    (void)c;
    (void)kind;
    *value = fmi2OK;
    return fmi2Discard;
}

EXPORT fmi2Status NAME(fmi2GetRealStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    *value = ((instance *)c)->component.value[0];
    return kind == fmi2LastSuccessfulTime ? fmi2OK : fmi2Discard;
}

EXPORT fmi2Status NAME(fmi2GetIntegerStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void)c;
    (void)kind;
    *value = 0;
    return fmi2Discard;
}

EXPORT fmi2Status NAME(fmi2GetBooleanStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    (void)c;
    *value = 0;
    return kind == fmi2Terminated ? fmi2OK : fmi2Discard;
}

EXPORT fmi2Status NAME(fmi2GetStringStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
{
    (void)c;
    (void)kind;
    *value = "";
    return fmi2Discard;
}
