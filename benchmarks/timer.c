/* Times a right-hand side inside C, so that nothing of Python is in the figure. */
#define _POSIX_C_SOURCE 199309L
#include <time.h>

typedef void (*rates_t)(double t, const double *x, const void *c, const double *u, double *dx);

/* Return nanoseconds a call. x: count states of n numbers, one after another, taken in turn. */
double nanoseconds(rates_t f, long calls, long count, long n, const double *x, const void *c, const double *u,
                   double *dx) {
    struct timespec begin, end;
    const double *now = x, *last = x + count * n;
    clock_gettime(CLOCK_MONOTONIC, &begin);
    for (long k = 0; k < calls; ++k) {
        f(0.0, now, c, u, dx);
        now += n;
        if (now == last) now = x;
    }
    clock_gettime(CLOCK_MONOTONIC, &end);
    const double seconds = (double)(end.tv_sec - begin.tv_sec);
    return (1e9 * seconds + (double)(end.tv_nsec - begin.tv_nsec)) / (double)calls;
}
