
/* The mean velocity of a step; the measured one where time does not advance. */
static double mean_velocity(double displacement, double duration, double v)
{
    return duration > 0.0 ? displacement / duration : v;
}
