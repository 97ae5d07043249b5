/* What a run from Python costs beside its loop: values by name into arrays, default absolute tolerances,
 * a bound of stiffness, and the first call of a generated integrator. Each gives what its counterpart in
 * Python gives, bit for bit, or says that it does not fit, and the counterpart is taken. */
#include <math.h>

/* Put a finite number into place; 0 for anything else. */
static int number(PyObject *value, double *place) {
    if (PyFloat_Check(value)) *place = PyFloat_AsDouble(value);
    else if (PyLong_Check(value)) *place = PyLong_AsDouble(value);
    else return 0;
    if (PyErr_Occurred()) {
        PyErr_Clear();
        return 0;
    }
    return isfinite(*place);
}

static int by_name(PyObject *values, PyObject *names, double *out, Py_ssize_t n) {
    if (PyDict_Size(values) != n) return 0;
    for (Py_ssize_t k = 0; k < n; ++k) {
        PyObject *value = PyDict_GetItemWithError(values, PyTuple_GetItem(names, k));
        if (value == NULL || !number(value, out + k)) {
            PyErr_Clear();
            return 0;
        }
    }
    return 1;
}

static int in_order(PyObject *values, double *out, Py_ssize_t n) {
    Py_buffer view;
    if (PyList_Check(values) || PyTuple_Check(values)) {
        const int is_list = PyList_Check(values);
        if ((is_list ? PyList_Size(values) : PyTuple_Size(values)) != n) return 0;
        for (Py_ssize_t k = 0; k < n; ++k)
            if (!number(is_list ? PyList_GetItem(values, k) : PyTuple_GetItem(values, k), out + k)) return 0;
        return 1;
    }
    if (!PyObject_CheckBuffer(values) || !fits(values, &view, n, 0)) return 0;
    memcpy(out, view.buf, (size_t)n * sizeof *out);
    PyBuffer_Release(&view);
    for (Py_ssize_t k = 0; k < n; ++k)
        if (!isfinite(out[k])) return 0;
    return 1;
}

/* taken(values, names, out) -> whether values, by name or in order, are finite numbers, now in out */
static PyObject *taken(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    (void)self;
    Py_buffer out;
    if (count != 3 || !PyTuple_Check(args[1]) || !fits(args[2], &out, PyTuple_Size(args[1]), 1)) Py_RETURN_FALSE;
    const Py_ssize_t n = PyTuple_Size(args[1]);
    const int fit = args[0] == Py_None      ? n == 0
                    : PyDict_Check(args[0]) ? by_name(args[0], args[1], out.buf, n)
                                            : in_order(args[0], out.buf, n);
    PyBuffer_Release(&out);
    return PyBool_FromLong(fit);
}

/* --- default absolute tolerances: `codegen.integrate.scales` of one run, in the same order of operations --- */

enum { DEPTH = 4, TURNS = 40, LOOKS = 6 };
static const double PART = 1e-3, LEAST = 1e-150, RESIDUE = 0x1p-46, ROUNDED = 0x1p-48, MOVED = 0x1p-20, STEADY = 0x1p-8,
                    GOLDEN = 0.6180339887498949, DOUBTFUL = 0x1p-26, SHORTER = 8.0;

typedef struct {
    const target_t *target;
    const double *u;
    double epoch;
    Py_ssize_t n;
    double *room; /* (n,), for a state that is moved */
    double *whole; /* NULL, or all states, of which the first n are considered, and room for their rates behind them */
} rates_t;

static void slope_at(const rates_t *r, double t, const double *x, double *slope) {
    const size_t considered = (size_t)r->n * sizeof *x;
    double *all = r->whole == NULL ? NULL : r->whole + r->target->length[X];
    if (all != NULL) memcpy(r->whole, x, considered);
    r->target->function(r->epoch + t, all == NULL ? x : r->whole, r->target->constants, r->u, all == NULL ? slope : all);
    if (all != NULL) memcpy(slope, all, considered);
}

/* The largest size of a state of the same unit; least: n values of room. */
static void largest_of_unit(const int *unit, const double *size, Py_ssize_t n, double *room, double *largest) {
    for (Py_ssize_t k = 0; k < n; ++k) room[k] = 0.0;
    for (Py_ssize_t k = 0; k < n; ++k)
        if (size[k] > room[unit[k]]) room[unit[k]] = size[k];
    for (Py_ssize_t k = 0; k < n; ++k) largest[k] = room[unit[k]];
}

