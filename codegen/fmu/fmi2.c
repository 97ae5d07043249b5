
EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

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
    return set_up(c, has_tolerance, tolerance, start, has_stop, stop);
}

EXPORT int fmi2EnterInitializationMode(void *v) {
    instance *c = v;
    if (!wants(c, c->mode == INSTANTIATED, "fmi2EnterInitializationMode")) return ERROR;
    c->mode = INITIALIZING;
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

EXPORT int fmi2GetInteger(void *v, const unsigned r[], size_t count, int value[]) { (void)r, (void)value; return none(v, count); }
EXPORT int fmi2GetBoolean(void *v, const unsigned r[], size_t count, int value[]) { (void)r, (void)value; return none(v, count); }
EXPORT int fmi2GetString(void *v, const unsigned r[], size_t count, const char *value[]) { (void)r, (void)value; return none(v, count); }
EXPORT int fmi2SetInteger(void *v, const unsigned r[], size_t count, const int value[]) { (void)r, (void)value; return none(v, count); }
EXPORT int fmi2SetBoolean(void *v, const unsigned r[], size_t count, const int value[]) { (void)r, (void)value; return none(v, count); }
EXPORT int fmi2SetString(void *v, const unsigned r[], size_t count, const char *const value[]) { (void)r, (void)value; return none(v, count); }

EXPORT int fmi2GetDirectionalDerivative(void *v, const unsigned unknowns[], size_t n_unknowns, const unsigned knowns[], size_t n_knowns, const double seed[], double result[]) {
    instance *c = v;
    return differentiate(c, &c->m, unknowns, n_unknowns, knowns, n_knowns, seed, result, 0);
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
    return step(c, t, length);
}

EXPORT int fmi2CancelStep(void *v) { return say(v, ERROR, "steps are not asynchronous"), ERROR; }
EXPORT int fmi2GetStatus(void *v, int kind, int *value) { (void)v, (void)kind; *value = OK; return OK; }
EXPORT int fmi2GetRealStatus(void *v, int kind, double *value) { (void)kind; *value = ((instance *)v)->m.t; return OK; }
EXPORT int fmi2GetIntegerStatus(void *v, int kind, int *value) { (void)v, (void)kind, (void)value; return DISCARD; }
EXPORT int fmi2GetBooleanStatus(void *v, int kind, int *value) { (void)v, (void)kind; *value = 0; return OK; }
EXPORT int fmi2GetStringStatus(void *v, int kind, const char **value) { (void)v, (void)kind; *value = ""; return OK; }
