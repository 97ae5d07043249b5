
/* The functions of FMI 3.0 (Functional Mock-up Interface Specification, version 3.0.1, sections 2.2 to 5),
 * declared here as that standard defines them. */
#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef void (*logger)(void *environment, int status, const char *category, const char *message);

struct instance {
    model m;
    int kind, mode, is_logging;
    logger log;
    void *environment;
};

static void say(instance *c, int status, const char *format, ...) {
    char text[400];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (c->log && (c->is_logging || status == ERROR))
        c->log(c->environment, status, status == ERROR ? "logStatusError" : "logStatusDiscard", text);
}

static int wants(instance *c, int is_allowed, const char *what) {
    if (!is_allowed) say(c, ERROR, "%s is not allowed now", what);
    return is_allowed;
}

EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

EXPORT int fmi3SetDebugLogging(void *v, bool is_on, size_t count, const char *const categories[]) {
    (void)count, (void)categories;
    ((instance *)v)->is_logging = is_on;
    return OK;
}

static void *instantiate(int kind, const char *name, const char *given, bool is_logging, void *environment, logger log) {
    instance *c = calloc(1, sizeof *c);
    if (c == NULL) return NULL;
    c->kind = kind, c->is_logging = is_logging, c->environment = environment, c->log = log;
    if (name == NULL || given == NULL || strcmp(given, token) != 0) {
        say(c, ERROR, name ? "the instantiation token is not that of this unit: %s" : "an instance needs a name", token);
        return free(c), NULL;
    }
    begin(&c->m);
    return c;
}

EXPORT void *fmi3InstantiateModelExchange(const char *name, const char *given, const char *resources, bool visible, bool is_logging, void *environment, logger log) {
    (void)resources, (void)visible;
    return instantiate(MODEL_EXCHANGE, name, given, is_logging, environment, log);
}

EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *given, const char *resources, bool visible, bool is_logging, bool event_mode,
                                         bool early_return, const uint32_t intermediate[], size_t count, void *environment, logger log, void *update) {
    (void)resources, (void)visible, (void)event_mode, (void)early_return, (void)intermediate, (void)count, (void)update;
    return instantiate(CO_SIMULATION, name, given, is_logging, environment, log);
}

EXPORT void *fmi3InstantiateScheduledExecution(const char *name, const char *given, const char *resources, bool visible, bool is_logging, void *environment,
                                               logger log, void *clock, void *lock, void *unlock) {
    (void)name, (void)given, (void)resources, (void)visible, (void)clock, (void)lock, (void)unlock;
    if (log && is_logging) log(environment, ERROR, "logStatusError", "there is no scheduled execution");
    return NULL;
}

EXPORT void fmi3FreeInstance(void *v) { free(v); }

EXPORT int fmi3EnterInitializationMode(void *v, bool has_tolerance, double tolerance, double start, bool has_stop, double stop) {
    instance *c = v;
    if (!wants(c, c->mode == INSTANTIATED, "fmi3EnterInitializationMode")) return ERROR;
    if (!isfinite(start) || (has_stop && !(stop >= start)) || (has_tolerance && !(tolerance > 0.0 && tolerance < 1.0))) {
        say(c, ERROR, "an experiment from %g to %g with the tolerance %g cannot be made", start, stop, tolerance);
        return ERROR;
    }
    if (has_tolerance) c->m.rtol = tolerance;
    c->m.t = start;
    c->mode = INITIALIZING;
    return OK;
}

EXPORT int fmi3ExitInitializationMode(void *v) {
    instance *c = v;
    if (!wants(c, c->mode == INITIALIZING, "fmi3ExitInitializationMode")) return ERROR;
    begin_samples(&c->m);
    change_inputs(&c->m);
    c->mode = c->kind == CO_SIMULATION ? STEPPING : EVENTS;
    return OK;
}

EXPORT int fmi3Terminate(void *v) {
    ((instance *)v)->mode = TERMINATED;
    return OK;
}

