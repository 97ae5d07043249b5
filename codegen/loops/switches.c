/* Switching functions: values by whose signs branches choose. Within a step the series are those of one
 * choice; so a step ends just beyond the first place where one of these changes its sign, and the next
 * one begins with the other choice (event location of systems with discontinuities: Hairer, Norsett and
 * Wanner, Solving Ordinary Differential Equations I, 2nd ed. (1993), sect. II.6). */

/* Whether the coefficients b of a polynomial on [0, 1], its last terms left in doubt, bound it away from 0. */
static int is_far(const double *b, double *rest, double *size) {
    double low = 0.0, high = 0.0;
    for (int k = P - 1; k > 0; --k) {
        if (b[k] < 0.0) low += b[k];
        else high += b[k];
    }
    *rest = fabs(b[P - 1]) + fabs(b[P - 2]);
    *size = fabs(b[0]) + (high - low);
    return b[0] > 0.0 ? b[0] + low > *rest : b[0] < 0.0 && b[0] + high < -*rest;
}

/* The first change of sign of a polynomial in the part of [0, 1] up to end: the sign after it, or 0. */
static int change_until(const double *b, double end, double size, double *at) {
    static const double binomial[] = {@SWITCH_BINOMIALS@};
    double c[P], power = 1.0;
    root found[D + 1];
    int flat;
    for (int k = 0; k < P; ++k, power *= end) c[k] = b[k] * power / binomial[k];
    for (int k = 1; k < P; ++k)
        for (int j = P - 1; j >= k; --j) c[j] += c[j - 1];
    if (crossings(c, P - 1, 16.0 * DBL_EPSILON * size, found, &flat) == 0) return 0;
    *at = end * found[0].at;
    return found[0].turn;
}

/* Where on [0, 1] a polynomial, b[k] its coefficient of x^k, first changes its sign: 1, with the place and
 * the sign after it; 0 where it does not; -1 where its last terms are too large to decide. It is looked at
 * over longer and longer parts, each with its own rounding error: zeros may stand close together near 0. */
static int first_change(const double *b, double *at, int *turn) {
    double c[P], rest, size, end = 1.0, sizes[@SWITCH_PARTS@];
    int parts = 0;
    const int is_none = is_far(b, &rest, &size);
    if (is_none || size == 0.0 || !isfinite(size)) return 0;
    if (rest > 1e-3 * size) return -1;
    if (b[0] == 0.0) {
        for (int k = P - 1; k > 0; --k)
            if (b[k] != 0.0) *turn = sign_of(b[k]);
        *at = 0.0;
        return 1;
    }
    for (int far = 0; !far && parts < @SWITCH_PARTS@; end /= 16.0) {
        double power = 1.0, ignored;
        for (int k = 0; k < P; ++k, power *= end) c[k] = b[k] * power;
        far = is_far(c, &ignored, &sizes[parts++]);
    }
    for (end *= 16.0; parts > 0; end *= 16.0) {
        *turn = change_until(b, end, sizes[--parts], at);
        if (*turn != 0) return 1;
    }
    return 0;
}

/* The shortest step, as far as rounding goes, after which switching function m has the sign turn; its
 * polynomial changes it after the time near. HUGE_VAL where it has not even after the longest step. */
static double beyond(const base *s, int m, int turn, double near, double longest) {
    const double finest = 2.0 * spacing(s->t), first = fmax(finest, 1e-18 * longest);
    double low = near, high = near;
    for (double apart = first;; apart *= 4.0) {
        low = high;
        high = fmin(near + apart, longest);
        if (sign_of(switch_value(s, m, high)) == turn) break;
        if (high >= longest) return HUGE_VAL;
    }
    for (double apart = first; low > 0.0 && sign_of(switch_value(s, m, low)) == turn; apart *= 4.0) {
        high = low;
        low = fmax(near - apart, 0.0);
    }
    for (int k = 0; k < 60 && high - low > 0.5 * finest; ++k) {
        const double middle = 0.5 * (low + high);
        if (sign_of(switch_value(s, m, middle)) == turn) high = middle;
        else low = middle;
    }
    return fmax(high, finest);
}

/* The length of a step that ends just beyond the first change of sign of a switching function, HUGE_VAL
 * where a step of the length h has none. h is halved where the series of one converges too slowly. */
static double length_to_switch(const base *s, double *h, double smallest) {
    double b[D + 1], at, first = 2.0;
    int which = -1, turn = 0, sign;
    for (int m = 0; m < SWITCHES; ++m) {
        double power = 1.0;
        for (int k = 0; k < P; ++k, power *= s->direction * *h) b[k] = switch_term(s, k, m) * power;
        const int found = first_change(b, &at, &sign);
        if (found < 0 && 0.5 * *h > smallest) {
            *h *= 0.5;
            first = 2.0;
            which = m = -1;
        } else if (found > 0 && at < first) {
            first = at;
            which = m;
            turn = sign;
        }
    }
    return which < 0 ? HUGE_VAL : beyond(s, which, turn, first * *h, *h);
}

