/* Reference solution and growth of errors of one problem, in quadruple precision.

   Extrapolation of the modified midpoint rule (Gragg; Hairer, Norsett, Wanner, Solving Ordinary
   Differential Equations I, sect. II.9), eight columns, order 16. Before this text stand N, the rates
   `rates(t, x, d)`, `start`, and COUNT segments: `stops` (COUNT + 1 times), `longest` steps, `output`
   where a state is printed, CLIP where rates are never to be read at the very ends of a segment, SAMPLES as below. */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COLUMNS 8
#define FINE 1e-22Q
#define COARSE 1e-17Q
#define CHANGE 1e-9Q /* of a state, relative to its size: the derivative by differences */
#define MOST_STEPS 20000000L

typedef struct { real t; int segment; real x[N]; } Place;

static real size[N];
static Place *path;
static long steps, room;
static real clip_low, clip_high;

static real larger(real a, real b) { return a > b ? a : b; }

static void field(real t, const real *x, real *d) {
    if (CLIP) {
        real low = clip_low < clip_high ? clip_low : clip_high, high = clip_low < clip_high ? clip_high : clip_low;
        real inside = (high - low) * 1e-24Q;
        t = t < low + inside ? low + inside : t > high - inside ? high - inside : t;
    }
    rates(t, x, d);
}

/* One step of length h; returns the error relative to the sizes, infinite where something is not finite. */
static real step(real t, const real *x, real h, real *end) {
    static real table[COLUMNS][N];
    real d[N], before[N], now[N], next[N], last[N], worst = 0;
    for (int j = 0; j < COLUMNS; j++) {
        int n = 2 * (j + 1);
        real part = h / n;
        field(t, x, d);
        for (int i = 0; i < N; i++) { before[i] = x[i]; now[i] = x[i] + part * d[i]; }
        for (int m = 1; m < n; m++) {
            field(t + m * part, now, d);
            for (int i = 0; i < N; i++) { next[i] = before[i] + 2 * part * d[i]; before[i] = now[i]; now[i] = next[i]; }
        }
        field(t + h, now, d);
        for (int i = 0; i < N; i++) {
            real value = (now[i] + before[i] + part * d[i]) / 2;
            for (int k = 0; k < j; k++) {
                real ratio = (real)n / (2 * (j - k));
                real old = table[k][i];
                table[k][i] = value;
                value += (value - old) / (ratio * ratio - 1);
            }
            if (j) last[i] = table[j - 1][i];
            table[j][i] = value;
        }
    }
    for (int i = 0; i < N; i++) {
        end[i] = table[COLUMNS - 1][i];
        real scale = larger(larger(size[i], fabsq(x[i])), fabsq(end[i]));
        real error = fabsq(end[i] - last[i]);
        if (!(error <= 1e4000Q)) return 1e4000Q;
        if (error > 0) worst = larger(worst, error / scale);
    }
    return worst;
}

static void keep(real t, int segment, const real *x) {
    if (steps == room) path = realloc(path, sizeof(Place) * (size_t)(room = room ? 2 * room : 1024));
    path[steps].t = t;
    path[steps].segment = segment;
    memcpy(path[steps++].x, x, sizeof(real) * N);
}

