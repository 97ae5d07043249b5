
#include <stddef.h>
#include <string.h>

@JOB@
enum { BETWEEN_LOOKS = 100 }; /* steps between two looks at the flag */

@MANY_FUNCTIONS@/* Integrate the trajectories of a job one after the other. */
void @PREFIX@_many(const job_ *o) {
    for (size_t j = 0; j < o->count && *o->halt == 0; ++j) {
        @PREFIX@ s;
        @PREFIX@_output stored;
        double p[@PARAMETERS@ + 1];
        memset(&s, 0, sizeof s);
        memset(&stored, 0, sizeof stored);
        s.t = o->t, s.t_end = o->t_end, s.h_max = o->h_max, s.rtol = o->rtol, s.margin = o->margin;
        for (int i = 0; i < N; ++i) {
            s.x[i] = o->x[i * o->x_row + (ptrdiff_t)j * o->x_column];
            s.atol[i] = o->atol[i * o->atol_row + (ptrdiff_t)j * o->atol_column];
        }
        for (int i = 0; i < @PARAMETERS@; ++i) p[i] = o->p[i * o->p_row + (ptrdiff_t)j * o->p_column];
        stored.t = o->room, stored.x = o->room + o->grid_count, stored.grid = o->grid;
        stored.capacity = stored.grid_count = o->grid_count;
@MANY_BEGIN@        int status = @MANY_START@;
        while (@MANY_GOES_ON@ && *o->halt == 0) {
            const long long left = o->max_steps - s.steps - s.rejected;
            if (left <= 0) break;
            status = @MANY_RUN@, left < BETWEEN_LOOKS ? left : BETWEEN_LOOKS);
@MANY_TAKE@        }
@MANY_END@        for (size_t k = 0; k < stored.count; ++k)
            for (int i = 0; i < N; ++i)
                o->y[(ptrdiff_t)k * o->y_time + i * o->y_row + (ptrdiff_t)j] = stored.x[k * N + (size_t)i];
        for (int i = 0; i < N; ++i) o->x_stop[i * o->stop_row + (ptrdiff_t)j] = s.x[i];
        o->t_stop[j] = s.t;
        o->status[j] = status;
        o->which[j] = status == @UPPER@_SINGULAR || status == @UPPER@_NOT_FINITE ? s.which : -1;
        o->steps[j] = (int)s.steps;
        o->rejected[j] = (int)s.rejected;
    }
}
