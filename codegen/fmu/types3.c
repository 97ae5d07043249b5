
/* The functions of FMI 3.0 (Functional Mock-up Interface Specification, version 3.0.1, sections 2.2 to 5),
 * declared here as that standard defines them. */
#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef bool flag;
typedef uint8_t byte;
#define REAL "Float64"
#define CALL(name) fmi3##name
#define CALLED(name) "fmi3" #name
#define GET_KEPT fmi3GetFMUState
#define SET_KEPT fmi3SetFMUState
#define FREE_KEPT fmi3FreeFMUState
#define SIZE_KEPT fmi3SerializedFMUStateSize
#define WRITE_KEPT fmi3SerializeFMUState
#define READ_KEPT fmi3DeserializeFMUState
#define GET_RATES fmi3GetContinuousStateDerivatives

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
