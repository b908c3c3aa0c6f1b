/* The plugin interface of AURT in C: what a dynamic library with friction models or arm terms exports.
 *
 * A library defines one function,
 *
 *     AURT_EXPORT const aurt_declaration *aurt_plugin(void);
 *
 * that returns the numbers by which AURT recognises it and a table for each model. Models that are not in equation
 * (6)'s slots, or act on several joints, are arm terms. Rigid-body regressors cannot be in a library.
 *
 * Rules:
 *  - Every function returns AURT_OK, or AURT_FAILED with a message in the caller's buffer (see aurt_fail).
 *  - Strings are UTF-8 and end with NUL. Those in tables live as long as the process: libraries are never unloaded.
 *  - What `describe` points to lives until the next `describe` of the same instance, or its end.
 *  - `evaluate` and `initial_state` may run on one instance from several threads at once, also beside `describe`;
 *    `set_shape`, `describe` and `destroy` are never called twice at once. Evaluating changes no instance: what a
 *    model remembers is in the state that the caller keeps.
 *
 * The structs mirror `aurt_traits::abi` of the Rust crate aurt-traits. Licence: MIT OR Apache-2.0.
 */
#ifndef AURT_PLUGIN_H
#define AURT_PLUGIN_H

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define AURT_MAGIC UINT64_C(0x47554c5054525541) /* "AURTPLUG" */
#define AURT_ABI_MAJOR 1
#define AURT_ABI_MINOR 0

/* What functions return. */
#define AURT_OK 0
#define AURT_FAILED 1
#define AURT_PANICKED 2

/* aurt_model.slot */
#define AURT_COULOMB 0
#define AURT_HYSTERESIS 1
#define AURT_VISCOUS 2
#define AURT_ARM_TERM 3

/* aurt_shape.scale: whether a search steps by differences or by factors. */
#define AURT_LINEAR 0
#define AURT_LOGARITHMIC 1

/* aurt_description.invariants: what a model declares of each of its columns. The Coulomb slot asks for EVEN_IN_LOAD
 * and POSITIVE, the hysteresis slot for BOUNDED_BY_ONE, the viscous slot for ODD_IN_VELOCITY, CONTINUOUS_IN_VELOCITY
 * and SIGN_OF_VELOCITY. */
#define AURT_EVEN_IN_LOAD (1u << 0)           /* same value at tau_J and -tau_J */
#define AURT_POSITIVE (1u << 1)               /* never negative, and one column is > 0 everywhere */
#define AURT_BOUNDED_BY_ONE (1u << 2)         /* magnitude at most 1 */
#define AURT_ODD_IN_VELOCITY (1u << 3)        /* changes its sign with the velocity */
#define AURT_CONTINUOUS_IN_VELOCITY (1u << 4) /* no step at rest */
#define AURT_SIGN_OF_VELOCITY (1u << 5)       /* has the sign of the velocity, or is zero */
#define AURT_PASSIVE (1u << 6)                /* takes energy over any closed cycle */
#define AURT_RATE_INDEPENDENT (1u << 7)       /* depends on the path, not on its speed */
#define AURT_MEMORYLESS (1u << 8)             /* depends on the present sample alone */

#if defined(_WIN32)
#define AURT_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define AURT_EXPORT __attribute__((visibility("default")))
#else
#define AURT_EXPORT
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Where a failing function leaves its message. */
typedef struct aurt_error {
    char *message;
    size_t capacity;
} aurt_error;

/* A batch of a time series. Sample s of joint j is at [j * stride + s] (load_torque: [j * load_stride + s]; time_s: [s]
 * for all joints). A Coulomb, hysteresis or viscous model gets one joint. */
typedef struct aurt_series {
    size_t size; /* sizeof(aurt_series) in the host */
    size_t samples;
    size_t joints;
    size_t stride;
    size_t load_stride;
    const double *time_s;
    const double *position_rad;
    const double *velocity_rad_s;
    const double *acceleration_rad_s2;
    const double *load_torque;
} aurt_series;

/* A linear coefficient, one for each output column. */
typedef struct aurt_column {
    const char *name; /* unique within the model */
    const char *unit; /* for a robot whose torques are measured: "Nm", "Nm s/rad", "1" */
} aurt_column;

/* A parameter in which the model is not linear. */
typedef struct aurt_shape {
    const char *name; /* equal to the configuration key */
    const char *unit;
    double value;
    double lower;
    double upper;
    uint32_t scale; /* AURT_LINEAR or AURT_LOGARITHMIC */
    uint32_t reserved;
} aurt_shape;

