/* Rigid body on a circular orbit; attitude in the frame of the orbit (radial, velocity, normal).
 * x: omega_1, omega_2, omega_3, q0, q1, q2, q3. p: I1, I2, I3, n.
 * c: (I3 - I2)/I1 and so on, 6 n^2, 12 n^2, n, n/2. */
void prepare(const double *p, double *c) {
    const double I1 = p[0], I2 = p[1], I3 = p[2], n = p[3];
    c[0] = (I3 - I2) / I1;
    c[1] = (I1 - I3) / I2;
    c[2] = (I2 - I1) / I3;
    c[3] = 6.0 * (n * n);
    c[4] = 12.0 * (n * n);
    c[5] = n;
    c[6] = 0.5 * n;
}

void f(double t, const double *x, const double *c, const double *u, double *dx) {
    (void)t, (void)u;
    const double w1 = x[0], w2 = x[1], w3 = x[2], q0 = x[3], q1 = x[4], q2 = x[5], q3 = x[6];
    const double q02 = q0 * q2, q13 = q1 * q3;
    const double a = q0 * q0 - q2 * q2, b = q1 * q1 - q3 * q3;
    const double radial_2 = q1 * q2 - q0 * q3; /* half of the component, as the next */
    const double radial_3 = q13 + q02;
    const double kr = c[3] * (a + b);
    dx[0] = c[0] * (c[4] * radial_2 * radial_3 - w2 * w3);
    dx[1] = c[1] * (kr * radial_3 - w3 * w1);
    dx[2] = c[2] * (kr * radial_2 - w1 * w2);
    const double h1 = 0.5 * w1 - c[5] * (q13 - q02);
    const double h2 = 0.5 * w2 - c[5] * (q0 * q1 + q2 * q3);
    const double h3 = 0.5 * w3 - c[6] * (a - b);
    dx[3] = -(q1 * h1 + q2 * h2 + q3 * h3);
    dx[4] = q0 * h1 + q2 * h3 - q3 * h2;
    dx[5] = q0 * h2 + q3 * h1 - q1 * h3;
    dx[6] = q0 * h3 + q1 * h2 - q2 * h1;
}
