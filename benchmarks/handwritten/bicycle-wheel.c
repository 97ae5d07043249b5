/* Spinning symmetric body, 3-1-2 angles, torque -M1 b1; C is its spin about the axle.
 * x: theta, psi, theta', psi'. p: I1, I2, M1, C. */
#include <math.h>

void f(double t, const double *x, const double *p, const double *u, double *dx) {
    (void)t, (void)u;
    const double dtheta = x[2], dpsi = x[3];
    const double I1 = p[0], spin = p[1] * p[3], M1 = p[2];
    const double s = sin(x[0]), c = cos(x[0]); /* one sincos where the library has it */
    const double turn = I1 * dpsi * s;
    dx[0] = dtheta;
    dx[1] = dpsi;
    dx[2] = (c * dpsi * (spin - turn) - M1) / I1;
    dx[3] = dtheta * (turn + turn - spin) / (I1 * c);
}
