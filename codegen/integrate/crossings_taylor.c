/* Bernstein coefficients of event m over the last step, and their rounding error; 0 if there is no root.
 * The coefficient of the last order makes the polynomial right at the end of the step. */
static int polynomial(const @PREFIX@ *s, int m, const double *end, double *b, double *noise) {
    static const double binomial[] = {@BINOMIALS@};
    double power = s->h_old, sum = 0.0, low = 0.0, high = 0.0;
    b[0] = s->event_value[m];
    for (int k = 1; k < P; ++k) {
        b[k] = s->event_jet[k][m] * power;
        power *= s->h_old;
    }
    for (int k = P - 1; k > 0; --k) sum += b[k];
    b[P] = end[m] - (b[0] + sum);
    for (int k = P; k > 0; --k) {
        if (b[k] < 0.0) low += b[k];
        else high += b[k];
    }
    *noise = 32.0 * DBL_EPSILON * (fabs(b[0]) + (high - low));
    if (!isfinite(*noise) || b[0] + low > *noise || b[0] + high < -*noise) return 0;
    for (int k = 1; k < P; ++k) b[k] /= binomial[k];
    for (int k = 1; k <= P; ++k)
        for (int j = P; j >= k; --j) b[j] += b[j - 1];
    b[P] = end[m];
    return 1;
}
