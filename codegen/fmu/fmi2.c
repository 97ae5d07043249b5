
/* The functions of FMI 2.0 (Functional Mock-up Interface for Model Exchange and Co-Simulation, version 2.0.4,
 * chapters 2 to 4), declared here as that standard defines them. */
#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef struct {
    void (*logger)(void *environment, const char *name, int status, const char *category, const char *message, ...);
    void *(*allocate)(size_t count, size_t size);
    void (*release)(void *memory);
    void (*step_finished)(void *environment, int status);
    void *environment;
} callbacks;

typedef struct {
    int new_states_needed, terminate, nominals_changed, values_changed, next_defined;
    double next_time;
} event_info;

struct instance {
    model m;
    int kind, mode, is_logging;
    callbacks call;
    char *name;
};

static void say(instance *c, int status, const char *format, ...) {
    char text[400];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (c->call.logger && (c->is_logging || status == ERROR))
        c->call.logger(c->call.environment, c->name, status, status == ERROR ? "logStatusError" : "logStatusDiscard", "%s", text);
}

static int wants(instance *c, int is_allowed, const char *what) {
    if (!is_allowed) say(c, ERROR, "%s is not allowed now", what);
    return is_allowed;
}

EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

EXPORT int fmi2SetDebugLogging(void *v, int is_on, size_t count, const char *const categories[]) {
    (void)count, (void)categories;
    ((instance *)v)->is_logging = is_on;
    return OK;
}

EXPORT void *fmi2Instantiate(const char *name, int kind, const char *guid, const char *resources, const callbacks *call, int visible, int is_logging) {
    const size_t length = name ? strlen(name) : 0;
    instance *c = call ? calloc(1, sizeof *c) : NULL;
    (void)resources, (void)visible;
    if (c == NULL) return NULL;
    c->call = *call, c->is_logging = is_logging, c->kind = kind;
    c->name = calloc(length + 1, 1);
    if (c->name == NULL) return free(c), NULL;
    if (length) memcpy(c->name, name, length);
    if (guid == NULL || strcmp(guid, token) != 0 || length == 0) {
        say(c, ERROR, length ? "the guid is not that of this unit: %s" : "an instance needs a name, not \"%s\"", length ? token : "");
        return free(c->name), free(c), NULL;
    }
    begin(&c->m);
    return c;
}

EXPORT void fmi2FreeInstance(void *v) {
    instance *c = v;
    if (c == NULL) return;
    free(c->name);
    free(c);
}

EXPORT int fmi2SetupExperiment(void *v, int has_tolerance, double tolerance, double start, int has_stop, double stop) {
    instance *c = v;
    if (!wants(c, c->mode == INSTANTIATED, "fmi2SetupExperiment")) return ERROR;
    if (!isfinite(start) || (has_stop && !(stop >= start)) || (has_tolerance && !(tolerance > 0.0 && tolerance < 1.0))) {
        say(c, ERROR, "an experiment from %g to %g with the tolerance %g cannot be made", start, stop, tolerance);
        return ERROR;
    }
    if (has_tolerance) c->m.rtol = tolerance;
    c->m.t = start;
    return OK;
}

EXPORT int fmi2EnterInitializationMode(void *v) {
    instance *c = v;
    if (!wants(c, c->mode == INSTANTIATED, "fmi2EnterInitializationMode")) return ERROR;
    c->mode = INITIALIZING;
    return OK;
}

EXPORT int fmi2ExitInitializationMode(void *v) {
    instance *c = v;
    if (!wants(c, c->mode == INITIALIZING, "fmi2ExitInitializationMode")) return ERROR;
    begin_samples(&c->m);
    change_inputs(&c->m);
    c->mode = c->kind == CO_SIMULATION ? STEPPING : EVENTS;
    return OK;
}

EXPORT int fmi2Terminate(void *v) {
    ((instance *)v)->mode = TERMINATED;
    return OK;
}

EXPORT int fmi2Reset(void *v) {
    instance *c = v;
    begin(&c->m);
    c->mode = INSTANTIATED;
    return OK;
}

