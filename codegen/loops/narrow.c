#define FIRST @RATES@
#define W @WATCHED@ /* rates, then the values that are watched beside them */
#define COLUMNS @COLUMNS@
#define GUARDED @GUARDED@
#define GUARDS @GUARDS@
#define PIECES @PIECES@
#define SEEN @SEEN_COUNT@

/* Stages in order of time that stand apart, where, and one over the distance of each from the next. */
static const int seen[SEEN] = {@SEEN@};
static const double place[SEEN] = {@PLACES@};
static const double nearness[SEEN - 1] = {@NEARNESS@};

#if GUARDED
/* A movement of each guarded value that is always allowed: a share of the value, or so much of it. Of some
 * only the way towards zero counts. */
static const double soon_share[GUARDED] = {@SOON_SHARES@}, soon_length[GUARDED] = {@SOON_LENGTHS@};
static const int to_zero[GUARDED] = {@TO_ZERO@};

static int is_allowed(int c, double here, double down, double up) {
    const double nearer = here < 0.0 ? up : down, further = here < 0.0 ? down : up;
    const double move = to_zero[c] || nearer > further ? nearer : further;
    return (move <= soon_share[c] * fabs(here)) | (move <= soon_length[c]);
}
#endif

/* How fast a watched value moves between stages, over the length of the step; none before and behind them. */
static inline void paces(double k[][W], int c, double *slope) {
    slope[0] = slope[SEEN] = 0.0;
    for (int m = 0; m < SEEN - 1; ++m)
        slope[m + 1] = fabs(k[seen[m + 1]][FIRST + c] - k[seen[m]][FIRST + c]) * nearness[m];
}

/* Half the second derivative of a watched value at a stage where it turns round, as the parabola through that and
 * the stages beside it has; 0 elsewhere. */
static inline double bend(double k[][W], int c, int m) {
    if (m < 1 || m > SEEN - 2) return 0.0;
    const double v = k[seen[m]][FIRST + c];
    const double left = (v - k[seen[m - 1]][FIRST + c]) * nearness[m - 1];
    const double right = (k[seen[m + 1]][FIRST + c] - v) * nearness[m];
    return left * right < 0.0 ? (right - left) / (place[m + 1] - place[m - 1]) : 0.0;
}

/* Bounds of a watched value between two stages, widened to these: it moves no faster than beside them, and goes
 * no further beyond a stage where it turns round than a parabola does within half the distance. */
static inline void widen(double k[][W], int c, const double *slope, int gap, double *low, double *high) {
    const double before = slope[gap], after = slope[gap + 2];
    double steepest = slope[gap + 1];
    steepest = before > steepest ? before : steepest;
    steepest = after > steepest ? after : steepest;
    const double reach = 0.5 * (place[gap + 1] - place[gap]) * steepest;
    const double middle = 0.5 * (k[seen[gap]][FIRST + c] + k[seen[gap + 1]][FIRST + c]);
    *low = middle - reach < *low ? middle - reach : *low;
    *high = middle + reach > *high ? middle + reach : *high;
    const double half = 0.5 * (place[gap + 1] - place[gap]);
    for (int m = gap; m <= gap + 1; ++m) {
        const double summit = k[seen[m]][FIRST + c] - half * half * bend(k, c, m);
        *low = summit < *low ? summit : *low;
        *high = summit > *high ? summit : *high;
    }
}

/* The least and the largest of a watched value at the stages. */
static inline void extremes(double k[][W], int c, double *least, double *most) {
    *least = *most = k[0][FIRST + c];
    for (int m = 1; m < SEEN; ++m) {
        const double v = k[seen[m]][FIRST + c];
        *least = v < *least ? v : *least;
        *most = v > *most ? v : *most;
    }
}

/* A watched value at the begin of a step, the least and the largest of all of it. A divisor, or what goes into a
 * logarithm, that has one sign at all stages keeps it. */
static void span_of(double k[][W], int c, double *x) {
    double slope[SEEN + 1], least, most;
    paces(k, c, slope);
    extremes(k, c, &least, &most);
    double low = least, high = most;
    for (int gap = 0; gap < SEEN - 1; ++gap) widen(k, c, slope, gap, &low, &high);
#if GUARDED
    if (c < GUARDED && to_zero[c] && least > 0.0 && low < 1e-3 * least) low = 1e-3 * least;
    if (c < GUARDED && to_zero[c] && most < 0.0 && high > 1e-3 * most) high = 1e-3 * most;
#endif
    x[0] = k[0][FIRST + c], x[1] = low, x[2] = high;
}

#if GUARDED && !PIECES
/* Whether every guarded value moves so little that its bounds are within what is always allowed. Most do by
 * their stages alone: bounds are beyond these by @BEYOND@ times what lies between the extremes at most. */
static int is_quiet(double k[][W]) {
    for (int c = 0; c < GUARDED; ++c) {
        const double here = k[0][FIRST + c];
        double least, most, x[3];
        extremes(k, c, &least, &most);
        const double beyond = @BEYOND@ * (most - least);
        if (is_allowed(c, here, here - least + beyond, most - here + beyond)) continue;
        span_of(k, c, x);
        if (!is_allowed(c, here, here - x[1], x[2] - here)) return 0;
    }
    return 1;
}
#endif

static void judge(const @PREFIX@ *s, double x[][3], double *y) {
    double slot[3 * COLUMNS + 1];
    for (int c = 0; c < COLUMNS; ++c)
        for (int i = 0; i < 3; ++i) slot[3 * c + i] = x[c][i];
    slot[3 * COLUMNS] = @DEPTH@ - log(s->rtol);
    @PREFIX@_verdict(0.0, slot, 1, NULL, NULL, NULL, 1, y, 1);
}

