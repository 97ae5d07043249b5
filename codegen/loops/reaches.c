#define LINEAR @LINEAR@
#define CURVED @CURVED@

/* How far an argument with the coefficients q[1], q[2], ... moves in the time h, at most, in any direction of
 * the complex plane. The last two terms count twice: what follows them falls at least like a half. */
static inline double moved(const double *q, double h) {
    const double square = h * h;
    double one = 2.0 * fabs(q[P - 1]), other = 2.0 * fabs(q[P - 2]);
    for (int k = P - 3; k > 0; k -= 2) {
        one = one * square + fabs(q[k]);
        if (k > 1) other = other * square + fabs(q[k - 1]);
    }
    return P % 2 ? h * (other + h * one) : h * (one + h * other);
}

/* The longest step, to within 2 %, in which an argument moves by its limit q[0] at most. */
static double shortened(const double *q, double h, double smallest) {
    double far = h;
    while (h > smallest && !(moved(q, h) <= q[0])) {
        far = h;
        h *= 0.125;
    }
    for (int k = 0; k < 7; ++k) {
        const double between = sqrt(h) * sqrt(far);
        if (moved(q, between) <= q[0]) h = between;
        else far = between;
    }
    return h;
}

/* The part of a step h in which every argument stays where its series may be trusted (codegen/watch/trust.py). */
static inline double within_reach(const double *q, double h, double smallest) {
    if (LINEAR && !(h <= q[0])) h = q[0];
    for (int m = 0; m < CURVED; ++m) {
        const double *row = q + LINEAR + m * P;
        if (!(moved(row, h) <= row[0])) h = shortened(row, h, smallest);
    }
    return h;
}