/* What an instance tells of itself; comes filled with zeros. */
typedef struct aurt_description {
    size_t column_count;
    const aurt_column *columns;
    size_t shape_count;
    const aurt_shape *shapes;
    size_t state_len;
    uint32_t invariants;
    uint32_t is_load;         /* arm terms: 1 if the joints transmit the term's torque */
    size_t joint_count;       /* arm terms: the joints whose rows the term writes, ascending, from 0 */
    const size_t *joints;
    const uint8_t *acts_on;   /* arm terms: [i * column_count + k] is 0 where column k of the i-th joint is zero; may be NULL */
} aurt_description;

typedef struct aurt_model {
    uint32_t slot; /* AURT_COULOMB, AURT_HYSTERESIS, AURT_VISCOUS, AURT_ARM_TERM */
    uint32_t reserved;
    const char *name;     /* as `model = "..."` in an experiment spells it */
    const char *summary;  /* one line */
    const char *equation;
    const char *use_when;
    const char *source;
    const char *example;  /* a working configuration: { model = "...", ... } */

    /* Makes an instance from its keys: a JSON object of config_len bytes, without `model` (see aurt_json_number and
     * its siblings). A complaint begins with the key in backticks, so that it can be shown at its place. */
    int32_t (*create)(const struct aurt_model *model, const char *config, size_t config_len, void **instance,
                      aurt_error *error);
    void (*destroy)(void *instance);
    /* Fills the description. For an arm term robot_joints is the robot's number of joints, or 0 if that is not known
     * and only shapes, invariants and is_load are asked for; others ignore it. */
    int32_t (*describe)(void *instance, size_t robot_joints, aurt_description *description, aurt_error *error);
    /* Sets all shape parameters, in the order of the description; NULL if there are none. */
    int32_t (*set_shape)(void *instance, const double *values, size_t count, aurt_error *error);
    /* The state before the first sample (`first` holds that sample alone); NULL if it begins with zeros. */
    int32_t (*initial_state)(const void *instance, const aurt_series *first, double *state, size_t state_len,
                             aurt_error *error);
    /* Writes every column over the whole series and moves the state to its end. Sample s of column k goes to
     * out[k * out_stride + s]; for the i-th joint of an arm term to out[(i * column_count + k) * out_stride + s].
     * out_columns is the number of columns over all these joints. */
    int32_t (*evaluate)(const void *instance, const aurt_series *series, double *state, size_t state_len, double *out,
                        size_t out_columns, size_t out_stride, aurt_error *error);
} aurt_model;

typedef struct aurt_declaration {
    uint64_t magic;
    uint32_t abi_major;
    uint32_t abi_minor;
    uint32_t declaration_size;
    uint32_t model_size;
    uint32_t description_size;
    uint32_t series_size;
    const char *name;
    const char *version;
    size_t model_count;
    const aurt_model *models;
} aurt_declaration;

/* The declaration of a library of `count` models. */
#define AURT_DECLARATION(library_name, library_version, model_list, count)                                             \
    {                                                                                                                  \
        AURT_MAGIC, AURT_ABI_MAJOR, AURT_ABI_MINOR, sizeof(aurt_declaration), sizeof(aurt_model),                      \
            sizeof(aurt_description), sizeof(aurt_series), library_name, library_version, count, model_list            \
    }

AURT_EXPORT const aurt_declaration *aurt_plugin(void);

/* Leaves a message and returns AURT_FAILED: return aurt_fail(error, "`level` must be positive, is %g", level); */
static inline int32_t aurt_fail(aurt_error *error, const char *format, ...) {
    if (error && error->message && error->capacity > 0) {
        va_list values;
        va_start(values, format);
        vsnprintf(error->message, error->capacity, format, values);
        va_end(values);
    }
    return AURT_FAILED;
}

/* Reading the configuration. The host writes it, so it is well-formed: these functions find their way in it, no more.
 * Each returns AURT_OK and leaves *value alone if the key is not there; a value of another kind is a failure. */

static inline const char *aurt_json_space(const char *at, const char *end) {
    while (at < end && (*at == ' ' || *at == '\n' || *at == '\t' || *at == '\r')) at++;
    return at;
}

/* The end of the value that begins at `at`. */
static inline const char *aurt_json_skip(const char *at, const char *end) {
    int depth = 0, quoted = 0;
    for (; at < end; at++) {
        if (quoted) {
            if (*at == '\\' && at + 1 < end) at++;
            else if (*at == '"') quoted = 0;
        } else if (*at == '"') {
            quoted = 1;
        } else if (*at == '{' || *at == '[') {
            depth++;
        } else if (*at == '}' || *at == ']') {
            if (depth-- == 0) return at;
        } else if (*at == ',' && depth == 0) {
            return at;
        }
    }
    return at;
}

