/* The largest size in a table. */
static double largest_of(const double *stored, int length)
{
    double size = 0.0;
    int k;
    for (k = 0; k < length; ++k) {
        size = fabs(stored[k]) > size ? fabs(stored[k]) : size;
    }
    return size;
}

/* The largest difference of a column, relative to its largest stored value or a thousandth of the table's, in which columns
   that are zero but for rounding count; -1 if a value is not a number. */
static double worst(const double *stored, const double *found, int rows, int width, int column)
{
    double size = 1e-3 * largest_of(stored, rows * width);
    double difference = 0.0;
    int state;
    for (state = 0; state < rows; ++state) {
        const double s = stored[state * width + column];
        const double d = fabs(found[state * width + column] - s);
        if (d != d) {
            return -1.0;
        }
        size = fabs(s) > size ? fabs(s) : size;
        difference = d > difference ? d : difference;
    }
    return difference > 0.0 ? difference / size : 0.0;
}

static int compare(const char *what, const double *stored, const double *found, int rows, int width)
{
    double largest = 0.0;
    int passed = 1;
    int column;
    for (column = 0; column < width; ++column) {
        const double w = worst(stored, found, rows, width, column);
        if (!(w >= 0.0 && w <= @TOLERANCE@)) {
            passed = 0;
            printf("%s[%d]: differs by %.3g of the largest value\n", what, column, w);
        }
        largest = w > largest ? w : largest;
    }
    printf("%-18s %s, largest relative difference %.3g\n", what, passed ? "passed" : "FAILED", largest);
    return passed;
}

/* Takes all samples one after the other from a state at its beginning. */
static void take_steps(double found[STATES][JOINTS])
{
    @NAME@_state remembered;
    int state;
    @NAME@_reset(&remembered);
    for (state = 0; state < STATES; ++state) {
        @NAME@_step(&remembered, t[state][0], q[state], qd[state], qdd[state], found[state]);
    }
}

int main(void)
{
    static double full[STATES][JOINTS];
    static double again[STATES][JOINTS];
    static double bodies[STATES][JOINTS];
    static double weight[STATES][JOINTS];
    static double matrix[STATES][JOINTS * JOINTS];
    static double columns[WITH_REGRESSOR][ENTRIES];
    int passed = 1;
    int same = 1;
    int state;
    for (state = 0; state < STATES; ++state) {
        @NAME@_rigid_body_torque(q[state], qd[state], qdd[state], bodies[state]);
        @NAME@_gravity(q[state], weight[state]);
        @NAME@_mass_matrix(q[state], matrix[state]);
    }
    for (state = 0; state < WITH_REGRESSOR; ++state) {
        @NAME@_regressor(q[state], qd[state], qdd[state], columns[state]);
    }
    take_steps(full);
    take_steps(again);
    same = memcmp(full, again, sizeof full) == 0;
    passed &= same;
    passed &= compare("step", &torque[0][0], &full[0][0], STATES, JOINTS);
    printf("%-18s %s\n", "step, once more", same ? "passed, the same bits" : "FAILED, other bits");
#if @MEMORYLESS@
    for (state = 0; state < STATES; ++state) {
        int joint;
        @NAME@_torque(q[state], qd[state], qdd[state], full[state]);
        @NAME@_friction_torque(q[state], qd[state], qdd[state], again[state]);
        for (joint = 0; joint < JOINTS; ++joint) {
            again[state][joint] += bodies[state][joint];
        }
    }
    passed &= compare("torque", &torque[0][0], &full[0][0], STATES, JOINTS);
    passed &= compare("torque by parts", &torque[0][0], &again[0][0], STATES, JOINTS);
#endif
    passed &= compare("rigid_body_torque", &rigid[0][0], &bodies[0][0], STATES, JOINTS);
    passed &= compare("gravity", &gravity[0][0], &weight[0][0], STATES, JOINTS);
    passed &= compare("mass_matrix", &mass[0][0], &matrix[0][0], STATES, JOINTS * JOINTS);
    passed &= compare("regressor", &regressor[0][0], &columns[0][0], WITH_REGRESSOR, ENTRIES);
    return passed ? 0 : 1;
}
