
/* Laws that are evaluated at samples: their inputs are held between these, and steps end there. The loop above
 * sees inputs that are held until its t_end, where it asks next_piece whether it goes on.
 *
 * Sample k of a law is at start + k period, its values take effect at the time of sample k + whole, and rest
 * later. places: of the inputs that are set, count, then of those that are states and change at the sample
 * itself, all; first: where their values begin; waits: whether there is a delay. call: gives the values of a law that is not generated; not 0: it failed. */
typedef struct {
    double period, rest, next, effect; /* when it is due, and when what waits takes effect, or never */
    long long whole, taken, applied, due, waits, count, all, room, first, last_in, last_out;
    const long long *places;
    double *waiting; /* a ring of room rows of count values */
    int (*call)(double t);
} @PREFIX@_law;

/* rows: times and inputs after each change, where they are asked for; the run is given back when they are full.
 * only: whether there is but one law, generated and without a delay. */
struct @PREFIX@_samples_ {
    @PREFIX@ *s;
    const double *p;
    double *u, *values, *rows;
    @PREFIX@_law *laws;
    long long count, room, kept, only;
    double start, end, last, h; /* last: no sample is later; h: the step that was due where the inputs changed last */
    long long rejected;
@MARKED@};

/* Times that are so many spacings apart are one: multiples of different periods are rounded differently. */
#define SAME 4.0

enum { @UPPER@_FAILED = 8 /* a law that is called has failed */ };

size_t @PREFIX@_samples_size(void) { return sizeof(@PREFIX@_samples); }

/* The product is rounded by itself, as it is elsewhere. */
static double sample_time(const @PREFIX@_samples *o, const @PREFIX@_law *l, long long k) {
    volatile double along = (double)k * l->period;
    return o->start + along;
}

static double effect_time(const @PREFIX@_samples *o, const @PREFIX@_law *l, long long k) {
    return sample_time(o, l, k + l->whole) + l->rest;
}

/* The next time at which a sample is due, or takes effect. */
static double next_of_all(const @PREFIX@_samples *o) {
    double next = HUGE_VAL;
    for (const @PREFIX@_law *l = o->laws; l < o->laws + o->count; ++l) {
        if (l->next < next) next = l->next;
        if (l->effect < next) next = l->effect;
    }
    return next;
}

/* That, or the end. */
static inline double next_change(const @PREFIX@_samples *o) {
    const double next = o->only ? o->laws->next : next_of_all(o);
    return next < o->last ? next : o->end;
}

static inline long long behind(const @PREFIX@_law *l, long long row) { return row + 1 == l->room ? 0 : row + 1; }

/* Evaluate the laws that are due, over what was there before; not 0: one of them failed. */
static int take_samples(@PREFIX@_samples *o, double t, double until) {
    const @PREFIX@_law *const behind_all = o->laws + o->count;
    int generated = 0;
    for (@PREFIX@_law *l = o->laws; l < behind_all; ++l) {
        l->due = l->next <= until;
        if (!l->due) continue;
        if (l->call) {
            if (l->call(t) != 0) return 1;
        } else if (!generated) {
            @SAMPLE@
            generated = 1;
        }
        if (l->waits) {
            l->last_in = behind(l, l->last_in);
            double *row = l->waiting + l->last_in * l->count;
            for (long long i = 0; i < l->count; ++i) row[i] = o->values[l->first + i];
            if (l->applied == l->taken) l->effect = effect_time(o, l, l->taken);
        }
        l->taken += 1;
        l->next = sample_time(o, l, l->taken);
    }
    return 0;
}

static void apply(@PREFIX@_samples *o, double until) {
    const @PREFIX@_law *const behind_all = o->laws + o->count;
    for (@PREFIX@_law *l = o->laws; l < behind_all; ++l) {
        const double *value = o->values + l->first;
        for (long long i = l->due ? (l->waits ? l->count : 0) : l->all; i < l->all; ++i) o->u[l->places[i]] = value[i];
        while (l->effect <= until) {
            l->last_out = behind(l, l->last_out);
            const double *row = l->waiting + l->last_out * l->count;
            for (long long i = 0; i < l->count; ++i) o->u[l->places[i]] = row[i];
            l->applied += 1;
            l->effect = l->applied < l->taken ? effect_time(o, l, l->applied) : HUGE_VAL;
        }
    }
}

/* The one law that there is, generated and without a delay, is due wherever inputs change. */
static inline void take_only(@PREFIX@_samples *o, double t) {
    @PREFIX@_law *l = o->laws;
    double *restrict u = o->u;
    const double *restrict value = o->values;
    const long long *restrict place = l->places, *const last = place + l->all;
    (void)t;
    @SAMPLE_ONLY@
    do u[*place] = *value++;
    while (++place != last);
    l->taken += 1;
    l->next = sample_time(o, l, l->taken);
}

