#if S
/* The state that each singularity is about, or -1. */
static const int coordinate[S] = {@COORDINATES@};

/* The largest turn of these states in a step, in radians where they are angles. */
static double largest_turn(const @PREFIX@ *s, const double *x_new) {
    double turn = 0.0;
    for (int m = 0; m < S; ++m)
        if (coordinate[m] >= 0) turn = fmax(turn, fabs(x_new[coordinate[m]] - s->x[coordinate[m]]));
    return turn;
}

/* Whether a step that ends with the values after may have come near a singularity. */
static int may_be_singular(const @PREFIX@ *s, const double *after, double turn) {
    for (int m = 0; m < S; ++m) {
        const double near = fmin(fabs(s->singular[m]), fabs(after[m]));
        const double moved = fabs(after[m] - s->singular[m]);
        if (near < 0.1 || near <= s->margin || near < 2.0 * moved || !isfinite(after[m])) return 1;
    }
    return turn > 0.25;
}

/* The first place in the last step at which a singularity is nearer than the margin, or 2. */
static double find_singular(@PREFIX@ *s, const double *after, const double *u) {
    enum { PARTS = 8 };
    double y[N], here[S], before[S], first = 2.0;
    for (int k = 0; k < S; ++k) before[k] = s->singular[k];
    for (int part = 1; part <= PARTS; ++part) {
        const double right = (double)part / PARTS;
        interpolate(s, right, y);
        @NAME@_singularities(s->t_old + right * s->h_old, y, &s->constants, u, here);
        for (int k = 0; k < S; ++k) {
            if (part == PARTS) here[k] = after[k];
            s->closest[k] = fmin(s->closest[k], fabs(here[k]));
            const int crossed = (here[k] > 0.0) != (before[k] > 0.0);
            if (!crossed && fabs(here[k]) > s->margin) continue;
            double low = right - 1.0 / PARTS, high = right, value[S];
            for (int turn = 0; turn < 60; ++turn) {
                const double middle = 0.5 * (low + high);
                interpolate(s, middle, y);
                @NAME@_singularities(s->t_old + middle * s->h_old, y, &s->constants, u, value);
                if ((value[k] > 0.0) != (before[k] > 0.0) || fabs(value[k]) <= s->margin) high = middle;
                else low = middle;
            }
            if (high < first) {
                first = high;
                s->which = k;
            }
        }
        if (first <= 1.0) return first;
        for (int k = 0; k < S; ++k) before[k] = here[k];
    }
    return 2.0;
}
#endif

void @PREFIX@_within(const @PREFIX@ *s, double t, const double *u, double *x) {
    (void)u;
    interpolate(s, (t - s->t_old) / s->h_old, x);
}

static void store(@PREFIX@_output *o, double t, const double *x) {
    o->t[o->count] = t;
    for (int i = 0; i < N; ++i) o->x[o->count * N + (size_t)i] = x[i];
    o->count += 1;
}

static int wants_grid_point(const @PREFIX@_output *o, double t, double direction) {
    return o->grid != NULL && o->next < o->grid_count && direction * (o->grid[o->next] - t) <= 0.0;
}

@PROJECTION@
/* PAUSED where the run can go on, with the grid points at its start stored; else why it cannot. */
static int ready(const @PREFIX@ *s, @PREFIX@_output *o, double direction) {
    if (s->status != @UPPER@_PAUSED && s->status != @UPPER@_FULL) return s->status;
    if (o->grid != NULL && o->capacity - o->count < o->grid_count - o->next) return @UPPER@_TOO_SMALL;
    while (s->steps == 0 && wants_grid_point(o, s->t, direction)) store(o, o->grid[o->next++], s->x);
    return @UPPER@_PAUSED;
}

/* Whether the step to x_new may hide a singularity; the values at its end go into after. */
static inline int may_stop(@PREFIX@ *s, double t_new, const double *x_new, const double *u, double *after) {
#if S
    @NAME@_singularities(t_new, x_new, &s->constants, u, after);
    for (int m = 0; m < S; ++m) s->closest[m] = fabs(after[m]) < s->closest[m] ? fabs(after[m]) : s->closest[m];
    return may_be_singular(s, after, largest_turn(s, x_new));
#else
    (void)s, (void)t_new, (void)x_new, (void)u, (void)after;
    return 0;
#endif
}

/* Where in the step the run has to stop, from 0 to 1, or 2 for nowhere; the values at its end are kept. */
static inline double place_of_stop(@PREFIX@ *s, int possible, const double *after, const double *u) {
    double place = 2.0;
#if S
    if (possible) place = find_singular(s, after, u);
    for (int m = 0; m < S; ++m) s->singular[m] = after[m];
#else
    (void)s, (void)possible, (void)after, (void)u;
#endif
    return place;
}

/* Store what lies in the step to t_new; where the run stops in it, x_new becomes the state there. Return
 * the time that is reached. */
static inline double arrive(@PREFIX@ *s, @PREFIX@_output *o, double place, double t_new, double *x_new, const double *u) {
    const double t_stop = place <= 1.0 ? s->t_old + place * s->h_old : t_new;
    const double direction = s->h_old >= 0.0 ? 1.0 : -1.0;
    double y[N];
    while (wants_grid_point(o, t_stop, direction)) {
        const double theta = (o->grid[o->next] - s->t_old) / s->h_old;
        if (theta != 1.0) interpolate(s, theta, y);
@PROJECT_POINT@        store(o, o->grid[o->next], theta == 1.0 ? x_new : y);
        o->next += 1;
    }
    if (place <= 1.0) {
        interpolate(s, place, x_new);
@PROJECT_STOP@#if S
        @NAME@_singularities(t_stop, x_new, &s->constants, u, s->singular);
        for (int m = 0; m < S; ++m) s->closest[m] = fabs(s->singular[m]) < s->closest[m] ? fabs(s->singular[m]) : s->closest[m];
#endif
    }
    (void)u;
    return t_stop;
}

/* Take the state for reached; row: what dense output keeps of the step. */
static inline void end_step(@PREFIX@ *s, @PREFIX@_output *o, double t, double t_low, const double *x, const double *row, size_t length) {
    for (int i = 0; i < N; ++i) s->x[i] = x[i];
    s->t = t;
    s->t_low = t_low;
    s->steps += 1;
    if (o->dense != NULL)
        for (size_t i = 0; i < length; ++i) o->dense[o->count * length + i] = row[i];
    if (o->grid == NULL) store(o, s->t, s->x);
}

