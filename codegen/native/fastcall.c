/* A quick way from Python into compiled functions of the form
 *     void f(double t, const double *x, const constants *c, const double *u, double *y)
 * after void prepare(const double *p, constants *c), which runs where p is new,
 * for contiguous arrays of doubles of the right length. Every other call goes to a Python function,
 * which converts, checks and explains. Limited API of Python 3.11. */
#define Py_LIMITED_API 0x030b0000
#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include <string.h>

typedef void (*function_t)(double, const double *, const void *, const double *, double *);
typedef void (*prepare_t)(const double *, void *);

enum { X, P, U, Y, ARRAYS };

typedef struct {
    function_t function;
    prepare_t prepare;
    Py_ssize_t length[ARRAYS];
    double *constants; /* what prepare made of parameters, and the parameters behind it */
    double *parameters;
    int prepared;
    PyObject *fallback; /* called with the same arguments where the quick way does not fit */
    PyObject *new_result; /* makes an array of length[Y] doubles */
} target_t;

static void release(PyObject *capsule) {
    target_t *target = PyCapsule_GetPointer(capsule, "eom.target");
    if (target != NULL) {
        Py_XDECREF(target->fallback);
        Py_XDECREF(target->new_result);
        PyMem_Free(target->constants);
        PyMem_Free(target);
    }
}

/* Compute the constants unless the parameters are, bit for bit, those of the last call. */
static void prepare(target_t *target, const double *p) {
    const size_t size = (size_t)target->length[P] * sizeof *p;
    if (target->prepared && (size == 0 || memcmp(p, target->parameters, size) == 0)) return;
    if (size > 0) memcpy(target->parameters, p, size);
    target->prepare(target->parameters, target->constants);
    target->prepared = 1;
}

/* Fill view if the object is a one-dimensional contiguous array of length doubles. */
static int fits(PyObject *object, Py_buffer *view, Py_ssize_t length, int writable) {
    const int flags = PyBUF_FORMAT | PyBUF_ND | (writable ? PyBUF_WRITABLE : 0);
    if (PyObject_GetBuffer(object, view, flags) != 0) {
        PyErr_Clear();
        return 0;
    }
    if (view->ndim == 1 && view->shape[0] == length && view->format[0] == 'd' && view->format[1] == '\0') return 1;
    PyBuffer_Release(view);
    return 0;
}

static PyObject *fall_back(target_t *target, PyObject *const *args, Py_ssize_t count, PyObject *names) {
    const Py_ssize_t named = names == NULL ? 0 : PyTuple_Size(names);
    PyObject *result = NULL, *keywords = NULL, *positional = PyTuple_New(count);
    if (positional == NULL) return NULL;
    for (Py_ssize_t k = 0; k < count; ++k) {
        Py_INCREF(args[k]);
        PyTuple_SetItem(positional, k, args[k]);
    }
    if (named > 0) {
        keywords = PyDict_New();
        if (keywords == NULL) goto done;
        for (Py_ssize_t k = 0; k < named; ++k)
            if (PyDict_SetItem(keywords, PyTuple_GetItem(names, k), args[count + k]) != 0) goto done;
    }
    result = PyObject_Call(target->fallback, positional, keywords);
done:
    Py_XDECREF(keywords);
    Py_DECREF(positional);
    return result;
}

