#define D @EVENT_ROOM_DEGREE@ /* no polynomial of an event has a higher degree */

@ROOTS@/* State at t_old + theta h_old; expressions of the events there, then how large their terms are. */
static void event_point(const @PREFIX@ *s, double theta, const double *u, double *y, double *g) {
    const double t = s->t_old + theta * s->h_old;
    interpolate(s, theta, y);
@PROJECT_EVENT@    @NAME@_events(t, y, &s->constants, u, g);
}

#if @LOOKED@
enum { SAMPLES = @EVENT_ROOM_DEGREE@ + 1 };

@EVENT_BOX@
/* Bounds of the states over a part of the last step: no polynomial of their degree leaves its values at
 * Chebyshev's points by more than the constant of Lebesgue (Trefethen, Approximation Theory and
 * Approximation Practice, theorem 15.2). */
static void box_of_part(const @PREFIX@ *s, double from, double length, double *box) {
    static const double sample[SAMPLES] = {@SAMPLES@};
    double y[N];
    for (int k = 0; k < SAMPLES; ++k) {
        interpolate(s, from + sample[k] * length, y);
        for (int i = 0; i < N; ++i) {
            box[2 * i] = k == 0 || y[i] < box[2 * i] ? y[i] : box[2 * i];
            box[2 * i + 1] = k == 0 || y[i] > box[2 * i + 1] ? y[i] : box[2 * i + 1];
        }
    }
    for (int i = 0; i < N; ++i) {
        const double middle = 0.5 * (box[2 * i] + box[2 * i + 1]);
        const double half = @LEBESGUE@ * 0.5 * (box[2 * i + 1] - box[2 * i]);
        box[2 * i] = middle - half, box[2 * i + 1] = middle + half;
    }
}

/* Whether every operation of the events keeps its character over a part of the last step. */
static int is_steady(const @PREFIX@ *s, double from, double length, const double *u) {
    double box[2 * N + 2], holds;
    if (length == 1.0) box_of_step(s, box);
    else box_of_part(s, from, length, box);
    const double one = s->t_old + from * s->h_old, other = s->t_old + (from + length) * s->h_old;
    box[2 * N] = fmin(one, other), box[2 * N + 1] = fmax(one, other);
    @PREFIX@_looks(0.0, box, 1, s->of_looks, NULL, u, 1, &holds, 1);
    return holds != 0.0;
}

/* Whether all parts of the last step, which is halved so often, are so. */
static int is_steady_in_parts(const @PREFIX@ *s, const double *u) {
    double from = 0.0, length = 1.0;
    while (from < 1.0) {
        if (is_steady(s, from, length, u)) {
            from += length;
            while (fmod(from, 2.0 * length) == 0.0 && from < 1.0) length *= 2.0;
        } else if (length < 1.5 / (1 << @EVENT_HALVES@)) return 0;
        else length *= 0.5;
    }
    return 1;
}

/* Whether a step of length h must be made shorter for the events; one that is as short as can be is counted. */
static int is_too_quick(@PREFIX@ *s, double h, const double *u) {
    const double t_old = s->t_old, h_old = s->h_old;
    double x_old[N];
    for (int i = 0; i < N; ++i) x_old[i] = s->x_old[i], s->x_old[i] = s->x[i];
    s->t_old = s->t, s->h_old = h;
    const int steady = is_steady_in_parts(s, u);
    for (int i = 0; i < N; ++i) s->x_old[i] = x_old[i];
    s->t_old = t_old, s->h_old = h_old;
    if (steady) return 0;
    if (fabs(h) > 1e-9 * fabs(s->t_end - s->t) + 64.0 * spacing(s->t)) return 1;
    if (s->quick++ == 0) s->quick_at = s->t;
    return 0;
}
#else
static int is_steady(const @PREFIX@ *s, double from, double length, const double *u) {
    (void)s, (void)from, (void)length, (void)u;
    return 1;
}
#endif

/* A polynomial is right within this part of its largest value; at Chebyshev's points rounding alone is
 * @ROUNDING@ of it. */
#define RIGHT 2e-12

