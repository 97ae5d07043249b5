/* Euler's equations of a free rigid body about its principal axes.
 * x: omega_1, omega_2, omega_3. p: I1, I2, I3. c: (I2 - I3)/I1 and so on. */
void prepare(const double *p, double *c) {
    c[0] = (p[1] - p[2]) / p[0];
    c[1] = (p[2] - p[0]) / p[1];
    c[2] = (p[0] - p[1]) / p[2];
}

void f(double t, const double *x, const double *c, const double *u, double *dx) {
    (void)t, (void)u;
    const double w1 = x[0], w2 = x[1], w3 = x[2];
    dx[0] = c[0] * (w2 * w3);
    dx[1] = c[1] * (w3 * w1);
    dx[2] = c[2] * (w1 * w2);
}