EXPORT int fmi2GetReal(void *v, const unsigned r[], size_t count, double value[]) {
    instance *c = v;
    return get(c, &c->m, r, count, value);
}

EXPORT int fmi2SetReal(void *v, const unsigned r[], size_t count, const double value[]) {
    instance *c = v;
    return set(c, &c->m, c->mode, r, count, value);
}

static int none(instance *c, size_t count) {
    if (count) say(c, ERROR, "all variables are real");
    return count ? ERROR : OK;
}

EXPORT int fmi2GetInteger(void *v, const unsigned r[], size_t count, int value[]) { (void)r, (void)value; return none(v, count); }
EXPORT int fmi2GetBoolean(void *v, const unsigned r[], size_t count, int value[]) { (void)r, (void)value; return none(v, count); }
EXPORT int fmi2GetString(void *v, const unsigned r[], size_t count, const char *value[]) { (void)r, (void)value; return none(v, count); }
EXPORT int fmi2SetInteger(void *v, const unsigned r[], size_t count, const int value[]) { (void)r, (void)value; return none(v, count); }
EXPORT int fmi2SetBoolean(void *v, const unsigned r[], size_t count, const int value[]) { (void)r, (void)value; return none(v, count); }
EXPORT int fmi2SetString(void *v, const unsigned r[], size_t count, const char *const value[]) { (void)r, (void)value; return none(v, count); }

typedef struct { model m; int mode; } kept;

EXPORT int fmi2GetFMUstate(void *v, void **state) {
    instance *c = v;
    kept *k = *state ? *state : calloc(1, sizeof *k);
    if (k == NULL) return ERROR;
    k->m = c->m, k->mode = c->mode;
    *state = k;
    return OK;
}

EXPORT int fmi2SetFMUstate(void *v, void *state) {
    instance *c = v;
    const kept *k = state;
    c->m = k->m, c->mode = k->mode;
    return OK;
}

EXPORT int fmi2FreeFMUstate(void *v, void **state) {
    (void)v;
    free(*state);
    *state = NULL;
    return OK;
}

EXPORT int fmi2SerializedFMUstateSize(void *v, void *state, size_t *size) {
    (void)v, (void)state;
    *size = sizeof(kept);
    return OK;
}

EXPORT int fmi2SerializeFMUstate(void *v, void *state, char bytes[], size_t size) {
    if (size != sizeof(kept)) return say(v, ERROR, "a state has %lu bytes", (unsigned long)sizeof(kept)), ERROR;
    memcpy(bytes, state, size);
    return OK;
}

EXPORT int fmi2DeSerializeFMUstate(void *v, const char bytes[], size_t size, void **state) {
    if (size != sizeof(kept)) return say(v, ERROR, "a state has %lu bytes", (unsigned long)sizeof(kept)), ERROR;
    if (*state == NULL) *state = calloc(1, sizeof(kept));
    if (*state == NULL) return ERROR;
    memcpy(*state, bytes, size);
    return OK;
}

EXPORT int fmi2GetDirectionalDerivative(void *v, const unsigned unknowns[], size_t n_unknowns, const unsigned knowns[], size_t n_knowns, const double seed[], double result[]) {
    instance *c = v;
    return differentiate(c, &c->m, unknowns, n_unknowns, knowns, n_knowns, seed, result, 0);
}

EXPORT int fmi2EnterEventMode(void *v) {
    instance *c = v;
    if (!wants(c, c->mode == CONTINUOUS || c->mode == EVENTS, "fmi2EnterEventMode")) return ERROR;
    c->mode = EVENTS;
    return OK;
}

EXPORT int fmi2NewDiscreteStates(void *v, event_info *info) {
    instance *c = v;
    if (!wants(c, c->mode == EVENTS, "fmi2NewDiscreteStates")) return ERROR;
    change_inputs(&c->m);
    memset(info, 0, sizeof *info);
    info->next_time = next_change(&c->m);
    info->next_defined = info->next_time < HUGE_VAL;
    return OK;
}

