
/* The functions of FMI 2.0 (Functional Mock-up Interface for Model Exchange and Co-Simulation, version 2.0.4,
 * chapters 2 to 4), declared here as that standard defines them. */
#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef int flag;
typedef char byte;
#define REAL "Real"
#define CALL(name) fmi2##name
#define CALLED(name) "fmi2" #name
#define GET_KEPT fmi2GetFMUstate
#define SET_KEPT fmi2SetFMUstate
#define FREE_KEPT fmi2FreeFMUstate
#define SIZE_KEPT fmi2SerializedFMUstateSize
#define WRITE_KEPT fmi2SerializeFMUstate
#define READ_KEPT fmi2DeSerializeFMUstate
#define GET_RATES fmi2GetDerivatives

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
