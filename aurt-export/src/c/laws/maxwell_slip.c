
/* Maxwell-slip elements; memory: the position of each anchor. */
static void maxwell_slip(double anchor[], double q, const double threshold[], int count, double h[])
{
    int i;
    for (i = 0; i < count; ++i) {
        double force = 0.0;
        if (anchor[i] < q - threshold[i]) {
            anchor[i] = q - threshold[i];
        }
        if (anchor[i] > q + threshold[i]) {
            anchor[i] = q + threshold[i];
        }
        force = (q - anchor[i]) / threshold[i];
        if (force > 1.0) {
            force = 1.0;
        } else if (force < -1.0) {
            force = -1.0;
        }
        h[i] = force;
    }
}
