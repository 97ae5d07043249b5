/* At least the distance from t to the next double. */
static inline double spacing(double t) {
    const double relative = DBL_EPSILON * fabs(t);
    return relative > DBL_MIN ? relative : DBL_MIN;
}

/* a + b exactly as a rounded sum and what was lost (Knuth, 1969). */
static inline double two_sum(double a, double b, double *lost) {
    const double sum = a + b, part = sum - a;
    *lost = (a - (sum - part)) + (b - part);
    return sum;
}

static int first_bad(const double *x) {
    for (int i = 0; i < N; ++i)
        if (!isfinite(x[i])) return i;
    return -1;
}