#ifdef __GNUC__
__attribute__((noinline)) /* so that it costs nothing where there is but one law */
#endif
static int take_all(@PREFIX@_samples *o, double t) {
    const double until = t + SAME * spacing(t);
    if (take_samples(o, t, until)) return 1;
    apply(o, until);
    return 0;
}

static inline int change_inputs(@PREFIX@_samples *o, double t) {
    if (o->only) take_only(o, t);
    else if (take_all(o, t)) return 1;
    if (o->room > 0) {
        double *restrict row = o->rows + o->kept++ * (@INPUTS@ + 1);
        const double *restrict u = o->u;
        row[0] = t;
        for (int i = 0; i < @INPUTS@; ++i) row[i + 1] = u[i];
    }
    return 0;
}

#ifdef E
/* An event jumps where it reads an input that does: over zero it happens at that time. Whether it stops the run. */
static int events_jump(@PREFIX@ *s, const double *u) {
    double g[2 * E];
    int stops = 0;
    @NAME@_events(s->t, s->x, &s->constants, u, g);
    for (int m = 0; m < E; ++m) {
        const int before = sign_of(s->event_value[m]), after = sign_of(g[m]), turn = before < 0 ? 1 : -1;
        if (g[m] == s->event_value[m]) continue;
        s->event_before[m] = FAR;
        if (before == 0 || after == before || (s->event_direction[m] != 0 && s->event_direction[m] != turn)) continue;
        @PREFIX@_event *event = &s->found[s->found_count++];
        event->t = s->t;
        for (int i = 0; i < N; ++i) event->x[i] = s->x[i];
        event->which = m, event->direction = turn;
        if (s->event_stop[m] <= 0 || --s->event_stop[m] > 0 || stops) continue;
        s->which = m;
        stops = 1;
    }
    for (int m = 0; m < 2 * E; ++m) s->event_value[m] = g[m];
    return stops;
}
#endif

/* What the inputs change where a step begins. PAUSED, or why no step can be made. */
static inline int refresh(@PREFIX@_samples *o) {
    @PREFIX@ *s = o->s;
    const double *u = o->u;
@REFRESH@#if S
    @NAME@_singularities(s->t, s->x, &s->constants, u, s->singular);
    for (int m = 0; m < S; ++m) {
        s->closest[m] = fmin(s->closest[m], fabs(s->singular[m]));
        if (!(fabs(s->singular[m]) <= s->margin)) continue;
        s->which = m;
        return s->status = @UPPER@_SINGULAR;
    }
#endif
#ifdef E
    if (events_jump(s, u)) return s->status = @UPPER@_EVENT;
#endif
    (void)u;
    return s->status = @UPPER@_PAUSED;
}

@EQUAL@/* Remember where a piece with held inputs begins, and up to where it goes. */
static inline void mark(@PREFIX@_samples *o, const @PREFIX@_output *out) {
    @PREFIX@ *s = o->s;
@BEFORE@    s->t_end = next_change(o);
    o->rejected = s->rejected;
    (void)out;
@MARK@}

/* In place of @PREFIX@_start: takes the first samples; t_end is the end of the run. */
int @PREFIX@_start_sampled(@PREFIX@_samples *o, const @PREFIX@_output *out) {
    @PREFIX@ *s = o->s;
    o->start = s->t, o->end = s->t_end, o->kept = 0;
    o->last = o->end - SAME * spacing(o->end);
    o->only = o->count == 1 && !o->laws->call && !o->laws->waits && o->laws->all > 0;
    for (@PREFIX@_law *l = o->laws; l < o->laws + o->count; ++l) {
        l->next = s->t, l->effect = HUGE_VAL;
        l->taken = l->applied = l->last_in = l->last_out = 0;
    }
    @NAME@_prepare(o->p, &s->constants);
    if (change_inputs(o, s->t)) return s->status = @UPPER@_FAILED;
    const int status = @PREFIX@_start(s, o->p, o->u);
    o->h = s->h;
    mark(o, out);
    return status;
}

/* At t_end of a piece with held inputs: whether the loop goes on with the next one; if not, status says why. */
static int next_piece(@PREFIX@_samples *o, const @PREFIX@_output *out) {
    @PREFIX@ *s = o->s;
    int full = o->room > 0 && o->kept == o->room;
    if (s->t == o->end) {
        s->status = @UPPER@_DONE;
        return 0;
    }
#ifdef E
    full |= s->found_room - s->found_count < E;
#endif
    if (full) s->status = @UPPER@_FULL;
    else if (change_inputs(o, s->t)) s->status = @UPPER@_FAILED;
    else if (refresh(o) == @UPPER@_PAUSED) {
        mark(o, out);
        return 1;
    }
    return 0;
}

/* In place of @PREFIX@_run. */
int @PREFIX@_run_sampled(@PREFIX@_samples *o, @PREFIX@_output *out, long long max_steps) {
@AGAIN@}