static double at_most(const double *slope, const double *bounds, Py_ssize_t n, double span) {
    double pace = 0.0;
    for (Py_ssize_t k = 0; k < n; ++k) {
        const double own = bounds[k] > 0.0 ? fabs(slope[k]) / bounds[k] : 0.0;
        if (isnan(own)) return span;
        if (own > pace) pace = own;
    }
    return pace > 0.0 && isfinite(SHORTER / pace) ? SHORTER / pace : span;
}

static int is_short(const double *before, const double *after, const double *bounds, const double *beside, double length,
                    Py_ssize_t n) {
    for (Py_ssize_t k = 0; k < n; ++k) {
        const double allowed = bounds[k] + length * fabs(before[k]);
        const double change = length * fabs(after[k] - before[k]);
        if (!(change <= allowed || (beside != NULL && change <= beside[k]) || allowed == 0.0)) return 0;
    }
    return 1;
}

/* Leave of new what neighbours of the point agree about. */
static void steady_part(const rates_t *r, double t, const double *x, const double *slope, double *new, double *moved) {
    for (int look = 1; look <= LOOKS; ++look) {
        for (Py_ssize_t k = 0; k < r->n; ++k) {
            const double apart = 2.0 * fmod(GOLDEN * look * (double)(k + 1), 1.0) - 1.0;
            moved[k] = x[k] * (1.0 + MOVED * apart);
        }
        slope_at(r, t, moved, r->room);
        for (Py_ssize_t k = 0; k < r->n; ++k)
            if (!(fabs(r->room[k] - slope[k]) <= STEADY * fabs(slope[k]))) new[k] = 0.0;
    }
}

static int is_doubtful(double growth, double largest) {
    return growth > 0.0 && growth <= DOUBTFUL * (largest > 0.0 ? largest : HUGE_VAL);
}

/* Put 0 for rates at a point that are rounding. */
static void without_rounding(const rates_t *r, double t, const double *x, double *slope, const double *largest,
                             double length, double *new, double *moved) {
    int doubtful = 0;
    for (Py_ssize_t k = 0; k < r->n; ++k) {
        new[k] = length * fabs(slope[k]);
        doubtful |= is_doubtful(new[k], largest[k]);
    }
    if (!doubtful) return;
    steady_part(r, t, x, slope, new, moved);
    for (Py_ssize_t k = 0; k < r->n; ++k)
        if (new[k] == 0.0 && is_doubtful(length * fabs(slope[k]), largest[k])) slope[k] = 0.0;
}

/* How far each state goes at first, in grown; work: (DEPTH + 3) n doubles. */
static void growth_of(const rates_t *r, const double *start, const double *bounds, const double *largest,
                      const double *beside, double begin, double end, double *grown, double *work) {
    const Py_ssize_t n = r->n;
    double *slopes = work, *point = work + DEPTH * n, *new = point + n, *moved = new + n;
    const double direction = end > begin ? 1.0 : -1.0;
    slope_at(r, begin, start, slopes);
    double length = at_most(slopes, bounds, n, fabs(end - begin));
    int fit = 0;
    for (int turn = 0; turn < TURNS && !fit; ++turn) {
        if (turn > 0) length = length / SHORTER;
        const double step = direction * length, then = fabs(step) < fabs(end - begin) ? begin + step : end;
        without_rounding(r, begin, start, slopes, largest, length, new, moved);
        fit = 1;
        for (int d = 1; d < DEPTH; ++d) {
            double *before = slopes + (d - 1) * n, *slope = slopes + d * n;
            for (Py_ssize_t k = 0; k < n; ++k) point[k] = start[k] + step * before[k];
            slope_at(r, then, point, slope);
            without_rounding(r, then, point, slope, largest, length, new, moved);
            fit = fit && is_short(before, slope, bounds, beside, length, n);
        }
    }
    if (!fit) length = 0.0;
    for (Py_ssize_t k = 0; k < n; ++k) grown[k] = 0.0;
    for (int d = 0; d < DEPTH; ++d)
        for (Py_ssize_t k = 0; k < n; ++k) {
            const double growth = length * fabs(slopes[d * n + k]);
            if (grown[k] == 0.0 && isfinite(growth)) grown[k] += growth;
        }
}

typedef struct {
    const int *unit;
    int alone;
    const double *otherwise; /* scales of states that do not grow, 0 for none, or NULL */
    double begin, end;
} compared_t;

