/* Drives an FMU of FMI 2.0 that is linked to it: reads lines of inputs, takes a step after each, writes all outputs. In the
   middle it goes back twice, from a state and from its bytes, and must come to the same bits. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2.h"
#include "model.h"

fmi2Component fmi2Instantiate(fmi2String, fmi2Type, fmi2String, fmi2String, const fmi2CallbackFunctions *, fmi2Boolean,
                              fmi2Boolean);
void fmi2FreeInstance(fmi2Component);
fmi2Status fmi2SetupExperiment(fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real);
fmi2Status fmi2EnterInitializationMode(fmi2Component);
fmi2Status fmi2ExitInitializationMode(fmi2Component);
fmi2Status fmi2GetReal(fmi2Component, const fmi2ValueReference[], size_t, fmi2Real[]);
fmi2Status fmi2SetReal(fmi2Component, const fmi2ValueReference[], size_t, const fmi2Real[]);
fmi2Status fmi2DoStep(fmi2Component, fmi2Real, fmi2Real, fmi2Boolean);
fmi2Status fmi2GetFMUstate(fmi2Component, fmi2FMUstate *);
fmi2Status fmi2SetFMUstate(fmi2Component, fmi2FMUstate);
fmi2Status fmi2FreeFMUstate(fmi2Component, fmi2FMUstate *);
fmi2Status fmi2SerializedFMUstateSize(fmi2Component, fmi2FMUstate, size_t *);
fmi2Status fmi2SerializeFMUstate(fmi2Component, fmi2FMUstate, fmi2Byte[], size_t);
fmi2Status fmi2DeSerializeFMUstate(fmi2Component, const fmi2Byte[], size_t, fmi2FMUstate *);

#define INPUTS (MODEL_MOVES ? 2 * MODEL_JOINTS : 3 * MODEL_JOINTS)
#define OUTPUTS (MODEL_MOVES ? 3 * MODEL_JOINTS : MODEL_JOINTS)

static void logged(fmi2ComponentEnvironment e, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String message, ...)
{
    va_list more;
    (void)e;
    (void)status;
    va_start(more, message);
    (void)fprintf(stderr, "%s: %s: ", name, category);
    (void)vfprintf(stderr, message, more);
    (void)fprintf(stderr, "\n");
    va_end(more);
}

static void must(int good, const char *what)
{
    if (!good) {
        (void)fprintf(stderr, "failed: %s\n", what);
        exit(2);
    }
}

static void step(fmi2Component c, double time, double length, const double in[], double out[])
{
    fmi2ValueReference r[3 * MODEL_JOINTS];
    int k;
    for (k = 0; k < INPUTS; ++k) {
        r[k] = (fmi2ValueReference)(1 + k);
    }
    must(fmi2SetReal(c, r, INPUTS, in) == fmi2OK, "set");
    must(fmi2DoStep(c, time, length, 1) == fmi2OK, "step");
    for (k = 0; k < OUTPUTS; ++k) {
        r[k] = (fmi2ValueReference)(1 + INPUTS + k);
    }
    must(fmi2GetReal(c, r, OUTPUTS, out) == fmi2OK, "get");
}

int main(int argc, char **argv)
{
    const fmi2CallbackFunctions functions = {logged, calloc, free, NULL, NULL};
    fmi2Component c = fmi2Instantiate("driven", fmi2CoSimulation, MODEL_TOKEN, NULL, &functions, 0, 1);
    const double length = argc > 1 ? atof(argv[1]) : 0.01;
    double in[3 * MODEL_JOINTS];
    double out[3 * MODEL_JOINTS];
    double again[3 * MODEL_JOINTS];
    double value = 0.0;
    fmi2ValueReference output = (fmi2ValueReference)(1 + INPUTS);
    int line;
    int k;
    must(c != NULL, "instantiate");
    must(fmi2Instantiate("other", fmi2CoSimulation, "{other}", NULL, &functions, 0, 0) == NULL, "another token");
    must(fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0) == fmi2OK, "setup");
    must(fmi2EnterInitializationMode(c) == fmi2OK, "enter");
    for (k = 2; k < argc; ++k) {
        /* reference=value */
        char *equals = strchr(argv[k], '=');
        const fmi2ValueReference r = (fmi2ValueReference)atoi(argv[k]);
        must(equals != NULL, "an argument");
        value = atof(equals + 1);
        must(fmi2SetReal(c, &r, 1, &value) == fmi2OK, "set a start value");
    }
    must(fmi2ExitInitializationMode(c) == fmi2OK, "begin");
    must(fmi2SetReal(c, &output, 1, &value) == fmi2Error, "an output cannot be set");
    must(fmi2DoStep(c, 5.0, length, 1) == fmi2Error, "a step from another time");
    for (line = 0;; ++line) {
        int read = 0;
        for (k = 0; k < INPUTS; ++k) {
            read += scanf("%lf", &in[k]) == 1;
        }
        if (read != INPUTS) {
            break;
        }
        if (line % 50 == 25) {
            fmi2FMUstate state = NULL;
            fmi2FMUstate copy = NULL;
            size_t size = 0;
            fmi2Byte *bytes;
            must(fmi2GetFMUstate(c, &state) == fmi2OK, "get state");
            must(fmi2SerializedFMUstateSize(c, state, &size) == fmi2OK, "size");
            bytes = (fmi2Byte *)malloc(size);
            must(bytes != NULL && fmi2SerializeFMUstate(c, state, bytes, size) == fmi2OK, "serialise");
            step(c, line * length, 0.5 * length, in, out);
            step(c, (line + 0.5) * length, 0.5 * length, in, again);
            must(fmi2SetFMUstate(c, state) == fmi2OK, "go back");
            step(c, line * length, length, in, out);
            must(fmi2DeSerializeFMUstate(c, bytes, size, &copy) == fmi2OK, "deserialise");
            must(fmi2SetFMUstate(c, copy) == fmi2OK, "go back by bytes");
            step(c, line * length, length, in, again);
            must(memcmp(out, again, OUTPUTS * sizeof(double)) == 0, "the same bits");
            must(fmi2FreeFMUstate(c, &state) == fmi2OK && fmi2FreeFMUstate(c, &copy) == fmi2OK, "free");
            free(bytes);
        } else {
            step(c, line * length, length, in, out);
        }
        for (k = 0; k < OUTPUTS; ++k) {
            printf("%.17g%c", out[k], k + 1 < OUTPUTS ? ' ' : '\n');
        }
    }
    fmi2FreeInstance(c);
    return 0;
}
