static void roots_in_step(@PREFIX@ *s, const double *end, size_t first, const double *u) {
    int wanted[E];
    for (int m = 0; m < E; ++m) wanted[m] = 1;
    roots_by_values(s, wanted, end, first, u);
}