/* The polynomial of an event over a part of the last step. */
typedef struct {
    double b[D + 1], noise, from, length;
    int degree;
} piece;

/* Where in the step the expression itself is zero, near a crossing of its polynomial. */
static double polished(const @PREFIX@ *s, int m, const piece *p, double at, const double *u) {
    double y[N], g[2 * E], slope, least = HUGE_VAL, best = at;
    for (int turn = 0; turn < 4; ++turn) {
        event_point(s, p->from + at * p->length, u, y, g);
        if (!(fabs(g[m]) < least)) break;
        least = fabs(g[m]);
        best = at;
        value_at(p->b, p->degree, at, &slope);
        at = at - g[m] / slope;
        if (!(at > 0.0 && at < 1.0) || at == best) break;
    }
    return p->from + best * p->length;
}

/* The same where the polynomial is within its noise about the crossing: by halving. */
static double halved(const @PREFIX@ *s, int m, const piece *p, double at, int turn, const double *u) {
    double y[N], g[2 * E], low = at, high = at, apart = 1e-8;
    for (int side = -1; side <= 1; side += 2, apart = 1e-8) {
        do {
            const double place = fmin(1.0, fmax(0.0, at + side * apart));
            if (side < 0) low = place;
            else high = place;
            event_point(s, p->from + place * p->length, u, y, g);
            apart *= 4.0;
        } while (sign_of(g[m]) != side * turn && apart < 0.01);
        if (sign_of(g[m]) != side * turn) return p->from + at * p->length;
    }
    for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (low + high);
        event_point(s, p->from + middle * p->length, u, y, g);
        if (sign_of(g[m]) == turn) high = middle;
        else low = middle;
    }
    return p->from + high * p->length;
}

/* Insert the roots of event m in a part of the last step by their places in the step; t of each is that
 * place until all are known. */
static void insert_roots(@PREFIX@ *s, int m, const piece *p, size_t first, const double *u) {
    root found[2 * D + 4];
    const int is_first = s->steps == 0 && p->from == 0.0;
    const int count = roots_of(p->b, p->degree, p->noise, is_first, &s->event_before[m], found);
    for (int k = 0; k < count; ++k) {
        if (s->event_direction[m] != 0 && found[k].turn != s->event_direction[m]) continue;
        const int turn = found[k].turn, inside = found[k].at > 0.0 && found[k].at < 1.0;
        double at = p->from + found[k].at * p->length;
        if (found[k].simple) at = polished(s, m, p, found[k].at, u);
        else if (turn != 0 && inside) at = halved(s, m, p, found[k].at, turn, u);
        size_t place = s->found_count++;
        for (; place > first && s->found[place - 1].t > at; --place) s->found[place] = s->found[place - 1];
        s->found[place].t = at;
        s->found[place].which = m;
        s->found[place].direction = found[k].turn;
    }
}

/* The polynomials of all events through their values at Chebyshev's points g of a part of the step. Whether
 * they are right between these, within their noise: at two more points. */
static int through_values(const @PREFIX@ *s, double g[][2 * E], piece *p, const int *wanted, const double *u) {
    static const double matrix[][@EVENT_POINTS@] = {
        @MATRIX@};
    static const double further[] = {0.42178, 0.72700} /* where the difference is largest for a further power */;
    double y[N], more[2][2 * E], slope;
    for (int k = 0; k < 2; ++k) event_point(s, p->from + further[k] * p->length, u, y, more[k]);
    int fits = 1;
    for (int m = 0; m < E; ++m) {
        double size = 0.0, terms = 0.0;
        if (!wanted[m]) continue;
        p[m].from = p->from, p[m].length = p->length, p[m].degree = @EVENT_POINTS@ - 1;
        for (int k = 0; k < @EVENT_POINTS@; ++k) {
            size = fmax(size, fabs(g[k][m])) + 0.0 * g[k][m]; /* not finite where a value is not */
            terms = fmax(terms, g[k][E + m]);
        }
        for (int j = 0; j < @EVENT_POINTS@; ++j) {
            p[m].b[j] = 0.0;
            for (int k = 0; k < @EVENT_POINTS@; ++k) p[m].b[j] += matrix[j][k] * g[k][m];
            size += 0.0 * p[m].b[j];
        }
        p[m].b[0] = g[0][m], p[m].b[@EVENT_POINTS@ - 1] = g[@EVENT_POINTS@ - 1][m];
        p[m].noise = RIGHT * size + 16.0 * DBL_EPSILON * terms;
        for (int k = 0; k < 2; ++k) {
            const double off = fabs(value_at(p[m].b, p[m].degree, further[k], &slope) - more[k][m]);
            if (off > 0.25 * p[m].noise) fits = 0;
        }
    }
    return fits;
}

