/* The equations of motion of a chain of three masses, in plain C: classical Runge-Kutta at a fixed step, as one would first write it.
 *
 *   cc -O3 -march=native -ffast-math [-DTURNED] steps.c -o steps -lm && steps < numbers
 *
 * With TURNED the direction of the unbalance is turned by a constant factor instead of being computed anew, as Whirl does it.
 * Reads the number of steps, their length, the speed and the control bearing's mass (from 0), then for each mass: mass, damping, cross
 * damping, bearing and seal stiffness, eccentricity, clearance and the gains on displacement and velocity (re and im), then two shafts.
 * Prints nanoseconds a step and the place of the first mass at the end.
 */
#include <math.h>
#include <stdio.h>
#include <time.h>

#define N 3

static double mass[N], zeta[N], zetaq[N], bearing[N], seal[N], unbalance[N], clearance[N], gains[N][4], shaft[N - 1], speed;
static int control;

static void acceleration(double cosine, double sine, const double x[4 * N], double slope[4 * N])
{
    const double *y = x, *z = x + N, *vy = x + 2 * N, *vz = x + 3 * N;
    double *ay = slope + 2 * N, *az = slope + 3 * N;
    double uy = 0.0, uz = 0.0;
    for (int i = 0; i < 2 * N; i++)
        slope[i] = x[2 * N + i];
    for (int i = 0; i < N; i++) {
        double r2 = y[i] * y[i] + z[i] * z[i];
        double s = r2 > clearance[i] * clearance[i] ? 1.0 - clearance[i] / sqrt(r2) : 0.0;
        double k = (seal[i] + bearing[i] * s) / mass[i];
        ay[i] = -2.0 * zeta[i] * vy[i] - 2.0 * zetaq[i] * vz[i] - zeta[i] * speed * z[i] - k * y[i] + unbalance[i] * speed * speed * cosine;
        az[i] = -2.0 * zeta[i] * vz[i] + 2.0 * zetaq[i] * vy[i] + zeta[i] * speed * y[i] - k * z[i] + unbalance[i] * speed * speed * sine;
        uy -= gains[i][0] * y[i] - gains[i][1] * z[i] + gains[i][2] * vy[i] - gains[i][3] * vz[i];
        uz -= gains[i][0] * z[i] + gains[i][1] * y[i] + gains[i][2] * vz[i] + gains[i][3] * vy[i];
    }
    for (int i = 0; i + 1 < N; i++) {
        double fy = shaft[i] * (y[i + 1] - y[i]), fz = shaft[i] * (z[i + 1] - z[i]);
        ay[i] += fy / mass[i];
        az[i] += fz / mass[i];
        ay[i + 1] -= fy / mass[i + 1];
        az[i + 1] -= fz / mass[i + 1];
    }
    ay[control] += uy;
    az[control] += uz;
}

int main(void)
{
    long steps;
    double dtau, x[4 * N] = {0}, at[4 * N], k[4][4 * N];
    if (scanf("%ld %lf %lf %d", &steps, &dtau, &speed, &control) != 4)
        return 2;
    for (int i = 0; i < N; i++)
        if (scanf("%lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf", &mass[i], &zeta[i], &zetaq[i], &bearing[i], &seal[i], &unbalance[i],
                  &clearance[i], &gains[i][0], &gains[i][1], &gains[i][2], &gains[i][3]) != 11)
            return 2;
    if (scanf("%lf %lf", &shaft[0], &shaft[1]) != 2)
        return 2;
    struct timespec from, to;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &from);
    double c[3] = {1.0, 1.0, 1.0}, s[3] = {0.0, 0.0, 0.0};
#ifdef TURNED
    double turn_c = cos(0.5 * speed * dtau), turn_s = sin(0.5 * speed * dtau);
#endif
    for (long step = 0; step < steps; step++) {
#ifdef TURNED
        if (step % 32 == 0) {
            c[2] = cos(speed * (double)step * dtau);
            s[2] = sin(speed * (double)step * dtau);
        }
        c[0] = c[2], s[0] = s[2];
        c[1] = c[0] * turn_c - s[0] * turn_s, s[1] = c[0] * turn_s + s[0] * turn_c;
        c[2] = c[1] * turn_c - s[1] * turn_s, s[2] = c[1] * turn_s + s[1] * turn_c;
#else
        for (int h = 0; h < 3; h++) {
            double angle = speed * dtau * ((double)step + 0.5 * h);
            c[h] = cos(angle), s[h] = sin(angle);
        }
#endif
        acceleration(c[0], s[0], x, k[0]);
        for (int i = 0; i < 4 * N; i++)
            at[i] = x[i] + 0.5 * dtau * k[0][i];
        acceleration(c[1], s[1], at, k[1]);
        for (int i = 0; i < 4 * N; i++)
            at[i] = x[i] + 0.5 * dtau * k[1][i];
        acceleration(c[1], s[1], at, k[2]);
        for (int i = 0; i < 4 * N; i++)
            at[i] = x[i] + dtau * k[2][i];
        acceleration(c[2], s[2], at, k[3]);
        for (int i = 0; i < 4 * N; i++)
            x[i] += dtau / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]);
    }
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &to);
    double seconds = (double)(to.tv_sec - from.tv_sec) + 1e-9 * (double)(to.tv_nsec - from.tv_nsec);
    printf("%.17g %.17g %.17g\n", 1e9 * seconds / (double)steps, x[0], x[N]);
    return 0;
}
