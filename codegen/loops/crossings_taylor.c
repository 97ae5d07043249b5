/* The polynomial of event m over the last step by its Taylor coefficients; that of the last order makes it
 * right at the end of the step. 0 if it has no root, -1 if the last terms leave in doubt which it has. */
static int by_coefficients(const @PREFIX@ *s, int m, const double *end, piece *p) {
    static const double binomial[] = {@BINOMIALS@};
    double *b = p->b, power = s->h_old, sum = 0.0, low = 0.0, high = 0.0;
    p->from = 0.0, p->length = 1.0, p->degree = P;
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
    const double size = fabs(b[0]) + (high - low), rest = fabs(b[P]) + fabs(b[P - 1]);
    p->noise = RIGHT * size + 16.0 * DBL_EPSILON * fmax(s->event_value[E + m], end[E + m]);
    if (b[0] + low > p->noise + rest || b[0] + high < -(p->noise + rest)) return 0;
    if (!(rest <= 1e-3 * size)) return -1;
    for (int k = 1; k < P; ++k) b[k] /= binomial[k];
    for (int k = 1; k <= P; ++k)
        for (int j = P; j >= k; --j) b[j] += b[j - 1];
    b[P] = end[m];
    if (rest <= 0.25 * RIGHT * size) return 1;
    int first, last; /* one crossing is no matter of small errors, and then goes to the zero of the expression */
    if (changes_of_sign(b, P, &first, &last) > 1) return -1;
    for (int k = 0; k <= P; ++k)
        if (fabs(b[k]) <= p->noise + 4.0 * rest) return -1;
    return 1;
}

static void roots_in_step(@PREFIX@ *s, const double *end, size_t first, const double *u) {
    int wanted[E], any = 0;
    piece p;
    const int steady = is_steady(s, 0.0, 1.0, u);
    for (int m = 0; m < E; ++m) {
        const int found = steady ? by_coefficients(s, m, end, &p) : -1;
        wanted[m] = found < 0;
        any |= wanted[m];
        if (found > 0) insert_roots(s, m, &p, first, u);
        if (found == 0) s->event_before[m] = FAR;
    }
    if (any) roots_by_values(s, wanted, end, first, u);
}
