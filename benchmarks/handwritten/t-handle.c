/* Euler's equations of a free rigid body about its principal axes.
 * x: omega_1, omega_2, omega_3. p: I1, I2, I3. */
void f(double t, const double *x, const double *p, const double *u, double *dx) {
    (void)t, (void)u;
    const double w1 = x[0], w2 = x[1], w3 = x[2];
    const double I1 = p[0], I2 = p[1], I3 = p[2];
    dx[0] = (I2 - I3) * (w2 * w3) / I1;
    dx[1] = (I3 - I1) * (w3 * w1) / I2;
    dx[2] = (I1 - I2) * (w1 * w2) / I3;
}
