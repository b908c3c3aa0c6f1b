
/* The Stribeck curve relative to break-away, r + (1 - r) exp(-|v/v_S|^d). */
static double level(double v, double scale, double ratio, double exponent)
{
    const double x = fabs(v / scale);
    double power = x;
    if (exponent == 2.0) {
        power = x * x;
    } else if (exponent != 1.0) {
        power = pow(x, exponent);
    }
    return ratio + (1.0 - ratio) * exp(-power);
}