/* The scales, 0 where a state does not grow, in size, and the largest of each unit; work: (DEPTH + 6) n doubles. */
static void sizes_of(const rates_t *r, const double *x, const compared_t *c, double *size, double *largest, double *work) {
    const Py_ssize_t n = r->n;
    double *bounds = work, *grown = bounds + n, *beside = grown + n, *rest = beside + n;
    int small = 0;
    for (Py_ssize_t k = 0; k < n; ++k) size[k] = fabs(x[k]);
    largest_of_unit(c->unit, size, n, grown, largest);
    for (Py_ssize_t k = 0; k < n; ++k) {
        bounds[k] = c->unit[k] == c->alone ? size[k] : largest[k];
        small |= size[k] <= RESIDUE * largest[k];
    }
    if (!small) return;
    if (c->otherwise != NULL) largest_of_unit(c->unit, c->otherwise, n, grown, beside);
    growth_of(r, x, bounds, largest, c->otherwise == NULL ? NULL : beside, c->begin, c->end, grown, rest);
    for (Py_ssize_t k = 0; k < n; ++k) {
        if (size[k] <= RESIDUE * largest[k]) size[k] = grown[k] > 0.0 ? (grown[k] > size[k] ? grown[k] : size[k]) : 0.0;
        if (!(size[k] > 0.0) && c->otherwise != NULL) size[k] = c->otherwise[k];
    }
    largest_of_unit(c->unit, size, n, grown, largest);
}

/* The tolerances; in unknown the numbers of states whose scale is not known, how many there are is returned. */
static int tolerances_of(const double *size, const double *largest, Py_ssize_t n, double rtol, double *atol,
                         double *unknown) {
    int count = 0;
    for (Py_ssize_t k = 0; k < n; ++k) {
        const double scale = size[k] > 0.0 ? size[k] : (largest[k] > 0.0 ? largest[k] : 1.0);
        double own = PART * rtol * scale;
        if (!(size[k] > 0.0 || largest[k] > 0.0)) unknown[count++] = (double)k;
        if (!(size[k] > 0.0) && largest[k] > 0.0 && ROUNDED * largest[k] < own) own = ROUNDED * largest[k];
        atol[k] = own > LEAST ? own : LEAST;
    }
    return count;
}

static target_t *target_of(PyObject *function) {
    PyObject *capsule = PyCFunction_Check(function) ? PyCFunction_GetSelf(function) : NULL;
    if (capsule != NULL && PyCapsule_IsValid(capsule, "eom.target")) return PyCapsule_GetPointer(capsule, "eom.target");
    PyErr_Clear();
    return NULL;
}

/* Fill views of states, parameters and inputs; the number of those that are held, negative for a misfit. */
static int hold(const target_t *target, PyObject *const *args, Py_buffer *views) {
    for (int k = X; k <= U; ++k)
        if (!fits(args[k], views + k, target->length[k], 0)) {
            while (k-- > X) PyBuffer_Release(views + k);
            return 0;
        }
    return 1;
}

static void let_go(Py_buffer *views) {
    for (int k = X; k <= U; ++k) PyBuffer_Release(views + k);
}

static PyObject *numbers_of(const double *values, int count) {
    PyObject *found = PyTuple_New(count);
    for (int k = 0; k < count && found != NULL; ++k)
        if (PyTuple_SetItem(found, k, PyLong_FromDouble(values[k])) != 0) Py_CLEAR(found);
    return found;
}

/* Fill out from the start x; see scales. */
static PyObject *scales_from(const rates_t *r, const double *x, const compared_t *c, double rtol, double *out,
                             double *work) {
    const Py_ssize_t n = r->n;
    double *size = work, *largest = size + n, *rest = largest + n;
    sizes_of(r, x, c, size, largest, rest);
    if (r->whole == NULL) return numbers_of(rest, tolerances_of(size, largest, n, rtol, out, rest));
    for (Py_ssize_t k = 0; k < n; ++k) out[k] = size[k] > 0.0 ? size[k] : (largest[k] > 0.0 ? largest[k] : NAN);
    Py_RETURN_NOTIMPLEMENTED;
}

/* scales(rates, x, p, u, units, alone, begin, end, epoch, rtol, out, otherwise) -> numbers of the states whose scale is
 * not known, or None where it says nothing; units: bytes of an int each; otherwise: scales of states that do not grow,
 * empty for none. Where it is None, out gets the scales of the first states alone, as many as it is long, NaN where
 * none is known, and the result is NotImplemented. */
