/* Where the step of a lane begins. */
typedef struct {
    const run_ *r;
    int lane;
    double t, direction;
} base;

static double spacing(double t) { return fmax(DBL_EPSILON * fabs(t), DBL_MIN); }
static double switch_term(const base *o, int k, int m) { return o->r->jet[P * N + k * SWITCHES + m][o->lane]; }

/* Switching function m at the states that a step of length h comes to. */
APART_ double switch_value(const base *o, int m, double h) {
    const run_ *r = o->r;
    const lane_ along = lanes_all_(o->direction * h), t = r->t + along;
    lane_ x[N], g[SWITCHES], lost;
    for (int i = 0; i < N; ++i) x[i] = two_sum_(r->x[i], increment_(r, i, along) + r->x_low[i], &lost);
    @PREFIX@_s_values((const double *)&t, (const double *)x, LANES_, r->of_series, NULL, r->u, LANES_, (double *)g, LANES_);
    return g[m][o->lane];
}

@SWITCHES@/* Lanes in which a switching function may change its sign in a step of the length h, by its coefficients. */
INLINE_ mask_ may_switch_(const run_ *r, lane_ h) {
    mask_ may = lanes_bits_(0);
    for (int m = 0; m < SWITCHES; ++m) {
        lane_ low = lanes_all_(0.0), high = low, power = r->direction * h, rest = low;
        const lane_ first = r->jet[P * N + m];
        for (int k = 1; k < P; ++k, power *= r->direction * h) {
            const lane_ term = r->jet[P * N + k * SWITCHES + m] * power;
            low += smaller_(term, lanes_all_(0.0));
            high += larger_(term, lanes_all_(0.0));
            if (k > P - 3) rest += lanes_abs_(term);
        }
        may |= ~(((mask_)(first > 0.0) & (mask_)(first + low > 2.0 * rest)) | ((mask_)(first < 0.0) & (mask_)(first + high < -2.0 * rest)));
    }
    return may;
}

/* The length of the step to the first switch of each lane, HUGE_VAL for none; h is at most what is left, and
 * is halved where a series converges too slowly. */
INLINE_ lane_ to_switch_(const run_ *r, lane_ *h, lane_ smallest) {
    lane_ found = lanes_all_(HUGE_VAL);
    const mask_ may = r->active & may_switch_(r, *h);
    if (!any_(may)) return found;
    EACH(k) if (may[k]) {
        const base here = {r, k, r->t[k], r->direction};
        double length = (*h)[k];
        found[k] = length_to_switch(&here, &length, smallest[k]);
        (*h)[k] = length;
    }
    return found;
}

/* Whether the polynomials have the right slope at the end of the step, or shortly before it in the lanes
 * that it takes to a switch: there, a rate may jump. A step that is much shorter than the longest has. */
APART_ mask_ fits_before_(const run_ *r, const job_ *o, const step_ *s, mask_ lands, lane_ longest) {
    lane_ x[N];
    const lane_ h = lanes_choose_(lands, 0.95 * s->h, s->h), t = lanes_choose_(lands, r->t + h, s->t);
    for (int i = 0; i < N; ++i) x[i] = lanes_choose_(lands, r->x[i] + increment_(r, i, h), s->x[i]);
    return fits_(r, o, h, t, x, s->size) | (lands & (mask_)(lanes_abs_(s->h) <= 1e-3 * longest));
}

