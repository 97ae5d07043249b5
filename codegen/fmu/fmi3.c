
EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

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
    if (set_up(c, has_tolerance, tolerance, start, has_stop, stop) != OK) return ERROR;
    c->mode = INITIALIZING;
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
    status = step(c, t, length);
    *reached = c->m.t;
    return status;
}