static PyObject *scales(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    (void)self;
    enum { ROWS = 2 + DEPTH + 6 + 1 + 2 };
    target_t *target = count == 12 ? target_of(args[0]) : NULL;
    Py_buffer views[ARRAYS], out, otherwise;
    char *units;
    Py_ssize_t size;
    if (target == NULL || !hold(target, args + 1, views)) Py_RETURN_NONE;
    const Py_ssize_t n = target->length[X];
    const int first = args[11] == Py_None;
    const Py_ssize_t considered = first ? PyObject_Length(args[10]) : n, given = first ? 0 : PyObject_Length(args[11]);
    PyObject *unknown = NULL;
    if (PyBytes_AsStringAndSize(args[4], &units, &size) == 0 && size == n * (Py_ssize_t)sizeof(int) &&
        considered >= 0 && considered <= n && (given == 0 || given == n) && fits(args[10], &out, considered, 1)) {
        double *work = PyMem_Malloc((size_t)ROWS * (size_t)n * sizeof(double));
        const int held = given == 0 || fits(args[11], &otherwise, n, 0);
        if (work != NULL && held) {
            double *room = work + (ROWS - 3) * n, *whole = first ? room + n : NULL;
            prepare(target, views[P].buf);
            if (first) memcpy(whole, views[X].buf, (size_t)n * sizeof *whole);
            const rates_t rates = {target, views[U].buf, PyFloat_AsDouble(args[8]), considered, room, whole};
            const compared_t compared = {(const int *)(const void *)units, (int)PyLong_AsLong(args[5]),
                                         given == n && n > 0 ? otherwise.buf : NULL, PyFloat_AsDouble(args[6]),
                                         PyFloat_AsDouble(args[7])};
            const double rtol = PyFloat_AsDouble(args[9]);
            if (!PyErr_Occurred()) unknown = scales_from(&rates, views[X].buf, &compared, rtol, out.buf, work);
        }
        if (held && given > 0) PyBuffer_Release(&otherwise);
        PyMem_Free(work);
        PyBuffer_Release(&out);
    }
    let_go(views);
    if (unknown != NULL || PyErr_Occurred()) return unknown;
    Py_RETURN_NONE;
}

/* The bound of the norm of the Jacobian by differences; atol / rtol, or a part of the largest state of its unit, is
 * what a state is moved as if it were of that size at least. work: 6 n doubles. */
static double steepest_of(const rates_t *r, double t, const double *x, const int *unit, const double *atol, double rtol,
                          double *work) {
    const Py_ssize_t n = r->n;
    double *here = work, *there = here + n, *point = there + n, *sums = point + n, *size = sums + n, *least = size + n;
    double bound = 0.0;
    for (Py_ssize_t k = 0; k < n; ++k) {
        size[k] = fabs(x[k]);
        point[k] = x[k];
        sums[k] = 0.0;
    }
    largest_of_unit(unit, size, n, here, least);
    slope_at(r, t, x, here);
    for (Py_ssize_t j = 0; j < n; ++j) {
        const double by_unit = PART * least[j], by_atol = atol[j] / rtol, smallest = by_atol > by_unit ? by_atol : by_unit;
        point[j] = x[j] + 0x1p-26 * (size[j] > smallest ? size[j] : smallest);
        slope_at(r, t, point, there);
        for (Py_ssize_t k = 0; k < n; ++k) sums[k] += fabs(there[k] - here[k]) / (point[j] - x[j]);
        point[j] = x[j];
    }
    for (Py_ssize_t k = 0; k < n; ++k)
        if (!(sums[k] <= bound)) bound = sums[k];
    return bound;
}

/* steepest(rates, x, p, u, units, t, atol, rtol) -> the bound that `codegen.integrate.choice.promising` looks at,
 * but for rounding, or None */