static PyObject *call(PyObject *self, PyObject *const *args, Py_ssize_t count, PyObject *names) {
    target_t *target = PyCapsule_GetPointer(self, "eom.target");
    if (target == NULL) return NULL;
    const Py_ssize_t named = names == NULL ? 0 : PyTuple_Size(names);
    PyObject *given[ARRAYS] = {NULL, NULL, NULL, NULL};
    Py_buffer views[ARRAYS];
    int held[ARRAYS] = {0, 0, 0, 0};
    PyObject *made = NULL, *result = NULL;

    if (count < 2 || count > 5 || named > 1) return fall_back(target, args, count, names);
    if (named == 1 && (count == 5 || PyUnicode_CompareWithASCIIString(PyTuple_GetItem(names, 0), "out") != 0))
        return fall_back(target, args, count, names);
    for (Py_ssize_t k = 1; k < count; ++k)
        if (args[k] != Py_None) given[k - 1] = args[k];
    if (named == 1 && args[count] != Py_None) given[Y] = args[count];
    if (!PyFloat_Check(args[0])) return fall_back(target, args, count, names);

    if (given[Y] == NULL) {
        made = PyObject_CallNoArgs(target->new_result);
        if (made == NULL) return NULL;
        given[Y] = made;
    }
    int quick = 1;
    for (int k = 0; k < ARRAYS && quick; ++k) {
        if (given[k] == NULL) quick = target->length[k] == 0;
        else quick = held[k] = fits(given[k], &views[k], target->length[k], k == Y);
    }
    if (quick) {
        prepare(target, held[P] ? views[P].buf : NULL);
        target->function(PyFloat_AsDouble(args[0]), held[X] ? views[X].buf : NULL, target->constants,
                         held[U] ? views[U].buf : NULL, views[Y].buf);
        result = given[Y];
        Py_INCREF(result);
    }
    for (int k = 0; k < ARRAYS; ++k)
        if (held[k]) PyBuffer_Release(&views[k]);
    Py_XDECREF(made);
    return quick ? result : fall_back(target, args, count, names);
}

static PyMethodDef call_method = {"rates", (PyCFunction)(void (*)(void))call, METH_FASTCALL | METH_KEYWORDS,
                                  "rates(t, x, p=None, u=None, out=None): see the object that it belongs to"};

/* bind(address, address of prepare, (nx, np, nu, ny), constants, fallback, new_result) -> function */
static PyObject *bind(PyObject *module, PyObject *args) {
    (void)module;
    PyObject *address, *preparing, *fallback, *new_result;
    Py_ssize_t length[ARRAYS], constants;
    if (!PyArg_ParseTuple(args, "OO(nnnn)nOO", &address, &preparing, &length[X], &length[P], &length[U], &length[Y],
                          &constants, &fallback, &new_result))
        return NULL;
    void *pointer = PyLong_AsVoidPtr(address), *preparation = PyLong_AsVoidPtr(preparing);
    if (pointer == NULL || preparation == NULL) {
        if (!PyErr_Occurred()) PyErr_SetString(PyExc_ValueError, "address of the function is null");
        return NULL;
    }
    target_t *target = PyMem_Malloc(sizeof *target);
    if (target == NULL) return PyErr_NoMemory();
    target->constants = PyMem_Malloc((size_t)(constants + length[P]) * sizeof(double));
    if (target->constants == NULL) {
        PyMem_Free(target);
        return PyErr_NoMemory();
    }
    target->parameters = target->constants + constants;
    target->prepared = 0;
    target->function = (function_t)pointer;
    target->prepare = (prepare_t)preparation;
    for (int k = 0; k < ARRAYS; ++k) target->length[k] = length[k];
    Py_INCREF(fallback);
    Py_INCREF(new_result);
    target->fallback = fallback;
    target->new_result = new_result;
    PyObject *capsule = PyCapsule_New(target, "eom.target", release);
    if (capsule == NULL) {
        Py_DECREF(fallback);
        Py_DECREF(new_result);
        PyMem_Free(target->constants);
        PyMem_Free(target);
        return NULL;
    }
    PyObject *function = PyCFunction_NewEx(&call_method, capsule, NULL);
    Py_DECREF(capsule);
    return function;
}

/* @RUNS@ */
static PyMethodDef methods[] = {{"bind", bind, METH_VARARGS, "bind a compiled function"},
                                QUICK(taken, "take numbers by name or in order"),
                                QUICK(scales, "default absolute tolerances"),
                                QUICK(steepest, "a bound of stiffness"),
                                QUICK(begun, "begin a run"),
                                {NULL, NULL, 0, NULL}};
static struct PyModuleDef definition = {PyModuleDef_HEAD_INIT, "eom_fastcall", NULL, 0, methods, NULL, NULL, NULL, NULL};

PyMODINIT_FUNC PyInit_eom_fastcall(void) { return PyModuleDef_Init(&definition); }
