/* Functions of FMI 3.0 for what this model does not have: other interface types, events, clocks, derivatives. */
#include "fmi3.h"

typedef void (*callback)(void);

EXPORT fmi3Instance NAME(fmi3InstantiateModelExchange)(fmi3String name, fmi3String token, fmi3String resources,
                                                       fmi3Boolean visible, fmi3Boolean logging,
                                                       fmi3InstanceEnvironment environment,
                                                       fmi3LogMessageCallback logger)
{
    (void)name;
    (void)token;
    (void)resources;
    (void)visible;
    (void)logging;
    (void)environment;
    (void)logger;
    return NULL;
}

EXPORT fmi3Instance NAME(fmi3InstantiateScheduledExecution)(fmi3String name, fmi3String token, fmi3String resources,
                                                            fmi3Boolean visible, fmi3Boolean logging,
                                                            fmi3InstanceEnvironment environment,
                                                            fmi3LogMessageCallback logger, callback clock,
                                                            callback lock, callback unlock)
{
    (void)name;
    (void)token;
    (void)resources;
    (void)visible;
    (void)logging;
    (void)environment;
    (void)logger;
    (void)clock;
    (void)lock;
    (void)unlock;
    return NULL;
}

/* Modes that the model does not have. */
#define NO_MODE(name)                                                                                                \
    EXPORT fmi3Status NAME(name)(fmi3Instance c)                                                                    \
    {                                                                                                                \
        (void)c;                                                                                                     \
        return fmi3Error;                                                                                            \
    }

NO_MODE(fmi3EnterEventMode)
NO_MODE(fmi3EnterConfigurationMode)
NO_MODE(fmi3ExitConfigurationMode)
NO_MODE(fmi3EvaluateDiscreteStates)

EXPORT fmi3Status NAME(fmi3UpdateDiscreteStates)(fmi3Instance c, fmi3Boolean *again, fmi3Boolean *terminate,
                                                 fmi3Boolean *nominals, fmi3Boolean *values, fmi3Boolean *event,
                                                 fmi3Float64 *event_time)
{
    (void)c;
    *again = false;
    *terminate = false;
    *nominals = false;
    *values = false;
    *event = false;
    *event_time = 0.0;
    return fmi3Error;
}

/* Clocks, of which there are none. */
EXPORT fmi3Status NAME(fmi3GetClock)(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Clock value[])
{
    (void)c;
    (void)r;
    (void)value;
    return n == 0 ? fmi3OK : fmi3Error;
}

EXPORT fmi3Status NAME(fmi3SetClock)(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Clock value[])
{
    (void)c;
    (void)r;
    (void)value;
    return n == 0 ? fmi3OK : fmi3Error;
}

EXPORT fmi3Status NAME(fmi3GetIntervalDecimal)(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                                               fmi3Float64 value[], int qualifier[])
{
    (void)c;
    (void)r;
    (void)value;
    (void)qualifier;
    return n == 0 ? fmi3OK : fmi3Error;
}

EXPORT fmi3Status NAME(fmi3GetIntervalFraction)(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                                                fmi3UInt64 counter[], fmi3UInt64 resolution[], int qualifier[])
{
    (void)c;
    (void)r;
    (void)counter;
    (void)resolution;
    (void)qualifier;
    return n == 0 ? fmi3OK : fmi3Error;
}

/* Shifts and intervals of clocks as decimals and as fractions. */
#define NO_DECIMAL(name, constant)                                                                                   \
    EXPORT fmi3Status NAME(name)(fmi3Instance c, const fmi3ValueReference r[], size_t n, constant fmi3Float64 v[])  \
    {                                                                                                                \
        (void)c;                                                                                                     \
        (void)r;                                                                                                     \
        (void)v;                                                                                                     \
        return n == 0 ? fmi3OK : fmi3Error;                                                                          \
    }
#define NO_FRACTION(name, constant)                                                                                  \
    EXPORT fmi3Status NAME(name)(fmi3Instance c, const fmi3ValueReference r[], size_t n, constant fmi3UInt64 v[],   \
                                 constant fmi3UInt64 w[])                                                           \
    {                                                                                                                \
        (void)c;                                                                                                     \
        (void)r;                                                                                                     \
        (void)v;                                                                                                     \
        (void)w;                                                                                                     \
        return n == 0 ? fmi3OK : fmi3Error;                                                                          \
    }