static PyObject *steepest(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    (void)self;
    target_t *target = count == 8 ? target_of(args[0]) : NULL;
    Py_buffer views[ARRAYS], atol;
    char *units;
    Py_ssize_t size;
    if (target == NULL || !hold(target, args + 1, views)) Py_RETURN_NONE;
    const Py_ssize_t n = target->length[X];
    double bound = NAN;
    if (PyBytes_AsStringAndSize(args[4], &units, &size) == 0 && size == n * (Py_ssize_t)sizeof(int) &&
        fits(args[6], &atol, n, 0)) {
        double *work = PyMem_Malloc(6 * (size_t)n * sizeof(double));
        if (work != NULL) {
            prepare(target, views[P].buf);
            const rates_t rates = {target, views[U].buf, 0.0, n, NULL, NULL};
            bound = steepest_of(&rates, PyFloat_AsDouble(args[5]), views[X].buf, (const int *)(const void *)units,
                                atol.buf, PyFloat_AsDouble(args[7]), work);
            PyMem_Free(work);
        }
        PyBuffer_Release(&atol);
    }
    let_go(views);
    if (PyErr_Occurred()) return NULL;
    if (!isfinite(bound)) Py_RETURN_NONE;
    return PyFloat_FromDouble(bound);
}

/* --- the first call of a generated integrator ------------------------------------------------------- */

typedef struct {
    double *t, *x, *dense;
    const double *grid;
    size_t capacity, count, grid_count, next;
} output_t;
typedef int (*start_t)(void *, const double *, const double *);
typedef int (*run_t)(void *, const double *, void *, long long);
enum { PAUSED = 3 };

/* What every structure of an integrator has in this order. */
typedef struct {
    long long steps, rejected, evaluations;
    int status, which;
} counts_t;

/* begun(start, run, memory, p, u, t, x, grid or None, first, counts, attempts)
 *     -> (status, rows, steps, rejected, evaluations, which, time)
 *
 * memory: the structure of the integrator, which begins with its time, and behind it that of its output; counts:
 * where counts_t is in it, in bytes; first: where its states are, in doubles, if the start is to be the first row
 * of t and x, else -1. Other threads run meanwhile. */
static PyObject *begun(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    (void)self;
    enum { MEMORY = 2, GIVEN_P, GIVEN_U, TIMES, STATES, GRID };
    Py_buffer views[GRID + 1];
    PyObject *result = NULL;
    int held = MEMORY, status = 0;
    if (count != 11) return PyErr_Format(PyExc_TypeError, "begun takes 11 arguments");
    void *start = PyLong_AsVoidPtr(args[0]), *run = PyLong_AsVoidPtr(args[1]);
    const Py_ssize_t first = PyLong_AsSsize_t(args[8]), place = PyLong_AsSsize_t(args[9]);
    const long long attempts = PyLong_AsLongLong(args[10]);
    if (PyErr_Occurred()) return NULL;
    const int last = args[GRID] == Py_None ? STATES : GRID;
    for (; held <= last; ++held) {
        const int written = held == MEMORY || held == TIMES || held == STATES;
        if (PyObject_GetBuffer(args[held], views + held, written ? PyBUF_WRITABLE : PyBUF_SIMPLE) != 0) goto done;
    }
    double *memory = views[MEMORY].buf, *t = views[TIMES].buf, *x = views[STATES].buf;
    output_t *o = (output_t *)(void *)((char *)views[MEMORY].buf + views[MEMORY].len) - 1;
    const size_t rows = (size_t)views[TIMES].len / sizeof *t, n = (size_t)views[STATES].len / sizeof *x / rows;
    const size_t head = first >= 0;
    if (head) {
        t[0] = memory[0];
        memcpy(x, memory + first, n * sizeof *x);
    }
    o->t = t + head;
    o->x = x + head * n;
    o->capacity = rows - head;
    if (last == GRID) {
        o->grid = views[GRID].buf;
        o->grid_count = (size_t)views[GRID].len / sizeof(double);
    }
    const double *p = views[GIVEN_P].len ? views[GIVEN_P].buf : NULL, *u = views[GIVEN_U].len ? views[GIVEN_U].buf : NULL;
    Py_BEGIN_ALLOW_THREADS
    status = ((start_t)start)(memory, p, u);
    if (status == PAUSED && attempts > 0) status = ((run_t)run)(memory, u, o, attempts);
    Py_END_ALLOW_THREADS
    const counts_t *c = (const counts_t *)(const void *)((const char *)memory + place);
    result = Py_BuildValue("(inLLLid)", status, (Py_ssize_t)(o->count + head), c->steps, c->rejected, c->evaluations,
                           c->which, memory[0]);
done:
    while (held-- > MEMORY) PyBuffer_Release(views + held);
    return result;
}

#define QUICK(name, words) {#name, (PyCFunction)(void (*)(void))name, METH_FASTCALL, words}
