
static int wants(instance *c, int is_allowed, const char *what) {
    if (!is_allowed) say(c, ERROR, "%s is not allowed now", what);
    return is_allowed;
}

static int none(instance *c, size_t count) {
    if (count) say(c, ERROR, "all variables are of type %s", REAL);
    return count ? ERROR : OK;
}

static int has(instance *c, size_t own, const char *what, size_t values) {
    if (own != values)
        say(c, ERROR, "this unit has %lu %s, and not %lu", (unsigned long)own, what, (unsigned long)values);
    return own == values;
}

static int set_up(instance *c, int has_tolerance, double tolerance, double start, int has_stop, double stop) {
    if (!isfinite(start) || (has_stop && !(stop >= start)) || (has_tolerance && !(tolerance > 0.0 && tolerance < 1.0))) {
        say(c, ERROR, "an experiment from %g to %g with the tolerance %g cannot be made", start, stop, tolerance);
        return ERROR;
    }
    if (has_tolerance) c->m.rtol = tolerance;
    c->m.t = start;
    return OK;
}

static int step(instance *c, double t, double length) {
    if (!wants(c, c->mode == STEPPING, CALLED(DoStep))) return ERROR;
    if (!isfinite(length) || !(length > 0.0) || !(fabs(t - c->m.t) <= 1e-9 * (length + fabs(t)))) {
        say(c, ERROR, "no step of %g from %.17g: this unit is at time %.17g", length, t, c->m.t);
        return ERROR;
    }
    return advance(c, &c->m, t + length);
}

EXPORT int CALL(SetDebugLogging)(void *v, flag is_on, size_t count, const char *const categories[]) {
    (void)count, (void)categories;
    ((instance *)v)->is_logging = is_on;
    return OK;
}

EXPORT int CALL(ExitInitializationMode)(void *v) {
    instance *c = v;
    if (!wants(c, c->mode == INITIALIZING, CALLED(ExitInitializationMode))) return ERROR;
    begin_samples(&c->m);
    change_inputs(&c->m);
    c->mode = c->kind == CO_SIMULATION ? STEPPING : EVENTS;
    return OK;
}

EXPORT int CALL(Terminate)(void *v) {
    ((instance *)v)->mode = TERMINATED;
    return OK;
}

EXPORT int CALL(Reset)(void *v) {
    instance *c = v;
    begin(&c->m);
    c->mode = INSTANTIATED;
    return OK;
}

typedef struct { model m; int mode; } kept;

EXPORT int GET_KEPT(void *v, void **state) {
    instance *c = v;
    kept *k = *state ? *state : calloc(1, sizeof *k);
    if (k == NULL) return ERROR;
    k->m = c->m, k->mode = c->mode;
    *state = k;
    return OK;
}

EXPORT int SET_KEPT(void *v, void *state) {
    instance *c = v;
    const kept *k = state;
    c->m = k->m, c->mode = k->mode;
    return OK;
}

EXPORT int FREE_KEPT(void *v, void **state) {
    (void)v;
    free(*state);
    *state = NULL;
    return OK;
}

EXPORT int SIZE_KEPT(void *v, void *state, size_t *size) {
    (void)v, (void)state;
    *size = sizeof(kept);
    return OK;
}

EXPORT int WRITE_KEPT(void *v, void *state, byte bytes[], size_t size) {
    if (size != sizeof(kept)) return say(v, ERROR, "a state has %lu bytes", (unsigned long)sizeof(kept)), ERROR;
    memcpy(bytes, state, size);
    return OK;
}

EXPORT int READ_KEPT(void *v, const byte bytes[], size_t size, void **state) {
    if (size != sizeof(kept)) return say(v, ERROR, "a state has %lu bytes", (unsigned long)sizeof(kept)), ERROR;
    if (*state == NULL) *state = calloc(1, sizeof(kept));
    if (*state == NULL) return ERROR;
    memcpy(*state, bytes, size);
    return OK;
}

EXPORT int CALL(EnterEventMode)(void *v) {
    instance *c = v;
    if (!wants(c, c->mode == CONTINUOUS || c->mode == EVENTS, CALLED(EnterEventMode))) return ERROR;
    c->mode = EVENTS;
    return OK;
}

EXPORT int CALL(EnterContinuousTimeMode)(void *v) {
    instance *c = v;
    if (!wants(c, c->mode == EVENTS, CALLED(EnterContinuousTimeMode))) return ERROR;
    c->mode = CONTINUOUS;
    return OK;
}

EXPORT int CALL(CompletedIntegratorStep)(void *v, flag is_final, flag *enter_events, flag *terminate) {
    instance *c = v;
    (void)is_final;
    *enter_events = 0;
    *terminate = is_singular(c, &c->m);
    return OK;
}

EXPORT int CALL(SetTime)(void *v, double t) {
    instance *c = v;
    if (!isfinite(t)) return say(c, ERROR, "time is given a value that is not finite: %g", t), ERROR;
    c->m.t = t;
    return OK;
}

static const char STATES[] = "continuous states";

EXPORT int CALL(SetContinuousStates)(void *v, const double x[], size_t count) {
    instance *c = v;
    return has(c, N, STATES, count) ? set_states(c, &c->m, x) : ERROR;
}

EXPORT int GET_RATES(void *v, double rates[], size_t count) {
    instance *c = v;
    return has(c, N, STATES, count) ? get_range(c, &c->m, RATE, count, rates) : ERROR;
}

EXPORT int CALL(GetEventIndicators)(void *v, double indicators[], size_t count) {
    instance *c = v;
    return has(c, E, "event indicators", count) ? get_range(c, &c->m, INDICATOR, count, indicators) : ERROR;
}

EXPORT int CALL(GetContinuousStates)(void *v, double x[], size_t count) {
    instance *c = v;
    return has(c, N, STATES, count) ? get_range(c, &c->m, STATE, count, x) : ERROR;
}

EXPORT int CALL(GetNominalsOfContinuousStates)(void *v, double nominals[], size_t count) {
    if (!has(v, N, STATES, count)) return ERROR;
    for (size_t i = 0; i < count; ++i) nominals[i] = 1.0;
    return OK;
}
