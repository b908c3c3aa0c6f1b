
/* The LuGre model without bristle damping; memory: H, time and position of the previous sample. */
static double lugre(double m[3], double t, double q, double v, double presliding, double scale, double ratio,
                    double exponent)
{
    const double displacement = q - m[2];
    const double duration = t > m[1] ? t - m[1] : 0.0;
    const double g = level(mean_velocity(displacement, duration, v), scale, ratio, exponent);
    m[0] = relax(m[0], displacement, presliding, g);
    m[1] = t;
    m[2] = q;
    return m[0];
}
