
/* ln(1 + t/T). */
static double warmth(double t, double warming_time)
{
    return t > 0.0 ? log1p(t / warming_time) : 0.0;
}