EXPORT int fmi2EnterContinuousTimeMode(void *v) {
    instance *c = v;
    if (!wants(c, c->mode == EVENTS, "fmi2EnterContinuousTimeMode")) return ERROR;
    c->mode = CONTINUOUS;
    return OK;
}

EXPORT int fmi2CompletedIntegratorStep(void *v, int is_final, int *enter_events, int *terminate) {
    instance *c = v;
    (void)is_final;
    *enter_events = 0;
    *terminate = is_singular(c, &c->m);
    return OK;
}

EXPORT int fmi2SetTime(void *v, double t) {
    instance *c = v;
    if (!isfinite(t)) return say(c, ERROR, "time is given a value that is not finite: %g", t), ERROR;
    c->m.t = t;
    return OK;
}

EXPORT int fmi2SetContinuousStates(void *v, const double x[], size_t count) {
    instance *c = v;
    if (!wants(c, count == N, "another number of states")) return ERROR;
    return set_states(c, &c->m, x);
}

EXPORT int fmi2GetDerivatives(void *v, double rates[], size_t count) {
    instance *c = v;
    if (!wants(c, count == N, "another number of states")) return ERROR;
    return get_range(c, &c->m, RATE, count, rates);
}

EXPORT int fmi2GetEventIndicators(void *v, double indicators[], size_t count) {
    instance *c = v;
    if (!wants(c, count == E, "another number of event indicators")) return ERROR;
    return get_range(c, &c->m, INDICATOR, count, indicators);
}

EXPORT int fmi2GetContinuousStates(void *v, double x[], size_t count) {
    instance *c = v;
    if (!wants(c, count == N, "another number of states")) return ERROR;
    return get_range(c, &c->m, STATE, count, x);
}

EXPORT int fmi2GetNominalsOfContinuousStates(void *v, double nominals[], size_t count) {
    (void)v;
    for (size_t i = 0; i < count; ++i) nominals[i] = 1.0;
    return OK;
}

EXPORT int fmi2SetRealInputDerivatives(void *v, const unsigned r[], size_t count, const int orders[], const double value[]) {
    (void)r, (void)orders, (void)value;
    say(v, ERROR, "inputs are held between communication points");
    return count ? ERROR : OK;
}

EXPORT int fmi2GetRealOutputDerivatives(void *v, const unsigned r[], size_t count, const int orders[], double value[]) {
    (void)r, (void)orders, (void)value;
    say(v, ERROR, "derivatives of outputs are not computed");
    return count ? ERROR : OK;
}

EXPORT int fmi2DoStep(void *v, double t, double length, int no_set_before) {
    instance *c = v;
    (void)no_set_before;
    if (!wants(c, c->mode == STEPPING, "fmi2DoStep")) return ERROR;
    if (!isfinite(length) || !(length > 0.0) || !(fabs(t - c->m.t) <= 1e-9 * (length + fabs(t)))) {
        say(c, ERROR, "no step of %g from %.17g: this unit is at time %.17g", length, t, c->m.t);
        return ERROR;
    }
    return advance(c, &c->m, t + length);
}

EXPORT int fmi2CancelStep(void *v) { return say(v, ERROR, "steps are not asynchronous"), ERROR; }
EXPORT int fmi2GetStatus(void *v, int kind, int *value) { (void)v, (void)kind; *value = OK; return OK; }
EXPORT int fmi2GetRealStatus(void *v, int kind, double *value) { (void)kind; *value = ((instance *)v)->m.t; return OK; }
EXPORT int fmi2GetIntegerStatus(void *v, int kind, int *value) { (void)v, (void)kind, (void)value; return DISCARD; }
EXPORT int fmi2GetBooleanStatus(void *v, int kind, int *value) { (void)v, (void)kind; *value = 0; return OK; }
EXPORT int fmi2GetStringStatus(void *v, int kind, const char **value) { (void)v, (void)kind; *value = ""; return OK; }