EXPORT int fmi3Reset(void *v) {
    instance *c = v;
    begin(&c->m);
    c->mode = INSTANTIATED;
    return OK;
}

static int one_each(instance *c, size_t count, size_t values) {
    if (count != values) say(c, ERROR, "%lu values for %lu variables", (unsigned long)values, (unsigned long)count);
    return count == values;
}

EXPORT int fmi3GetFloat64(void *v, const uint32_t r[], size_t count, double value[], size_t values) {
    instance *c = v;
    return one_each(c, count, values) ? get(c, &c->m, r, count, value) : ERROR;
}

EXPORT int fmi3SetFloat64(void *v, const uint32_t r[], size_t count, const double value[], size_t values) {
    instance *c = v;
    return one_each(c, count, values) ? set(c, &c->m, c->mode, r, count, value) : ERROR;
}

static int none(instance *c, size_t count) {
    if (count) say(c, ERROR, "all variables are of type Float64");
    return count ? ERROR : OK;
}

#define OTHER(type, name) \
    EXPORT int fmi3Get##name(void *v, const uint32_t r[], size_t count, type value[], size_t values) { (void)r, (void)value, (void)values; return none(v, count); } \
    EXPORT int fmi3Set##name(void *v, const uint32_t r[], size_t count, const type value[], size_t values) { (void)r, (void)value, (void)values; return none(v, count); }
OTHER(float, Float32)
OTHER(int8_t, Int8)
OTHER(uint8_t, UInt8)
OTHER(int16_t, Int16)
OTHER(uint16_t, UInt16)
OTHER(int32_t, Int32)
OTHER(uint32_t, UInt32)
OTHER(int64_t, Int64)
OTHER(uint64_t, UInt64)
OTHER(bool, Boolean)

EXPORT int fmi3GetString(void *v, const uint32_t r[], size_t count, const char *value[], size_t values) { (void)r, (void)value, (void)values; return none(v, count); }
EXPORT int fmi3SetString(void *v, const uint32_t r[], size_t count, const char *const value[], size_t values) { (void)r, (void)value, (void)values; return none(v, count); }
EXPORT int fmi3GetBinary(void *v, const uint32_t r[], size_t count, size_t sizes[], const uint8_t *value[], size_t values) { (void)r, (void)sizes, (void)value, (void)values; return none(v, count); }
EXPORT int fmi3SetBinary(void *v, const uint32_t r[], size_t count, const size_t sizes[], const uint8_t *const value[], size_t values) { (void)r, (void)sizes, (void)value, (void)values; return none(v, count); }
EXPORT int fmi3GetClock(void *v, const uint32_t r[], size_t count, bool value[]) { (void)r, (void)value; return none(v, count); }
EXPORT int fmi3SetClock(void *v, const uint32_t r[], size_t count, const bool value[]) { (void)r, (void)value; return none(v, count); }

EXPORT int fmi3GetNumberOfVariableDependencies(void *v, uint32_t r, size_t *count) { (void)v, (void)r; *count = 0; return ERROR; }
EXPORT int fmi3GetVariableDependencies(void *v, uint32_t r, size_t places[], uint32_t independents[], size_t elements[], int kinds[], size_t count) {
    (void)v, (void)r, (void)places, (void)independents, (void)elements, (void)kinds, (void)count;
    return ERROR;
}

typedef struct { model m; int mode; } kept;

EXPORT int fmi3GetFMUState(void *v, void **state) {
    instance *c = v;
    kept *k = *state ? *state : calloc(1, sizeof *k);
    if (k == NULL) return ERROR;
    k->m = c->m, k->mode = c->mode;
    *state = k;
    return OK;
}

EXPORT int fmi3SetFMUState(void *v, void *state) {
    instance *c = v;
    const kept *k = state;
    c->m = k->m, c->mode = k->mode;
    return OK;
}

EXPORT int fmi3FreeFMUState(void *v, void **state) {
    (void)v;
    free(*state);
    *state = NULL;
    return OK;
}

