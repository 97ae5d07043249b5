/* Spinning symmetric body, 3-1-2 angles, torque -M1 b1; C is its spin about the axle.
 * x: theta, psi, theta', psi'. p: I1, I2, M1, C. c: 1/I1, I1, I2 C, M1. */
#include <math.h>

void prepare(const double *p, double *c) {
    c[0] = 1.0 / p[0];
    c[1] = p[0];
    c[2] = p[1] * p[3];
    c[3] = p[2];
}

void f(double t, const double *x, const double *c, const double *u, double *dx) {
    (void)t, (void)u;
    const double dtheta = x[2], dpsi = x[3];
    const double I1 = c[1], spin = c[2];
    const double s = sin(x[0]), co = cos(x[0]); /* one sincos where the library has it */
    const double turn = I1 * dpsi * s;
    dx[0] = dtheta;
    dx[1] = dpsi;
    dx[2] = (co * dpsi * (spin - turn) - c[3]) * c[0];
    dx[3] = dtheta * (turn + turn - spin) / (I1 * co);
}
