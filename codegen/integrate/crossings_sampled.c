/* The expressions of all events at Chebyshev's points of the last step. */
static void sample(@PREFIX@ *s, const double *end, const double *u) {
    static const double node[] = {@NODES@};
    double y[N];
    for (int m = 0; m < E; ++m) {
        s->event_sample[0][m] = s->event_value[m];
        s->event_sample[D][m] = end[m];
    }
    for (int k = 1; k < D; ++k) event_point(s, node[k], u, y, s->event_sample[k]);
}

/* Bernstein coefficients of event m over the last step, and their rounding error; 0 if there is no root. */
static int polynomial(const @PREFIX@ *s, int m, const double *end, double *b, double *noise) {
    static const double matrix[D + 1][D + 1] = {
    @MATRIX@};
    double size = 0.0, low = HUGE_VAL, high = -HUGE_VAL;
    for (int k = 0; k <= D; ++k) size += fabs(s->event_sample[k][m]);
    *noise = 4.0 * DBL_EPSILON * @GROWTH@ * size / D;
    if (!isfinite(size)) return 0;
    for (int j = 0; j <= D; ++j) {
        b[j] = 0.0;
        for (int k = 0; k <= D; ++k) b[j] += matrix[j][k] * s->event_sample[k][m];
        low = fmin(low, b[j]);
        high = fmax(high, b[j]);
    }
    b[0] = s->event_value[m];
    b[D] = end[m];
    return !(low > *noise || high < -*noise);
}
