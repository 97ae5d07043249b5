/* Roots on [0, 1] of polynomials in Bernstein form, b_0 to b_n for sum b_j C(n,j) x^j (1-x)^(n-j).
 *
 * The b_j change sign as often as the polynomial has roots inside, or more often by an even number (Lane
 * and Riesenfeld, Bounds on a polynomial, BIT 21 (1981)). Where they do so more than once the interval is
 * halved by de Casteljau's algorithm, which needs no other root to be known; an interval on which all b_j
 * are within the rounding error ("noise") of the polynomial is not. Signs at 0 and 1 are those of b_0 and
 * b_n, whatever the rounding of the others. */
enum { HALVINGS = 50 };

/* How the polynomial of one interval ends, for the next: an end within the noise of zero belongs to a root
 * that was reported, or zero is approached there, and perhaps touched just after. */
enum { FAR, APPROACHED, REPORTED };

/* turn: 1 where the polynomial goes up through zero, -1 down, 0 where it touches zero. simple: whether
 * nothing but a crossing is there within the noise. */
typedef struct {
    double at;
    int turn, simple;
} root;

static int sign_of(double a) { return (a > 0.0) - (a < 0.0); }

/* The polynomial and its slope at x, by de Casteljau's algorithm. */
static double value_at(const double *b, int n, double x, double *slope) {
    double c[D + 1];
    for (int j = 0; j <= n; ++j) c[j] = b[j];
    for (int rest = n; rest > 1; --rest)
        for (int j = 0; j < rest; ++j) c[j] = (1.0 - x) * c[j] + x * c[j + 1];
    *slope = n * (c[1] - c[0]);
    return (1.0 - x) * c[0] + x * c[1];
}

/* The one root of a polynomial that has the sign before at 0 and the other at 1: Newton's method, and
 * halving where it leaves the bracket or does not halve its steps. */
static double only_root(const double *b, int n, int before) {
    double low = 0.0, high = 1.0, step = 1.0, last = 1.0, slope;
    double x = b[0] != 0.0 && b[n] != 0.0 ? b[0] / (b[0] - b[n]) : 0.5;
    for (int turn = 0; turn < 200; ++turn) {
        const double value = value_at(b, n, x, &slope);
        if (value == 0.0) return x;
        if (sign_of(value) == before) low = x;
        else high = x;
        double next = x - value / slope;
        if (!(next > low && next < high && fabs(next - x) <= 0.5 * fabs(last))) next = 0.5 * (low + high);
        last = step;
        step = next - x;
        if (fabs(step) <= 0.5 * DBL_EPSILON * next || next == x) return next;
        x = next;
    }
    return x;
}

/* Changes of sign among b_0 to b_n; the first and the last sign, 0 where all are zero. */
static int changes_of_sign(const double *b, int n, int *first, int *last) {
    int count = 0;
    *first = *last = 0;
    for (int j = 0; j <= n; ++j) {
        const int sign = sign_of(b[j]);
        if (sign == 0) continue;
        if (*first == 0) *first = sign;
        else count += sign != *last;
        *last = sign;
    }
    return count;
}

static double largest(const double *b, int n) {
    double size = 0.0;
    for (int j = 0; j <= n; ++j) size = fmax(size, fabs(b[j]));
    return size;
}

/* The crossings of zero in order, at most n. flat: whether zero may also be touched, within the noise. */
static int crossings(const double *b, int n, double noise, root *found, int *flat) {
    double waiting[HALVINGS + 2][D + 1], low[HALVINGS + 2], high[HALVINGS + 2], known = 0.0;
    int count = 0, side = 0, top = 1, first, last;
    low[0] = 0.0, high[0] = 1.0, *flat = 0;
    for (int j = 0; j <= n; ++j) waiting[0][j] = b[j];
    while (top > 0) { /* side: the sign before; known: how far it is known */
        double *c = waiting[--top];
        const double left = low[top], right = high[top];
        const int changes = changes_of_sign(c, n, &first, &last);
        if (changes > 1 && top <= HALVINGS && largest(c, n) > noise) {
            double *other = waiting[top + 1];
            for (int rest = n; rest > 0; --rest) {
                other[n - rest] = c[0];
                for (int j = 0; j < rest; ++j) c[j] = 0.5 * c[j] + 0.5 * c[j + 1];
            }
            other[n] = c[0];
            low[top] = high[top + 1] = 0.5 * (left + right);
            low[top + 1] = left;
            top += 2;
            continue;
        }
        *flat |= changes > 1 || (left > 0.0 && fabs(c[0]) <= noise) || (right < 1.0 && fabs(c[n]) <= noise);
        if (changes > 1 || first == 0) continue; /* its sign is not known: the next piece shows it */
        if (side != 0 && first != side) found[count++] = (root){0.5 * (known + left), first, 0};
        if (changes == 1) found[count++] = (root){left + (right - left) * only_root(c, n, first), last, 1};
        side = last;
        known = right;
    }
    return count;
}