/* Integrate from t in a segment to the end; results go to `found`, one row a stop. */
static int run(real t, int first, real *x, real tolerance, int record, real found[][N]) {
    real way = stops[COUNT] > stops[0] ? 1 : -1, h = 0, end[N];
    long made = 0;
    for (int s = first; s < COUNT; s++) {
        clip_low = stops[s], clip_high = stops[s + 1];
        real most = fabsq(longest[s]);
        if (h == 0 || h > most) h = larger(1e-6Q * most, 1e-30Q);
        while ((stops[s + 1] - t) * way > 0) {
            real rest = fabsq(stops[s + 1] - t), tried = h < most ? h : most;
            int reaches = tried >= rest * 0.999999Q;
            if (reaches) tried = rest;
            real error = step(t, x, way * tried, end) / tolerance;
            real factor = error > 0 ? 0.85Q * powq(error, -1.0Q / 15) : 4;
            factor = factor > 4 ? 4 : factor < 0.05Q ? 0.05Q : factor;
            if (error > 1 && tried > 1e-27Q * (1e-3Q + fabsq(t))) { h = tried * (factor < 0.9Q ? factor : 0.9Q); continue; }
            if (record) keep(t, s, x);
            t = reaches ? stops[s + 1] : t + way * tried;
            memcpy(x, end, sizeof end);
            if (record) for (int i = 0; i < N; i++) size[i] = larger(size[i], fabsq(x[i]));
            if (!reaches || factor < 1) h = tried * factor;
            if (++made > MOST_STEPS) return 0;
        }
        memcpy(found[s + 1], x, sizeof(real) * N);
        t = stops[s + 1];
    }
    return 1;
}

static void show(real value) {
    char text[64];
    quadmath_snprintf(text, sizeof text, "%.34Qg", value);
    printf("%s ", text);
}

static int ascending(const void *a, const void *b) {
    long x = *(const long *)a, y = *(const long *)b;
    return (x > y) - (x < y);
}

/* Steps whose states are changed: evenly by number, and evenly in time; each once, in order. */
static int chosen(long *places) {
    int count = 0, left = 0;
    for (int k = 0; k < SAMPLES; k++) places[count++] = k * steps / SAMPLES;
    for (int k = 0; k < SAMPLES; k++) {
        real at = stops[0] + (stops[COUNT] - stops[0]) * k / SAMPLES;
        long low = 0, high = steps - 1;
        real way = stops[COUNT] > stops[0] ? 1 : -1;
        while (low < high) { long m = (low + high + 1) / 2; if ((path[m].t - at) * way <= 0) low = m; else high = m - 1; }
        places[count++] = low;
    }
    qsort(places, (size_t)count, sizeof *places, ascending);
    for (int k = 0; k < count; k++) if (!left || places[k] != places[left - 1]) places[left++] = places[k];
    return left;
}

int main(void) {
    static real base[COUNT + 1][N], other[COUNT + 1][N], growth[2 * SAMPLES][COUNT + 1];
    long places[2 * SAMPLES];
    real x[N], d[N];
    for (int i = 0; i < N; i++) size[i] = fabsq(x[i] = start[i]);
    if (!run(stops[0], 0, x, FINE, 1, base)) return 1;
    int count = chosen(places);
    for (int i = 0; i < N; i++) if (size[i] == 0) size[i] = 1;
    for (int k = 0; k < count; k++)
        for (int j = 0; j < N; j++) {
            Place p = path[places[k]];
            p.x[j] += CHANGE * size[j];
            if (!run(p.t, p.segment, p.x, COARSE, 0, other)) return 1;
            for (int s = p.segment + 1; s <= COUNT; s++)
                for (int i = 0; i < N; i++)
                    growth[k][s] = larger(growth[k][s], fabsq(other[s][i] - base[s][i]) / (CHANGE * size[i]));
        }
    printf("sizes ");
    for (int i = 0; i < N; i++) show(size[i]);
    for (int s = 1; s <= COUNT; s++) {
        if (!output[s]) continue;
        printf("\nat ");
        show(stops[s]);
        for (int i = 0; i < N; i++) show(base[s][i]);
        real most = 1, along = 0;
        for (int k = 0; k < count && path[places[k]].segment < s; k++) {
            Place p = path[places[k]];
            real until = k + 1 < count && path[places[k + 1]].segment < s ? path[places[k + 1]].t : stops[s], rate = 0;
            clip_low = stops[p.segment], clip_high = stops[p.segment + 1];
            field(p.t, p.x, d);
            for (int i = 0; i < N; i++) rate = larger(rate, fabsq(d[i]) / size[i]);
            most = larger(most, growth[k][s]);
            along += growth[k][s] * rate * fabsq(until - p.t);
        }
        printf("growth ");
        show(larger(most, along));
    }
    printf("\nsteps %ld\n", steps);
    return 0;
}
