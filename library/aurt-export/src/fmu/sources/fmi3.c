/* The functions of FMI 3.0 co-simulation around a component. */
#include "fmi3.h"

#include <stdlib.h>
#include <string.h>

#include "component.h"

typedef struct {
    component component;
    fmi3LogMessageCallback logger;
    fmi3InstanceEnvironment environment;
    bool logging;
} instance;

static fmi3Status report(instance *i, const char *problem)
{
    if (problem == NULL) {
        return fmi3OK;
    }
    if (i->logger != NULL && i->logging) {
        i->logger(i->environment, fmi3Error, "logStatusError", problem);
    }
    return fmi3Error;
}

EXPORT const char *NAME(fmi3GetVersion)(void)
{
    return "3.0";
}

EXPORT fmi3Status NAME(fmi3SetDebugLogging)(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String categories[])
{
    (void)n;
    (void)categories;
    ((instance *)c)->logging = on;
    return fmi3OK;
}

EXPORT fmi3Instance NAME(fmi3InstantiateCoSimulation)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3Boolean event_mode, fmi3Boolean early_return, const fmi3ValueReference required[], size_t required_count,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger, fmi3IntermediateUpdateCallback intermediate)
{
    instance *i = NULL;
    (void)name;
    (void)resources;
    (void)visible;
    (void)event_mode;
    (void)early_return;
    (void)required;
    (void)required_count;
    (void)intermediate;
    if (token == NULL || strcmp(token, MODEL_TOKEN) != 0) {
        return NULL;
    }
    i = (instance *)calloc(1, sizeof *i);
    if (i == NULL) {
        return NULL;
    }
    i->logger = logger;
    i->environment = environment;
    i->logging = logging;
    component_reset(&i->component);
    return i;
}

EXPORT void NAME(fmi3FreeInstance)(fmi3Instance c)
{
    free(c);
}

EXPORT fmi3Status NAME(fmi3EnterInitializationMode)(fmi3Instance c, fmi3Boolean has_tolerance, fmi3Float64 tolerance,
                                                    fmi3Float64 start, fmi3Boolean has_stop, fmi3Float64 stop)
{
    (void)has_tolerance;
    (void)tolerance;
    (void)has_stop;
    (void)stop;
    ((instance *)c)->component.value[0] = start;
    return fmi3OK;
}

EXPORT fmi3Status NAME(fmi3ExitInitializationMode)(fmi3Instance c)
{
    return report((instance *)c, component_begin(&((instance *)c)->component));
}

EXPORT fmi3Status NAME(fmi3Terminate)(fmi3Instance c)
{
    (void)c;
    return fmi3OK;
}

EXPORT fmi3Status NAME(fmi3Reset)(fmi3Instance c)
{
    component_reset(&((instance *)c)->component);
    return fmi3OK;
}

EXPORT fmi3Status NAME(fmi3GetFloat64)(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float64 value[],
                                       size_t count)
{
    instance *i = (instance *)c;
    const char *problem = n == count ? NULL : "every variable has one value";
    size_t k;
    for (k = 0; k < n && problem == NULL; ++k) {
        problem = component_get(&i->component, r[k], &value[k]);
    }
    return report(i, problem);
}

EXPORT fmi3Status NAME(fmi3SetFloat64)(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                                       const fmi3Float64 value[], size_t count)
{
    instance *i = (instance *)c;
    const char *problem = n == count ? NULL : "every variable has one value";
    size_t k;
    for (k = 0; k < n && problem == NULL; ++k) {
        problem = component_set(&i->component, r[k], value[k]);
    }
    return report(i, problem);
}

