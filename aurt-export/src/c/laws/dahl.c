
/* Dahl's model; memory: H and the previous position. */
static double dahl(double m[2], double q, double presliding)
{
    m[0] = relax(m[0], q - m[1], presliding, 1.0);
    m[1] = q;
    return m[0];
}
