/* What time alone brings between t and t + along: whether every operation keeps its character, y[0], and
 * whether every condition and table stays on its piece, y[1]; by intervals. */
static void look(const @PREFIX@ *s, const double *u, double along, double *y) {
    const double there = s->t + along;
    const double x[4] = {s->t, fmin(s->t, there), fmax(s->t, there), @DEPTH@ - log(s->rtol)};
    @PREFIX@_ahead(0.0, x, 1, s->of_ahead, NULL, u, 1, y, 1);
}

/* Make the step that is proposed so short that it passes over nothing: 2 where it ends at a change of piece, to
 * within rounding, or is as short as can be and passes it, and the change is at edge, or edge_off beside it; 1 where
 * it is shorter for something else. */
static int look_ahead(@PREFIX@ *s, const double *u, double direction) {
    const double smallest = 10.0 * spacing(s->t);
    double low = 0.0, high = fmin(fmin(s->h, s->h_max), fabs(s->t_end - s->t)), y[2];
    if (high <= smallest) return 0;
    look(s, u, direction * high, y);
    if (y[0] != 0.0 && y[1] != 0.0) return 0;
    int jumps = y[1] == 0.0;
    for (int turn = 0; turn < 1100 && (jumps || high > smallest); ++turn) {
        const double finest = spacing(s->t + direction * high);
        if (high - low <= (jumps ? finest : 0.1 * high)) break;
        const double middle = 0.5 * (low + high);
        look(s, u, direction * middle, y);
        if (y[0] != 0.0 && y[1] != 0.0) low = middle;
        else high = middle, jumps = y[1] == 0.0;
    }
    if (!jumps) {
        s->h = fmax(low, smallest);
        return 1;
    }
    s->edge = 0.5 * (low + high) - direction * s->t_low;
    s->edge_off = 0.5 * (high - low + spacing(s->t + direction * high));
    s->h = fmax(low - 2.0 * spacing(s->t + direction * high), smallest);
    return 2;
}

/* Whether a step over a change of piece is as short as can be: whatever its error, no other is smaller. */
static inline int is_shortest(const @PREFIX@ *s, double h) { return fabs(h) <= 11.0 * spacing(s->t); }

/* The part of such a step before the change. */
static inline double part_before(const @PREFIX@ *s, double h) { return fmin(fmax(s->edge / fabs(h), 0.0), 1.0); }
