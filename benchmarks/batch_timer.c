/* Time batches of one function of many points inside C. */
#define _POSIX_C_SOURCE 200809L
#include <stddef.h>
#include <time.h>

typedef void batch(size_t count, const double *t, ptrdiff_t t_step, const double *x, ptrdiff_t x_row,
                   ptrdiff_t x_column, const double *p, ptrdiff_t p_row, ptrdiff_t p_column,
                   const double *u, ptrdiff_t u_row, ptrdiff_t u_column, double *y, ptrdiff_t y_row,
                   ptrdiff_t y_column);

/* Nanoseconds a point, over so many calls; rows of x and y hold count points. */
double nanoseconds_a_point(batch *f, long calls, size_t count, const double *x, const double *p,
                           const double *u, double *y);

double nanoseconds_a_point(batch *f, long calls, size_t count, const double *x, const double *p,
                           const double *u, double *y) {
    struct timespec start, end;
    const ptrdiff_t n = (ptrdiff_t)count;
    const double t = 0.0;
    clock_gettime(CLOCK_MONOTONIC, &start);
    for (long k = 0; k < calls; ++k) f(count, &t, 0, x, n, 1, p, 1, 0, u, 1, 0, y, n, 1);
    clock_gettime(CLOCK_MONOTONIC, &end);
    const double total = 1e9 * (double)(end.tv_sec - start.tv_sec) + (double)(end.tv_nsec - start.tv_nsec);
    return total / (double)calls / (double)count;
}
