static void prepare_(run_ *r) {
    @PREFIX@_f_constants(r->p, r->constants);
    @PREFIX@_s_constants(r->p, r->of_series);
}

#if S
/* The state that each singularity is about, or -1. */
static const int coordinate_[S] = {@COORDINATES@};

APART_ void singularities_(const run_ *r, lane_ t, const lane_ *x, lane_ *values) {
    @PREFIX@_f_singularities((const double *)&t, (const double *)x, LANES_, r->constants, NULL, r->u, LANES_, (double *)values, LANES_);
}

/* The largest turn of these states in a step, in radians where they are angles. */
INLINE_ lane_ largest_turn_(const run_ *r, const lane_ *x_new) {
    lane_ turn = lanes_all_(0.0);
    for (int m = 0; m < S; ++m)
        if (coordinate_[m] >= 0) turn = larger_(lanes_abs_(x_new[coordinate_[m]] - r->x[coordinate_[m]]), turn);
    return turn;
}

/* The first place in a step at which a singularity is nearer than the margin, or 2, of the lanes wanted. */
APART_ lane_ find_singular_(const run_ *r, const job_ *o, const step_ *s, mask_ wanted, const lane_ *after, int *which) {
    enum { PARTS = 8 };
    lane_ y[N], here[S], before[S], value[S], first = lanes_all_(2.0);
    for (int m = 0; m < S; ++m) before[m] = r->singular[m];
    for (int part = 1; part <= PARTS && any_(wanted); ++part) {
        const lane_ right = lanes_all_((double)part / PARTS);
        for (int i = 0; i < N; ++i) y[i] = r->x[i] + increment_(r, i, right * s->h);
        singularities_(r, r->t + right * s->h, y, here);
        for (int m = 0; m < S; ++m) {
            if (part == PARTS) here[m] = after[m];
            const mask_ side = (mask_)(before[m] > 0.0), crossed = (mask_)(here[m] > 0.0) ^ side;
            const mask_ hit = wanted & (crossed | ~(mask_)(lanes_abs_(here[m]) > o->margin));
            if (!any_(hit)) continue;
            lane_ low = right - 1.0 / PARTS, high = right;
            for (int turn = 0; turn < 60; ++turn) {
                const lane_ middle = 0.5 * (low + high);
                for (int i = 0; i < N; ++i) y[i] = r->x[i] + increment_(r, i, middle * s->h);
                singularities_(r, r->t + middle * s->h, y, value);
                const mask_ beyond = ((mask_)(value[m] > 0.0) ^ side) | (mask_)(lanes_abs_(value[m]) <= o->margin);
                high = lanes_choose_(beyond, middle, high);
                low = lanes_choose_(beyond, low, middle);
            }
            const mask_ earlier = hit & (mask_)(high < first);
            first = lanes_choose_(earlier, high, first);
            EACH(k) if (earlier[k]) which[k] = m;
        }
        wanted &= ~(mask_)(first <= 1.0);
        for (int m = 0; m < S; ++m) before[m] = here[m];
    }
    return first;
}

/* The same, looked for where a step may have come near a singularity. The values at its end are kept. */
INLINE_ lane_ stop_(run_ *r, const job_ *o, const step_ *s, mask_ sound, int *which) {
    lane_ after[S];
    singularities_(r, s->t, s->x, after);
    mask_ may = (mask_)(largest_turn_(r, s->x) > 0.25);
    for (int m = 0; m < S; ++m) {
        const lane_ one = lanes_abs_(r->singular[m]), other = lanes_abs_(after[m]), near = smaller_(one, other);
        may |= (mask_)(near < larger_(2.0 * lanes_abs_(after[m] - r->singular[m]), lanes_all_(0.1)));
        may |= (mask_)(near <= o->margin) | ~(mask_)(after[m] - after[m] == 0.0);
    }
    may &= sound & r->active;
    const lane_ stop = any_(may) ? find_singular_(r, o, s, may, after, which) : lanes_all_(2.0);
    for (int m = 0; m < S; ++m) r->singular[m] = after[m];
    return stop;
}

/* The part of a step after which the angles have not turned too far: nothing is to be jumped over. */
INLINE_ lane_ for_turn_(const run_ *r, const lane_ *x_new) {
    const lane_ turn = largest_turn_(r, x_new);
    return lanes_choose_((mask_)(turn > 1.0), 0.7 / turn, lanes_all_(1.0));
}

static int singular_at_start_(run_ *r, const job_ *o, int lane) {
    lane_ values[S];
    singularities_(r, r->t, r->x, values);
    for (int m = 0; m < S; ++m) {
        r->singular[m][lane] = values[m][lane];
        if (fabs(values[m][lane]) <= o->margin) return m;
    }
    return -1;
}
#else
INLINE_ lane_ stop_(run_ *r, const job_ *o, const step_ *s, mask_ sound, int *which) {
    (void)r, (void)o, (void)s, (void)sound, (void)which;
    return lanes_all_(2.0);
}
INLINE_ lane_ for_turn_(const run_ *r, const lane_ *x_new) {
    (void)r, (void)x_new;
    return lanes_all_(1.0);
}
static int singular_at_start_(run_ *r, const job_ *o, int lane) {
    (void)r, (void)o, (void)lane;
    return -1;
}
#endif

INLINE_ void commit_(run_ *r, const step_ *s) {
    for (int i = 0; i < N; ++i) {
        r->x[i] = s->x[i];
        r->x_low[i] = s->x_low[i];
        r->size[i] = s->size[i];
    }
    r->t = s->t;
    r->t_low = s->t_low;
    r->h_old = s->h;
    r->steps += 1.0;
}
