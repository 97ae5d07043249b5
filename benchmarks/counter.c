/* Calls function argv[2] of library argv[1] argv[4] times after argv[3], for a program that counts instructions. */
#include <dlfcn.h>
#include <stdlib.h>

enum { ROOM = 256 };
typedef void (*rates_t)(double t, const double *x, const void *c, const double *u, double *dx);
typedef void (*prepare_t)(const double *p, void *c);

int main(int argc, char **argv) {
    double x[ROOM], p[ROOM], u[ROOM], dx[ROOM], c[ROOM];
    if (argc != 5) return 2;
    void *library = dlopen(argv[1], RTLD_NOW);
    if (library == NULL) return 3;
    void *symbol = dlsym(library, argv[2]);
    void *preparation = dlsym(library, argv[3]);
    if (symbol == NULL || preparation == NULL) return 4;
    for (int k = 0; k < ROOM; ++k) x[k] = p[k] = u[k] = 0.5 + k / (2.0 * ROOM);
    const rates_t f = *(rates_t *)&symbol;
    const prepare_t prepare = *(prepare_t *)&preparation;
    const long calls = atol(argv[4]);
    prepare(p, c);
    for (long k = 0; k < calls; ++k) f(0.0, x, c, u, dx);
    return 0;
}
