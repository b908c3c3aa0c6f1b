#include "machine.h"
#include <stdio.h>
#include <time.h>
#define TIME(call) { double sum = 0.0, best = 1e9; int round, k; for (round = 0; round < 300; ++round) { \
    clock_t start = clock(); double took; for (k = 0; k < 1000; ++k) { q[0] = 1e-3 * k; call; sum += out[0]; } \
    took = 1e6 * (double)(clock() - start) / CLOCKS_PER_SEC; best = took < best ? took : best; } \
    printf("%.1f\n", best); if (sum == 0.5) return 1; }
int main(void)
{
    static double out[1000];
    double q[] = {0.1, -0.7, 1.1, 0.3, -0.4, 0.2}, v[] = {0.5, -0.3, 0.4, 0.6, -0.2, 0.1}, a[] = {1, 2, -1, 3, -2, 1};
    TIME(machine_torque(q, v, a, out)) TIME(machine_rigid_body_torque(q, v, a, out))
    TIME(machine_mass_matrix(q, out)) TIME(machine_regressor(q, v, a, out))
    return 0;
}
