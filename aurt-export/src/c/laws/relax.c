
/* The solution of dH/dq = (1 - H s/g)/p after the displacement dq, s its sign; within -1 and 1. */
static double relax(double h, double dq, double presliding, double level)
{
    const double share = -expm1(-fabs(dq) / (presliding * level));
    const double force = h + (copysign(level, dq) - h) * share;
    double within = force;
    if (force > 1.0) {
        within = 1.0;
    } else if (force < -1.0) {
        within = -1.0;
    }
    return within;
}
