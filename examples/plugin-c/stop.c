/* Presliding as a spring that slips at a threshold: H(z) = z, where z follows q / d and is held between -1 and 1.
 * The same model as `stop` of the Rust example, under another name. */
#include "aurt_plugin.h"

typedef struct {
    aurt_shape distance; /* d */
} stop;

static const char *const keys[] = {"distance_rad", NULL};
static const aurt_column columns[] = {{"z", "1"}};

static int32_t check(double distance_rad, aurt_error *error) {
    if (!(distance_rad > 0.0)) return aurt_fail(error, "`distance_rad` must be positive, is %g", distance_rad);
    return AURT_OK;
}

static int32_t create(const aurt_model *model, const char *config, size_t len, void **instance, aurt_error *error) {
    stop made = {{"distance_rad", "rad", 0.01, 1e-6, 1.0, AURT_LOGARITHMIC, 0}};
    stop *kept;
    (void)model;
    if (aurt_json_only(config, len, keys, error) != AURT_OK) return AURT_FAILED;
    if (aurt_json_number(config, len, "distance_rad", &made.distance.value, error) != AURT_OK) return AURT_FAILED;
    if (check(made.distance.value, error) != AURT_OK) return AURT_FAILED;
    kept = malloc(sizeof *kept);
    if (!kept) return aurt_fail(error, "out of memory");
    *kept = made;
    *instance = kept;
    return AURT_OK;
}

static void destroy(void *instance) { free(instance); }

static int32_t describe(void *instance, size_t robot_joints, aurt_description *description, aurt_error *error) {
    (void)robot_joints;
    (void)error;
    description->column_count = 1;
    description->columns = columns;
    description->shape_count = 1;
    description->shapes = &((stop *)instance)->distance;
    description->state_len = 2;
    description->invariants = AURT_BOUNDED_BY_ONE | AURT_ODD_IN_VELOCITY | AURT_PASSIVE | AURT_RATE_INDEPENDENT;
    return AURT_OK;
}

static int32_t set_shape(void *instance, const double *values, size_t count, aurt_error *error) {
    (void)count;
    if (check(values[0], error) != AURT_OK) return AURT_FAILED;
    ((stop *)instance)->distance.value = values[0];
    return AURT_OK;
}

/* The deflection z of a relaxed spring, and the position that the next sample starts from. */
static int32_t initial_state(const void *instance, const aurt_series *first, double *state, size_t state_len,
                             aurt_error *error) {
    (void)instance;
    (void)state_len;
    (void)error;
    state[0] = 0.0;
    state[1] = first->position_rad[0];
    return AURT_OK;
}

static int32_t evaluate(const void *instance, const aurt_series *series, double *state, size_t state_len, double *out,
                        size_t out_columns, size_t out_stride, aurt_error *error) {
    const double distance = ((const stop *)instance)->distance.value;
    size_t s;
    (void)state_len;
    (void)out_columns;
    (void)out_stride; /* there is one column */
    (void)error;
    for (s = 0; s < series->samples; s++) {
        double z = state[0] + (series->position_rad[s] - state[1]) / distance;
        state[0] = z < -1.0 ? -1.0 : z > 1.0 ? 1.0 : z;
        state[1] = series->position_rad[s];
        out[s] = state[0];
    }
    return AURT_OK;
}

static const aurt_model models[] = {{
    AURT_HYSTERESIS,
    0,
    "stop_c",
    "presliding as one spring that slips at a threshold",
    "H = z, dz = dq / d within -1 <= z <= 1",
    "after a reversal, torque rises over a distance and not at once",
    "A. Visintin, Differential Models of Hysteresis, Springer 1994, chapter III",
    "{ model = \"stop_c\", distance_rad = 0.01 }",
    create,
    destroy,
    describe,
    set_shape,
    initial_state,
    evaluate,
}};

static const aurt_declaration declaration = AURT_DECLARATION("plugin-c", "1.0.0", models, 1);

const aurt_declaration *aurt_plugin(void) { return &declaration; }