#define CHANGING
NO_DECIMAL(fmi3GetShiftDecimal, CHANGING)
NO_DECIMAL(fmi3SetShiftDecimal, const)
NO_DECIMAL(fmi3SetIntervalDecimal, const)
NO_FRACTION(fmi3GetShiftFraction, CHANGING)
NO_FRACTION(fmi3SetShiftFraction, const)
NO_FRACTION(fmi3SetIntervalFraction, const)

/* Derivatives and dependencies. */
#define NO_DERIVATIVE(name)                                                                                          \
    EXPORT fmi3Status NAME(name)(fmi3Instance c, const fmi3ValueReference unknown[], size_t n,                      \
                                 const fmi3ValueReference known[], size_t m, const fmi3Float64 seed[], size_t k,    \
                                 fmi3Float64 value[], size_t l)                                                     \
    {                                                                                                                \
        (void)c;                                                                                                     \
        (void)unknown;                                                                                               \
        (void)n;                                                                                                     \
        (void)known;                                                                                                 \
        (void)m;                                                                                                     \
        (void)seed;                                                                                                  \
        (void)k;                                                                                                     \
        (void)value;                                                                                                 \
        (void)l;                                                                                                     \
        return fmi3Error;                                                                                            \
    }

NO_DERIVATIVE(fmi3GetDirectionalDerivative)
NO_DERIVATIVE(fmi3GetAdjointDerivative)

EXPORT fmi3Status NAME(fmi3GetNumberOfVariableDependencies)(fmi3Instance c, fmi3ValueReference r, size_t *n)
{
    (void)c;
    (void)r;
    *n = 0;
    return fmi3Error;
}

EXPORT fmi3Status NAME(fmi3GetVariableDependencies)(fmi3Instance c, fmi3ValueReference r, size_t of[],
                                                    fmi3ValueReference on[], size_t element[], int kind[], size_t n)
{
    (void)c;
    (void)r;
    (void)of;
    (void)on;
    (void)element;
    (void)kind;
    (void)n;
    return fmi3Error;
}

/* Model exchange and scheduled execution, whose functions some importers look for in every FMU. */
NO_MODE(fmi3EnterContinuousTimeMode)

EXPORT fmi3Status NAME(fmi3SetTime)(fmi3Instance c, fmi3Float64 time)
{
    (void)c;
    (void)time;
    return fmi3Error;
}

EXPORT fmi3Status NAME(fmi3CompletedIntegratorStep)(fmi3Instance c, fmi3Boolean no_return, fmi3Boolean *event,
                                                    fmi3Boolean *terminate)
{
    (void)c;
    (void)no_return;
    *event = false;
    *terminate = false;
    return fmi3Error;
}

#define NO_VECTOR(name, constant)                                                                                    \
    EXPORT fmi3Status NAME(name)(fmi3Instance c, constant fmi3Float64 value[], size_t n)                            \
    {                                                                                                                \
        (void)c;                                                                                                     \
        (void)value;                                                                                                 \
        return n == 0 ? fmi3OK : fmi3Error;                                                                          \
    }
#define NONE_OF(name)                                                                                                \
    EXPORT fmi3Status NAME(name)(fmi3Instance c, size_t *n)                                                         \
    {                                                                                                                \
        (void)c;                                                                                                     \
        *n = 0;                                                                                                      \
        return fmi3OK;                                                                                               \
    }

NO_VECTOR(fmi3SetContinuousStates, const)
NO_VECTOR(fmi3GetContinuousStates, CHANGING)
NO_VECTOR(fmi3GetContinuousStateDerivatives, CHANGING)
NO_VECTOR(fmi3GetEventIndicators, CHANGING)
NO_VECTOR(fmi3GetNominalsOfContinuousStates, CHANGING)
NONE_OF(fmi3GetNumberOfContinuousStates)
NONE_OF(fmi3GetNumberOfEventIndicators)

EXPORT fmi3Status NAME(fmi3ActivateModelPartition)(fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time)
{
    (void)c;
    (void)clock;
    (void)time;
    return fmi3Error;
}