EXPORT int fmi3SerializedFMUStateSize(void *v, void *state, size_t *size) {
    (void)v, (void)state;
    *size = sizeof(kept);
    return OK;
}

EXPORT int fmi3SerializeFMUState(void *v, void *state, uint8_t bytes[], size_t size) {
    if (size != sizeof(kept)) return say(v, ERROR, "a state has %lu bytes", (unsigned long)sizeof(kept)), ERROR;
    memcpy(bytes, state, size);
    return OK;
}

EXPORT int fmi3DeserializeFMUState(void *v, const uint8_t bytes[], size_t size, void **state) {
    if (size != sizeof(kept)) return say(v, ERROR, "a state has %lu bytes", (unsigned long)sizeof(kept)), ERROR;
    if (*state == NULL) *state = calloc(1, sizeof(kept));
    if (*state == NULL) return ERROR;
    memcpy(*state, bytes, size);
    return OK;
}

EXPORT int fmi3GetDirectionalDerivative(void *v, const uint32_t unknowns[], size_t n_unknowns, const uint32_t knowns[], size_t n_knowns,
                                        const double seed[], size_t n_seed, double result[], size_t n_result) {
    instance *c = v;
    if (!one_each(c, n_knowns, n_seed) || !one_each(c, n_unknowns, n_result)) return ERROR;
    return differentiate(c, &c->m, unknowns, n_unknowns, knowns, n_knowns, seed, result, 0);
}

EXPORT int fmi3GetAdjointDerivative(void *v, const uint32_t unknowns[], size_t n_unknowns, const uint32_t knowns[], size_t n_knowns,
                                    const double seed[], size_t n_seed, double result[], size_t n_result) {
    instance *c = v;
    if (!one_each(c, n_unknowns, n_seed) || !one_each(c, n_knowns, n_result)) return ERROR;
    return differentiate(c, &c->m, unknowns, n_unknowns, knowns, n_knowns, seed, result, 1);
}

EXPORT int fmi3EnterConfigurationMode(void *v) { (void)v; return OK; }
EXPORT int fmi3ExitConfigurationMode(void *v) { (void)v; return OK; }
EXPORT int fmi3GetIntervalDecimal(void *v, const uint32_t r[], size_t count, double a[], int b[]) { (void)r, (void)a, (void)b; return none(v, count); }
EXPORT int fmi3GetIntervalFraction(void *v, const uint32_t r[], size_t count, uint64_t a[], uint64_t b[], int d[]) { (void)r, (void)a, (void)b, (void)d; return none(v, count); }
EXPORT int fmi3GetShiftDecimal(void *v, const uint32_t r[], size_t count, double a[]) { (void)r, (void)a; return none(v, count); }
EXPORT int fmi3GetShiftFraction(void *v, const uint32_t r[], size_t count, uint64_t a[], uint64_t b[]) { (void)r, (void)a, (void)b; return none(v, count); }
EXPORT int fmi3SetIntervalDecimal(void *v, const uint32_t r[], size_t count, const double a[]) { (void)r, (void)a; return none(v, count); }
EXPORT int fmi3SetIntervalFraction(void *v, const uint32_t r[], size_t count, const uint64_t a[], const uint64_t b[]) { (void)r, (void)a, (void)b; return none(v, count); }
EXPORT int fmi3SetShiftDecimal(void *v, const uint32_t r[], size_t count, const double a[]) { (void)r, (void)a; return none(v, count); }
EXPORT int fmi3SetShiftFraction(void *v, const uint32_t r[], size_t count, const uint64_t a[], const uint64_t b[]) { (void)r, (void)a, (void)b; return none(v, count); }
EXPORT int fmi3ActivateModelPartition(void *v, uint32_t r, double t) { (void)r, (void)t; return none(v, 1); }

EXPORT int fmi3EnterEventMode(void *v) {
    instance *c = v;
    if (!wants(c, c->mode == CONTINUOUS || c->mode == EVENTS, "fmi3EnterEventMode")) return ERROR;
    c->mode = EVENTS;
    return OK;
}

