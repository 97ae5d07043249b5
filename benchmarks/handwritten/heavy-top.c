/* Symmetric top under gravity, fixed point below the centre of mass; omega_3 is constant.
 * x: omega_1, omega_2, q0, q1, q2, q3. p: I1, I3, m, g, r3, omega_3.
 * c: 2 m g r3 / I1, (I1 - I3) omega_3 / I1, omega_3 / 2. */
void prepare(const double *p, double *c) {
    const double I1 = p[0], I3 = p[1];
    c[0] = 2.0 * (p[2] * p[3] * p[4]) / I1;
    c[1] = (I1 - I3) * p[5] / I1;
    c[2] = 0.5 * p[5];
}

void f(double t, const double *x, const double *c, const double *u, double *dx) {
    (void)t, (void)u;
    const double w1 = x[0], w2 = x[1], q0 = x[2], q1 = x[3], q2 = x[4], q3 = x[5];
    const double h1 = 0.5 * w1, h2 = 0.5 * w2, h3 = c[2];
    dx[0] = c[1] * w2 + c[0] * (q0 * q1 + q2 * q3);
    dx[1] = c[0] * (q0 * q2 - q1 * q3) - c[1] * w1;
    dx[2] = -(q1 * h1 + q2 * h2 + q3 * h3);
    dx[3] = q0 * h1 + q2 * h3 - q3 * h2;
    dx[4] = q0 * h2 + q3 * h1 - q1 * h3;
    dx[5] = q0 * h3 + q1 * h2 - q2 * h1;
}