/* Insert the roots of the events wanted in the last step, which ends with their values at end: the step is
 * halved where an expression varies too much for one polynomial. */
static void roots_by_values(@PREFIX@ *s, const int *wanted, const double *end, size_t first, const double *u) {
    enum { HALVES = @EVENT_HALVES@ };
    static const double node[] = {@NODES@};
    double until[HALVES + 1], after[HALVES + 1][2 * E], g[@EVENT_POINTS@][2 * E], y[N];
    piece p[E];
    int top = 1;
    until[0] = 1.0, p->from = 0.0;
    for (int m = 0; m < 2 * E; ++m) g[0][m] = s->event_value[m], after[0][m] = end[m];
    while (top > 0) {
        const double from = p->from, to = until[top - 1];
        p->length = to - from;
        for (int m = 0; m < 2 * E; ++m) g[@EVENT_POINTS@ - 1][m] = after[top - 1][m];
        for (int k = 1; k < @EVENT_POINTS@ - 1; ++k) event_point(s, from + node[k] * p->length, u, y, g[k]);
        const int is_finest = p->length < 1.5 / (1 << HALVES);
        if (!is_finest && !(is_steady(s, from, p->length, u) && through_values(s, g, p, wanted, u))) {
            until[top] = from + node[@EVENT_POINTS@ / 2] * p->length;
            for (int m = 0; m < 2 * E; ++m) after[top][m] = g[@EVENT_POINTS@ / 2][m];
            ++top;
            continue;
        }
        if (is_finest) through_values(s, g, p, wanted, u);
        for (int m = 0; m < E; ++m) {
            if (wanted[m] && isfinite(p[m].noise)) insert_roots(s, m, &p[m], first, u);
            else if (wanted[m] && s->quick++ == 0) s->quick_at = s->t_old + from * s->h_old;
        }
        for (int m = 0; m < 2 * E; ++m) g[0][m] = after[top - 1][m];
        p->from = to;
        --top;
    }
}

@EVENT_POLYNOMIAL@
/* Report the events of the last step up to its place of stop, or to a terminal event: return which is
 * first, 2 for neither. Of several events at one time all are reported. */
static double first_stop(@PREFIX@ *s, double place, double t_new, const double *x_new, const double *u) {
    const size_t first = s->found_count;
    double end[2 * E], g[2 * E];
    @NAME@_events(t_new, x_new, &s->constants, u, end);
    roots_in_step(s, end, first, u);
    for (size_t k = first; k < s->found_count; ++k) {
        @PREFIX@_event *event = &s->found[k];
        const double at = event->t;
        if (at > place) {
            s->found_count = k;
            break;
        }
        event->t = at == 1.0 ? t_new : s->t_old + at * s->h_old;
        if (at == 1.0)
            for (int i = 0; i < N; ++i) event->x[i] = x_new[i];
        else event_point(s, at, u, event->x, g);
        const int is_start = s->steps == 0 && at == 0.0;
        if (is_start || s->event_stop[event->which] <= 0 || --s->event_stop[event->which] > 0) continue;
        if (s->stopped == @UPPER@_EVENT) continue; /* another one stops the run at the same time */
        place = at;
        s->which = event->which;
        s->stopped = @UPPER@_EVENT;
    }
    for (int m = 0; m < 2 * E; ++m) s->event_value[m] = end[m];
    return place;
}

