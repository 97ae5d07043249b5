/* Where results go: the states at each step, or at the times of grid. Arrays of the caller:
 * t[capacity], x[capacity][n], and dense[capacity]@DENSE_SHAPE@ or NULL (steps only). Zero it before
 * use. grid: times in the direction of integration, inside [t, t_end], or NULL for every step; with
 * a grid there must be room for all of it. */
typedef struct {
    double *t, *x, *dense;
    const double *grid;
    size_t capacity, count, grid_count, next;
} @PREFIX@_output;

size_t @PREFIX@_size(void);
int @PREFIX@_start(@PREFIX@ *s, const double *p, const double *u);
int @PREFIX@_run(@PREFIX@ *s, const double *u, @PREFIX@_output *o, long long max_steps);
/* The states at a time in the last step; where that was not made with dense output, of Taylor series alone. */
void @PREFIX@_within(const @PREFIX@ *s, double t, const double *u, double *x);
