/* The step to try, h to t_new and what t_new lacks: PAUSED, or why none can be made. */
static inline int next_step(@PREFIX@ *s, double direction, double *h, double *t_new, double *t_low) {
    const double smallest = 10.0 * spacing(s->t), rest = (s->t_end - s->t) - s->t_low;
    double h_abs = fmin(s->h, s->h_max);
    if (h_abs < smallest && fabs(rest) > smallest) {
        if (s->after_rejection) return s->status = s->which >= 0 ? @UPPER@_NOT_FINITE : @UPPER@_STEP_TOO_SMALL;
        h_abs = smallest;
    }
    const int last = h_abs >= fabs(rest) * (1.0 - 1e-12);
    *h = last ? rest : h_abs * direction;
    *t_new = last ? s->t_end : two_sum(s->t, *h + s->t_low, t_low);
    if (last) *t_low = 0.0;
    return @UPPER@_PAUSED;
}

static void reject(@PREFIX@ *s, double h, double factor) {
    s->h = fabs(h) * factor;
    s->rejected += 1;
    s->after_rejection = 1;
}

/* Whether a step to x_new is not taken, because of its error, or lest anything be jumped over; bad: what is
 * not finite at its end, or -1. */
static inline int is_rejected(@PREFIX@ *s, double h, double error, int bad, const double *x_new) {
    if (!(error < 1.0)) {
        s->which = isfinite(error) ? -1 : (bad >= 0 ? bad : 0);
        reject(s, h, isfinite(error) ? fmax(0.2, 0.9 * pow(error, -1.0 / @ORDER@.0)) : 0.2);
        return 1;
    }
#if S
    const double turn = largest_turn(s, x_new);
    if (turn > 1.0) {
        reject(s, h, 0.7 / turn);
        return 1;
    }
#else
    (void)x_new;
#endif
    return 0;
}

/* What the next step is longer by after one that is taken. */
static inline double growth(@PREFIX@ *s, double error) {
    const double factor = error > 1e-12 ? 0.9 / @ROOT@ : 10.0, most = s->after_rejection ? 1.0 : 10.0;
    s->after_rejection = 0;
    s->which = -1;
    return fmin(most, fmax(0.2, factor));
}