/* The least share of the step that an operation allows, from the bounds x. */
static double share_of(const double *y) {
    double share = 1.0;
    for (int g = 0; g < GUARDS; ++g) share = fmin(share, y[g]);
    return share;
}

#if PIECES
static int stays(const double *y) {
    for (int p = 0; p < PIECES; ++p)
        if (y[GUARDS + p] == 0.0) return 0;
    return 1;
}

/* Where in the step a piece first changes, as watched values go straight between stages; *sure is 0 where
 * it may change, but has not at either stage. 2 where none does. */
static double first_passage(const @PREFIX@ *s, double k[][W], int *sure) {
    double slope[COLUMNS][SEEN + 1], x[COLUMNS][3], y[GUARDS + PIECES];
    for (int c = 0; c < COLUMNS; ++c) paces(k, c, slope[c]);
    for (int gap = 0; gap < SEEN - 1; ++gap) {
        const double *v = k[seen[gap]] + FIRST, *next = k[seen[gap + 1]] + FIRST;
        for (int c = 0; c < COLUMNS; ++c) {
            x[c][0] = v[c], x[c][1] = fmin(v[c], next[c]), x[c][2] = fmax(v[c], next[c]);
            widen(k, c, slope[c], gap, &x[c][1], &x[c][2]);
        }
        judge(s, x, y);
        if (stays(y)) continue;
        const double length = place[gap + 1] - place[gap];
        double low = 0.0, high = 1.0;
        for (int turn = 0; turn < 54; ++turn) {
            const double part = turn == 0 ? 1.0 : 0.5 * (low + high);
            for (int c = 0; c < COLUMNS; ++c) {
                const double there = v[c] + part * (next[c] - v[c]);
                x[c][1] = fmin(v[c], there), x[c][2] = fmax(v[c], there);
            }
            judge(s, x, y);
            if (turn == 0) *sure = !stays(y);
            if (!*sure) return place[gap] + 0.25 * length;
            if (stays(y)) low = part;
            else high = part;
        }
        return place[gap] + high * length;
    }
    return 2.0;
}

/* Whether a step must be made shorter since a piece changes in it. One as short as `near` passes the change. */
static int passes(@PREFIX@ *s, double k[][W], double h) {
    const double longest = fmax(s->wanted, fabs(h)), near = fmax(32.0 * spacing(s->t), 1e-3 * s->rtol * longest);
    int sure = 1;
    if (s->crowded > @CROWDED@ && fabs(h) <= 64.0 * near) return 0;
    const double at = first_passage(s, k, &sure);
    s->tries = at > 1.0 ? 0 : s->tries + 1;
    if (at > 1.0) return 0;
    if (fabs(h) <= 1.001 * near || s->tries > 100) {
        const int is_crowded = fabs(s->t - s->passed) <= 8.0 * near;
        s->crowded = is_crowded ? s->crowded + 1 : 0;
        s->passed = s->t;
        s->passing = 1;
        return 0;
    }
    const double target = at * fabs(h);
    s->wanted = longest;
    s->h = !sure ? fmax(target, near) : (target > 1.75 * near ? target - 0.75 * near : near);
    s->rejected += 1;
    return 1;
}
#endif

/* Whether a step is not taken since what is watched moves too far in it, and a shorter one is proposed. */
static int is_cut(@PREFIX@ *s, double k[][W], double h) {
    double x[COLUMNS][3], y[GUARDS + PIECES];
    s->passing = 0;
#if GUARDED && !PIECES
    if (is_quiet(k)) return 0;
#endif
    for (int c = 0; c < COLUMNS; ++c) span_of(k, c, x[c]);
    const double least = fmax(64.0 * spacing(s->t), 1e-13 * fabs(s->t_end - s->t));
    judge(s, x, y);
    const double share = share_of(y);
    if (share < 1.0 && fabs(h) > least) {
        s->h = fabs(h) * fmax(0.1, 0.9 * share);
        s->rejected += 1;
        return 1;
    }
#if PIECES
    if (!stays(y)) return passes(s, k, h);
#endif
    s->tries = 0;
    return 0;
}

/* After a step: the next one is as long as it was to be before a change of piece, and no longer than what is
 * watched allows if it moves on as it did last. */
static void foresee(@PREFIX@ *s, double k[][W], double h) {
    if (s->passing) {
        s->h = fmax(s->h, s->wanted);
        s->wanted = 0.0;
    }
#if GUARDS
    double x[COLUMNS][3], y[GUARDS + PIECES];
    const double part = s->h / (fabs(h) * (place[SEEN - 1] - place[SEEN - 2]));
    int quiet = 1;
    for (int c = 0; c < GUARDED; ++c) {
        const double here = k[seen[SEEN - 1]][FIRST + c], move = part * (here - k[seen[SEEN - 2]][FIRST + c]);
        quiet &= is_allowed(c, here, -move, move);
    }
    if (quiet) return;
    for (int c = 0; c < COLUMNS; ++c) {
        const double here = k[seen[SEEN - 1]][FIRST + c], there = here + part * (here - k[seen[SEEN - 2]][FIRST + c]);
        x[c][0] = here;
        x[c][1] = c < GUARDED ? fmin(here, there) : here;
        x[c][2] = c < GUARDED ? fmax(here, there) : here;
    }
    judge(s, x, y);
    const double share = share_of(y);
    if (share < 0.5) s->h *= fmax(0.05, 1.8 * share); /* a guess: what moves less may well slow down */
#else
    (void)k, (void)h;
#endif
}

