/* Calls function argv[2] of library argv[1] argv[3] times, for a program that counts instructions. */
#include <dlfcn.h>
#include <stdlib.h>

enum { ROOM = 256 };
typedef void (*rates_t)(double t, const double *x, const double *p, const double *u, double *dx);

int main(int argc, char **argv) {
    double x[ROOM], p[ROOM], u[ROOM], dx[ROOM];
    if (argc != 4) return 2;
    void *library = dlopen(argv[1], RTLD_NOW);
    if (library == NULL) return 3;
    void *symbol = dlsym(library, argv[2]);
    if (symbol == NULL) return 4;
    for (int k = 0; k < ROOM; ++k) x[k] = p[k] = u[k] = 0.5 + k / (2.0 * ROOM);
    const rates_t f = *(rates_t *)&symbol;
    const long calls = atol(argv[3]);
    for (long k = 0; k < calls; ++k) f(0.0, x, p, u, dx);
    return 0;
}