/* The next key of the object and its value: *at moves behind the value; 0 when there is none. */
static inline int aurt_json_next(const char **at, const char *end, const char **key, size_t *key_len,
                                 const char **value) {
    const char *p = aurt_json_space(*at, end);
    if (p < end && (*p == '{' || *p == ',')) p = aurt_json_space(p + 1, end);
    if (p >= end || *p != '"') return 0;
    *key = ++p;
    while (p < end && *p != '"') p += (*p == '\\') ? 2 : 1;
    *key_len = (size_t)(p - *key);
    p = aurt_json_space(p + 1, end);
    *value = aurt_json_space(p + 1, end); /* behind the colon */
    *at = aurt_json_skip(*value, end);
    return 1;
}

/* The value of a key, or NULL. */
static inline const char *aurt_json_find(const char *config, size_t config_len, const char *key) {
    const char *at = config, *end = config + config_len, *name, *value;
    size_t name_len;
    while (aurt_json_next(&at, end, &name, &name_len, &value))
        if (name_len == strlen(key) && memcmp(name, key, name_len) == 0) return value;
    return NULL;
}

/* Refuses keys other than those of the list, which ends with NULL. */
static inline int32_t aurt_json_only(const char *config, size_t config_len, const char *const *keys,
                                     aurt_error *error) {
    const char *at = config, *end = config + config_len, *name, *value;
    size_t name_len;
    while (aurt_json_next(&at, end, &name, &name_len, &value)) {
        const char *const *known = keys;
        while (*known && !(strlen(*known) == name_len && memcmp(*known, name, name_len) == 0)) known++;
        if (!*known) {
            char list[512] = "";
            for (known = keys; *known; known++) {
                size_t used = strlen(list);
                snprintf(list + used, sizeof list - used, "%s`%s`", known == keys ? ", expected " : ", ", *known);
            }
            return aurt_fail(error, "`%.*s`: unknown key%s", (int)name_len, name, *list ? list : ", it has no keys");
        }
    }
    return AURT_OK;
}

/* A number. */
static inline int32_t aurt_json_number(const char *config, size_t config_len, const char *key, double *value,
                                       aurt_error *error) {
    const char *at = aurt_json_find(config, config_len, key);
    if (!at) return AURT_OK;
    if (*at != '-' && (*at < '0' || *at > '9')) return aurt_fail(error, "`%s`: expected a number", key);
    *value = strtod(at, NULL);
    return AURT_OK;
}

/* A boolean, as 0 or 1. */
static inline int32_t aurt_json_boolean(const char *config, size_t config_len, const char *key, int *value,
                                        aurt_error *error) {
    const char *at = aurt_json_find(config, config_len, key);
    if (!at) return AURT_OK;
    if (*at != 't' && *at != 'f') return aurt_fail(error, "`%s`: expected true or false", key);
    *value = *at == 't';
    return AURT_OK;
}

/* A list of at most `capacity` numbers; *count becomes their number. */
static inline int32_t aurt_json_numbers(const char *config, size_t config_len, const char *key, double *values,
                                        size_t capacity, size_t *count, aurt_error *error) {
    const char *at = aurt_json_find(config, config_len, key), *end = config + config_len;
    size_t found = 0;
    if (!at) return AURT_OK;
    if (*at != '[') return aurt_fail(error, "`%s`: expected a list of numbers", key);
    for (at = aurt_json_space(at + 1, end); at < end && *at != ']'; found++) {
        if (*at != '-' && (*at < '0' || *at > '9')) return aurt_fail(error, "`%s`: expected a list of numbers", key);
        if (found == capacity) return aurt_fail(error, "`%s`: has more than %zu numbers", key, capacity);
        values[found] = strtod(at, NULL);
        at = aurt_json_space(aurt_json_skip(at, end), end);
        if (at < end && *at == ',') at = aurt_json_space(at + 1, end);
    }
    *count = found;
    return AURT_OK;
}

/* A string, as it stands in JSON (escapes are not resolved), cut to fit. */
static inline int32_t aurt_json_string(const char *config, size_t config_len, const char *key, char *value,
                                       size_t capacity, aurt_error *error) {
    const char *at = aurt_json_find(config, config_len, key), *end = config + config_len;
    size_t len;
    if (!at || capacity == 0) return AURT_OK;
    if (*at != '"') return aurt_fail(error, "`%s`: expected a string", key);
    len = (size_t)(aurt_json_skip(at, end) - at);
    while (len > 1 && at[len - 1] != '"') len--; /* space before the comma */
    len -= 2;
    if (len >= capacity) len = capacity - 1;
    memcpy(value, at + 1, len);
    value[len] = '\0';
    return AURT_OK;
}

#ifdef __cplusplus
}
#endif

#endif
