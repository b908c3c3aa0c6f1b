
/* The slope of the force along the motion against the distance in units of the presliding distance. */
static double bouc_wen_slope(double along, double exponent, double beta)
{
    const double size = exponent == 1.0 ? fabs(along) : pow(fabs(along), exponent);
    return along >= 0.0 ? 1.0 - size : 1.0 + (2.0 * beta - 1.0) * size;
}

/* The distance in which a small opposing force falls to zero: three-point Gauss-Legendre quadrature of 1/slope. */
static double bouc_wen_to_zero(double against, double exponent, double beta)
{
    const double node = sqrt(0.6) / 2.0;
    const double a = 1.0 / bouc_wen_slope(-against * (0.5 - node), exponent, beta);
    const double b = 1.0 / bouc_wen_slope(-against * 0.5, exponent, beta);
    const double c = 1.0 / bouc_wen_slope(-against * (0.5 + node), exponent, beta);
    return against * (5.0 * a + 8.0 * b + 5.0 * c) / 18.0;
}

/* The Bouc-Wen model, integrated along the path; memory: H and the previous position. */
static double bouc_wen(double m[2], double q, double presliding, double exponent, double beta)
{
    const double longest = 1.0 / 16.0;
    const double displacement = q - m[1];
    const double direction = displacement < 0.0 ? -1.0 : 1.0;
    double along = m[0] * direction;
    double distance = fabs(displacement) / presliding;
    while (distance > 0.0 && along < 1.0 - 1e-12) {
        double step = distance < longest ? distance : longest;
        int crossed = 0;
        if (along < 0.0 && -along <= 2.0 * longest) {
            const double to_zero = bouc_wen_to_zero(-along, exponent, beta);
            if (to_zero <= distance) {
                along = 0.0;
                distance -= to_zero;
                crossed = 1;
            } else {
                step = distance;
            }
        }
        if (crossed == 0) {
            const double k1 = bouc_wen_slope(along, exponent, beta);
            const double k2 = bouc_wen_slope(along + 0.5 * step * k1, exponent, beta);
            const double k3 = bouc_wen_slope(along + 0.5 * step * k2, exponent, beta);
            const double k4 = bouc_wen_slope(along + step * k3, exponent, beta);
            along += step * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
            along = along > 1.0 ? 1.0 : along;
            distance -= step;
        }
    }
    m[0] = along * direction;
    m[1] = q;
    return m[0];
}