/* All variables are of the type Float64. */
#define NO_VALUES(Type)                                                                                              \
    EXPORT fmi3Status NAME(fmi3Get##Type)(fmi3Instance c, const fmi3ValueReference r[], size_t n,                   \
                                          fmi3##Type value[], size_t count)                                         \
    {                                                                                                                \
        (void)r;                                                                                                     \
        (void)value;                                                                                                 \
        (void)count;                                                                                                 \
        return report((instance *)c, n == 0 ? NULL : "all variables are of the type Float64");                      \
    }                                                                                                                \
    EXPORT fmi3Status NAME(fmi3Set##Type)(fmi3Instance c, const fmi3ValueReference r[], size_t n,                   \
                                          const fmi3##Type value[], size_t count)                                   \
    {                                                                                                                \
        (void)r;                                                                                                     \
        (void)value;                                                                                                 \
        (void)count;                                                                                                 \
        return report((instance *)c, n == 0 ? NULL : "all variables are of the type Float64");                      \
    }

NO_VALUES(Float32)
NO_VALUES(Int8)
NO_VALUES(UInt8)
NO_VALUES(Int16)
NO_VALUES(UInt16)
NO_VALUES(Int32)
NO_VALUES(UInt32)
NO_VALUES(Int64)
NO_VALUES(UInt64)
NO_VALUES(Boolean)
NO_VALUES(String)

EXPORT fmi3Status NAME(fmi3GetBinary)(fmi3Instance c, const fmi3ValueReference r[], size_t n, size_t sizes[],
                                      fmi3Binary value[], size_t count)
{
    (void)r;
    (void)sizes;
    (void)value;
    (void)count;
    return report((instance *)c, n == 0 ? NULL : "all variables are of the type Float64");
}

EXPORT fmi3Status NAME(fmi3SetBinary)(fmi3Instance c, const fmi3ValueReference r[], size_t n, const size_t sizes[],
                                      const fmi3Binary value[], size_t count)
{
    (void)r;
    (void)sizes;
    (void)value;
    (void)count;
    return report((instance *)c, n == 0 ? NULL : "all variables are of the type Float64");
}

EXPORT fmi3Status NAME(fmi3GetFMUState)(fmi3Instance c, fmi3FMUState *state)
{
    return report((instance *)c, component_save(&((instance *)c)->component, state));
}

EXPORT fmi3Status NAME(fmi3SetFMUState)(fmi3Instance c, fmi3FMUState state)
{
    return report((instance *)c, component_restore(&((instance *)c)->component, state));
}

EXPORT fmi3Status NAME(fmi3FreeFMUState)(fmi3Instance c, fmi3FMUState *state)
{
    (void)c;
    component_forget(state);
    return fmi3OK;
}

EXPORT fmi3Status NAME(fmi3SerializedFMUStateSize)(fmi3Instance c, fmi3FMUState state, size_t *size)
{
    (void)c;
    (void)state;
    *size = sizeof(component);
    return fmi3OK;
}

EXPORT fmi3Status NAME(fmi3SerializeFMUState)(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size)
{
    return report((instance *)c, component_write(state, bytes, size));
}

EXPORT fmi3Status NAME(fmi3DeserializeFMUState)(fmi3Instance c, const fmi3Byte bytes[], size_t size,
                                                fmi3FMUState *state)
{
    return report((instance *)c, component_read(bytes, size, state));
}

EXPORT fmi3Status NAME(fmi3EnterStepMode)(fmi3Instance c)
{
    (void)c;
    return fmi3OK;
}

EXPORT fmi3Status NAME(fmi3GetOutputDerivatives)(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                                                 const fmi3Int32 orders[], fmi3Float64 value[], size_t count)
{
    (void)r;
    (void)orders;
    (void)value;
    (void)count;
    return report((instance *)c, n == 0 ? NULL : "derivatives of outputs are not provided");
}

EXPORT fmi3Status NAME(fmi3DoStep)(fmi3Instance c, fmi3Float64 time, fmi3Float64 step, fmi3Boolean no_return,
                                   fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early,
                                   fmi3Float64 *last_time)
{
    const fmi3Status status = report((instance *)c, component_step(&((instance *)c)->component, time, step));
    (void)no_return;
    *event = false;
    *terminate = false;
    *early = false;
    *last_time = ((instance *)c)->component.value[0];
    return status;
}
