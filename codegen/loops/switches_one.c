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

/* A step ends behind a switch by less than two spacings of times, and has had the rates before it until there. */
static void keep_jumps(@PREFIX@ *s, int switches, double h, double t, const double *x, const double *u) {
    const double finest = 2.0 * spacing(t);
    double f[N];
    if (switches) {
        @NAME@_rates(t + (h < 0.0 ? -finest : finest), x, &s->constants, u, f);
        s->evaluations += 1;
    }
    for (int i = 0; i < N; ++i) {
        const double off = switches ? finest * fabs(f[i] - slope(s, i, h)) : 0.0;
        keep_jump(s, i, t, off, s->atol[i] + s->rtol * larger(s->size[i], fabs(x[i])));
    }
}

