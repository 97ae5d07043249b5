#ifndef @UPPER@_H
#define @UPPER@_H

#include "@NAME@.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    @UPPER@_NOT_FINITE = -2,     /* NaN or infinity in state or rate number "which" */
    @UPPER@_STEP_TOO_SMALL = -1, /* the tolerance cannot be met, or a step is below the resolution of time */
    @UPPER@_DONE = 0,            /* t_end is reached */
    @UPPER@_SINGULAR = 1,        /* singularity number "which" is within the margin, at time t */
    @UPPER@_FULL = 2,
    @UPPER@_PAUSED = 3,
@FURTHER_STATUS@@EVENT_STATUS@    @UPPER@_TOO_SMALL = 4        /* with a grid: fewer free places than grid points; nothing is done */
};
