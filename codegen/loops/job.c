/* Many trajectories. Number j starts at t with the states x[i * x_row + j * x_column] and the parameters
 * p[i * p_row + j * p_column], and is held to atol[i * atol_row + j * atol_column]; a column of 0 is one
 * vector for all. Its state i at grid[k] goes to
 * y[k * y_time + i * y_row + j], where it stopped to t_stop[j] and x_stop[i * stop_row + j], and why to
 * status[j] and which[j]. Grid points that it does not reach are left as they are. room: as many doubles
 * as grid points of n + 1. Once *halt is not 0 the job is left as it is, within a few steps.
 * Where laws are sampled: so many of them, with room for their values; input i that was held at grid[k] goes
 * to held_at[(k * inputs + i) * count + j]. */
typedef struct {
    double t, t_end, h_max, rtol, margin;
    const double *atol, *u, *grid, *x, *p;
    double *y, *t_stop, *x_stop, *room;
    int *status, *which, *steps, *rejected;
    ptrdiff_t x_row, x_column, p_row, p_column, atol_row, atol_column, y_row, y_time, stop_row;
    size_t count, grid_count;
    long long max_steps;
    const volatile int *halt;
    void *laws;
    size_t law_count;
    double *law_values, *held_at;
} job_;
