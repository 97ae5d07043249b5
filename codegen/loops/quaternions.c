/* The larger number, without a call of a library. */
static inline double larger(double a, double b) { return a > b ? a : b; }

/* cos a - 1, (sin a)/a and ((sin a)/a - cos a)/a^2 of a = sqrt(y), without cancellation near zero. */
static inline void turns(double y, double *versed, double *sinc, double *rest) {
    if (y > 1.0) {
        const double a = sqrt(y), half = sin(0.5 * a);
        *versed = -2.0 * half * half;
        *sinc = sin(a) / a;
        *rest = (*sinc - 1.0 - *versed) / y;
        return;
    }
    const double z = -y;
    double c = 1.0 / 2432902008176640000.0, n = 1.0 / 51090942171709440000.0, r = 20.0 / 51090942171709440000.0;
    c = c * z + 1.0 / 6402373705728000.0;
    c = c * z + 1.0 / 20922789888000.0;
    c = c * z + 1.0 / 87178291200.0;
    c = c * z + 1.0 / 479001600.0;
    c = c * z + 1.0 / 3628800.0;
    c = c * z + 1.0 / 40320.0;
    c = c * z + 1.0 / 720.0;
    c = c * z + 1.0 / 24.0;
    c = c * z + 0.5;
    *versed = -y * c;
    n = n * z + 1.0 / 121645100408832000.0;
    n = n * z + 1.0 / 355687428096000.0;
    n = n * z + 1.0 / 1307674368000.0;
    n = n * z + 1.0 / 6227020800.0;
    n = n * z + 1.0 / 39916800.0;
    n = n * z + 1.0 / 362880.0;
    n = n * z + 1.0 / 5040.0;
    n = n * z + 1.0 / 120.0;
    n = n * z + 1.0 / 6.0;
    *sinc = 1.0 - y * n;
    r = 18.0 / 121645100408832000.0 + r * z;
    r = r * z + 16.0 / 355687428096000.0;
    r = r * z + 14.0 / 1307674368000.0;
    r = r * z + 12.0 / 6227020800.0;
    r = r * z + 10.0 / 39916800.0;
    r = r * z + 8.0 / 362880.0;
    r = r * z + 6.0 / 5040.0;
    r = r * z + 4.0 / 120.0;
    r = r * z + 2.0 / 6.0;
    *rest = r;
}

/* The product of quaternions q e, scalar first. */
static inline void multiplied(const double *q, const double *e, double *y) {
    const double a = q[0] * e[0] - q[1] * e[1] - q[2] * e[2] - q[3] * e[3];
    const double b = q[0] * e[1] + q[1] * e[0] + q[2] * e[3] - q[3] * e[2];
    const double c = q[0] * e[2] + q[2] * e[0] + q[3] * e[1] - q[1] * e[3];
    const double d = q[0] * e[3] + q[3] * e[0] + q[1] * e[2] - q[2] * e[1];
    y[0] = a, y[1] = b, y[2] = c, y[3] = d;
}

/* q + q_low, a unit quaternion in two parts, plus what is to be added to it; one Newton step for the
 * root in 1/|q| keeps its length, with squares to twice the digits. */
static void add_to_unit(double *q, double *low, const double *change) {
    double rest = 1.0, lost = 0.0;
    for (int i = 0; i < 4; ++i) q[i] = two_sum(q[i], low[i] + change[i], &low[i]);
    for (int i = 0; i < 4; ++i) {
        double part;
        const double square = q[i] * q[i];
        rest = two_sum(rest, -square, &part);
        lost += part - fma(q[i], q[i], -square) - 2.0 * q[i] * low[i];
    }
    rest = 0.5 * (rest + lost);
    for (int i = 0; i < 4; ++i) q[i] = two_sum(q[i], low[i] + rest * q[i], &low[i]);
}