EXPORT int fmi3EvaluateDiscreteStates(void *v) { (void)v; return OK; }

EXPORT int fmi3UpdateDiscreteStates(void *v, bool *again, bool *terminate, bool *nominals_changed, bool *values_changed, bool *next_defined, double *next_time) {
    instance *c = v;
    if (!wants(c, c->mode == EVENTS, "fmi3UpdateDiscreteStates")) return ERROR;
    change_inputs(&c->m);
    *again = *terminate = *nominals_changed = *values_changed = false;
    *next_time = next_change(&c->m);
    *next_defined = *next_time < HUGE_VAL;
    return OK;
}

EXPORT int fmi3EnterContinuousTimeMode(void *v) {
    instance *c = v;
    if (!wants(c, c->mode == EVENTS, "fmi3EnterContinuousTimeMode")) return ERROR;
    c->mode = CONTINUOUS;
    return OK;
}

EXPORT int fmi3CompletedIntegratorStep(void *v, bool is_final, bool *enter_events, bool *terminate) {
    instance *c = v;
    (void)is_final;
    *enter_events = false;
    *terminate = is_singular(c, &c->m);
    return OK;
}

EXPORT int fmi3SetTime(void *v, double t) {
    instance *c = v;
    if (!isfinite(t)) return say(c, ERROR, "time is given a value that is not finite: %g", t), ERROR;
    c->m.t = t;
    return OK;
}

EXPORT int fmi3SetContinuousStates(void *v, const double x[], size_t count) {
    instance *c = v;
    return one_each(c, N, count) ? set_states(c, &c->m, x) : ERROR;
}

EXPORT int fmi3GetContinuousStateDerivatives(void *v, double rates[], size_t count) {
    instance *c = v;
    return one_each(c, N, count) ? get_range(c, &c->m, RATE, count, rates) : ERROR;
}

EXPORT int fmi3GetEventIndicators(void *v, double indicators[], size_t count) {
    instance *c = v;
    return one_each(c, E, count) ? get_range(c, &c->m, INDICATOR, count, indicators) : ERROR;
}

EXPORT int fmi3GetContinuousStates(void *v, double x[], size_t count) {
    instance *c = v;
    return one_each(c, N, count) ? get_range(c, &c->m, STATE, count, x) : ERROR;
}

EXPORT int fmi3GetNominalsOfContinuousStates(void *v, double nominals[], size_t count) {
    (void)v;
    for (size_t i = 0; i < count; ++i) nominals[i] = 1.0;
    return OK;
}

EXPORT int fmi3GetNumberOfEventIndicators(void *v, size_t *count) { (void)v; *count = E; return OK; }
EXPORT int fmi3GetNumberOfContinuousStates(void *v, size_t *count) { (void)v; *count = N; return OK; }
EXPORT int fmi3EnterStepMode(void *v) { ((instance *)v)->mode = STEPPING; return OK; }

EXPORT int fmi3GetOutputDerivatives(void *v, const uint32_t r[], size_t count, const int32_t orders[], double value[], size_t values) {
    (void)r, (void)orders, (void)value, (void)values;
    say(v, ERROR, "derivatives of outputs are not computed");
    return count ? ERROR : OK;
}

EXPORT int fmi3DoStep(void *v, double t, double length, bool no_set_before, bool *events, bool *terminate, bool *early, double *reached) {
    instance *c = v;
    int status;
    (void)no_set_before;
    *events = *terminate = *early = false;
    *reached = c->m.t;
    if (!wants(c, c->mode == STEPPING, "fmi3DoStep")) return ERROR;
    if (!isfinite(length) || !(length > 0.0) || !(fabs(t - c->m.t) <= 1e-9 * (length + fabs(t)))) {
        say(c, ERROR, "no step of %g from %.17g: this unit is at time %.17g", length, t, c->m.t);
        return ERROR;
    }
    status = advance(c, &c->m, t + length);
    *reached = c->m.t;
    return status;
}
