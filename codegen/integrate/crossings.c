#define D @EVENT_DEGREE@

@ROOTS@/* State and expressions of the events at t_old + theta h_old. */
static void event_point(const @PREFIX@ *s, double theta, const double *u, double *y, double *g) {
    const double t = s->t_old + theta * s->h_old;
    interpolate(s, theta, y);
@PROJECT_EVENT@    @NAME@_events(t, y, &s->constants, u, g);
}

@EVENT_POLYNOMIAL@
/* Where the expression of event m is zero in truth, near a crossing of its polynomial b. */
static double polished(const @PREFIX@ *s, int m, const double *b, double at, const double *u) {
    double y[N], g[E], slope, least = HUGE_VAL, best = at;
    for (int turn = 0; turn < 4; ++turn) {
        event_point(s, at, u, y, g);
        if (!(fabs(g[m]) < least)) break;
        least = fabs(g[m]);
        best = at;
        value_at(b, D, at, &slope);
        at = at - g[m] / slope;
        if (!(at > 0.0 && at < 1.0) || at == best) break;
    }
    return best;
}

/* Insert the roots of event m in the last step, which ends with its expression at end, by their places in
 * the step; t of each is that place until all are known. */
static void roots_in_step(@PREFIX@ *s, int m, const double *end, size_t first, const double *u) {
    double b[D + 1], noise;
    root found[2 * D + 4];
    if (!polynomial(s, m, end, b, &noise)) {
        s->event_before[m] = FAR;
        return;
    }
    const int count = roots_of(b, noise, s->steps == 0, &s->event_before[m], found);
    for (int k = 0; k < count; ++k) {
        if (s->event_direction[m] != 0 && found[k].turn != s->event_direction[m]) continue;
        const double at = found[k].simple ? polished(s, m, b, found[k].at, u) : found[k].at;
        size_t place = s->found_count++;
        for (; place > first && s->found[place - 1].t > at; --place) s->found[place] = s->found[place - 1];
        s->found[place].t = at;
        s->found[place].which = m;
        s->found[place].direction = found[k].turn;
    }
}

/* Report the events of the last step up to its place of stop, or to a terminal event: return which is
 * first, 2 for neither. Of several events at one time all are reported. */
static double first_stop(@PREFIX@ *s, double place, double t_new, const double *x_new, const double *u) {
    const size_t first = s->found_count;
    double end[E], g[E];
    @NAME@_events(t_new, x_new, &s->constants, u, end);
@EVENT_SAMPLES@    for (int m = 0; m < E; ++m) roots_in_step(s, m, end, first, u);
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
    for (int m = 0; m < E; ++m) s->event_value[m] = end[m];
    return place;
}

