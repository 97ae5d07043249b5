/* Where a step begins: the integrator with the series of its states and switching functions. */
typedef struct {
    const @PREFIX@ *s;
    const double *u;
    double t, direction;
} base;

static double switch_term(const base *o, int k, int m) { return o->s->switch_jet[k][m]; }

/* Switching function m at the states that a step of length h comes to. */
static double switch_value(const base *o, int m, double h) {
    const @PREFIX@ *s = o->s;
    double x[N], g[SWITCHES], lost;
    const double along = o->direction * h;
    for (int i = 0; i < N; ++i) x[i] = two_sum(s->x[i], increment(s, i, along) + s->x_low[i], &lost);
    @PREFIX@_series_switches(s->t + along, x, s->series_constants, o->u, g);
    return g[m];
}

@SWITCHES@/* Whether the polynomials have the right slope shortly before a step ends at a switch: at its end, a rate may
 * jump. A step that is much shorter than the series allow has. */
static int fits_before(const @PREFIX@ *s, double h, double longest, const double *u) {
    double x[N];
    if (fabs(h) <= 1e-3 * longest) return 1;
    for (int i = 0; i < N; ++i) x[i] = s->x[i] + increment(s, i, 0.95 * h);
    return fits(s, 0.95 * h, s->t + 0.95 * h, x, u);
}

