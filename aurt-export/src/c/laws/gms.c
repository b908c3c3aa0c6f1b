
/* Moves one element, its force m[0] and the direction m[1] in which it slips, over a step at the level g. */
static void gms_element(double m[2], double threshold, double displacement, double duration, double g,
                        double attraction)
{
    const double distance = fabs(displacement);
    const double direction = displacement < 0.0 ? -1.0 : 1.0;
    double along = m[0] * direction;
    double slipping = duration;
    int sticks = 0;
    if (distance == 0.0) {
        m[1] = 0.0;
        return;
    }
    if (m[1] != direction) {
        const double to_slip = (g - along) * threshold;
        if (to_slip >= distance) {
            sticks = 1;
        } else {
            if (to_slip > 0.0) {
                along = g;
                slipping *= 1.0 - to_slip / distance;
            }
            m[1] = direction;
        }
    }
    if (sticks != 0) {
        m[0] = (along + distance / threshold) * direction;
        m[1] = 0.0;
        return;
    }
    if (along != g) {
        along = g + (along - g) * exp(-slipping * attraction / g);
    }
    if (along > 1.0) {
        along = 1.0;
    } else if (along < -1.0) {
        along = -1.0;
    }
    m[0] = along * direction;
}

/* Generalised Maxwell-slip elements; memory: time and position of the previous sample, two numbers for each element. */
static void gms(double m[], double t, double q, double v, const double threshold[], int count, double scale,
                double ratio, double exponent, double attraction, double h[])
{
    const double displacement = q - m[1];
    const double duration = t > m[0] ? t - m[0] : 0.0;
    const double g = level(mean_velocity(displacement, duration, v), scale, ratio, exponent);
    int i;
    m[0] = t;
    m[1] = q;
    for (i = 0; i < count; ++i) {
        gms_element(&m[2 + 2 * i], threshold[i], displacement, duration, g, attraction);
        h[i] = m[2 + 2 * i];
    }
}
