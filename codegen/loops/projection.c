/* Invariant and state of each derivative, and which states have one unit and are measured together. */
static const int row_of[@ROOM@] = {@ROWS@}, column_of[@ROOM@] = {@COLUMNS@}, unit_of[N] = {@UNITS@};

/* The derivatives by the states over their scales, and how far rounding alone can move each invariant. */
static void gradients(const double *value, const double *x, const double *scale, double a[][N], double *noise) {
    for (int k = 0; k < @COUNT@; ++k) {
        noise[k] = fabs(value[k]);
        for (int i = 0; i < N; ++i) a[k][i] = 0.0;
    }
    for (int e = 0; e < @ENTRIES@; ++e) {
        const double slope = value[2 * @COUNT@ + e];
        a[row_of[e]][column_of[e]] = slope * scale[column_of[e]];
        noise[row_of[e]] += fabs(slope * x[column_of[e]]);
    }
    for (int k = 0; k < @COUNT@; ++k) noise[k] *= 2.0 * DBL_EPSILON;
}

static double product(const double *a, const double *b) {
    double sum = 0.0;
    for (int i = 0; i < N; ++i) sum += a[i] * b[i];
    return sum;
}

/* The least change, in scaled states, that takes the invariants to their targets: orthogonalised one by
 * one, the one with most left of its gradient first. A gradient counts while rounding moves the state
 * along what is left of it by less than a part of the tolerance. Whether there is any change. */
static int least_change(double a[][N], double *left, const double *noise, double allowed, double *change) {
    double whole[@COUNT@], spread[@COUNT@]; /* spread: noise, with that of the invariants before */
    int free[@COUNT@], moved = 0;
    for (int k = 0; k < @COUNT@; ++k) moved |= fabs(left[k]) > noise[k];
    if (!moved) return 0;
    moved = 0;
    for (int i = 0; i < N; ++i) change[i] = 0.0;
    for (int k = 0; k < @COUNT@; ++k) {
        whole[k] = sqrt(product(a[k], a[k]));
        spread[k] = noise[k];
        free[k] = 1;
    }
    for (;;) {
        double most = 0.0, square = 0.0;
        int best = -1;
        for (int k = 0; k < @COUNT@; ++k) {
            const double rest = product(a[k], a[k]), length = sqrt(rest);
            if (!free[k] || !(length * allowed > spread[k]) || !(length > most * whole[k])) continue;
            most = length / whole[k];
            square = rest;
            best = k;
        }
        if (best < 0) return moved && product(change, change) < 0.0625;
        free[best] = 0;
        const double step = fabs(left[best]) > noise[best] ? left[best] / square : 0.0;
        moved |= step != 0.0;
        for (int i = 0; i < N; ++i) change[i] += step * a[best][i];
        for (int k = 0; k < @COUNT@; ++k) {
            if (!free[k]) continue;
            const double part = product(a[k], a[best]) / square;
            left[k] -= step * part * square;
            spread[k] += fabs(part) * spread[best];
            for (int i = 0; i < N; ++i) a[k][i] -= part * a[best][i];
        }
    }
}

/* Bring x, with what its rounding lost in x_low, back onto the invariants (Hairer, Lubich and Wanner,
 * Geometric Numerical Integration, 2nd ed., sect. IV.4, algorithm 4.2). Whether x was moved. */
static int project(const @PREFIX@ *s, double t, double *x, double *x_low, const double *u) {
    const double allowed = fmax(s->rtol, 1024.0 * DBL_EPSILON) / 16.0;
    int moved = 0;
    for (int turn = 0; turn < 4; ++turn) {
        double value[2 * @COUNT@ + @ENTRIES@], a[@COUNT@][N], left[@COUNT@], noise[@COUNT@];
        double largest[@UNIT_COUNT@] = {0.0}, scale[N], change[N];
        for (int i = 0; i < N; ++i)
            largest[unit_of[i]] = fmax(largest[unit_of[i]], fmax(fabs(x[i]), s->atol[i] / s->rtol));
        for (int i = 0; i < N; ++i) scale[i] = largest[unit_of[i]];
        @NAME@_projection(t, x, &s->constants, u, value);
        for (int k = 0; k < @COUNT@; ++k) left[k] = value[@COUNT@ + k] - value[k];
        gradients(value, x, scale, a, noise);
        if (!least_change(a, left, noise, allowed, change)) return moved;
        for (int i = 0; i < N; ++i) x[i] = two_sum(x[i], x_low[i] + scale[i] * change[i], &x_low[i]);
        moved = 1;
    }
    return moved;
}

/* The same for a state between two steps. */
static void project_point(const @PREFIX@ *s, double t, double *x, const double *u) {
    double lost[N] = {0.0};
    project(s, t, x, lost, u);
}

