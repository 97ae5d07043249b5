/* Whether the run starts within the margin of a singularity, number "which"; distances begin here. */
static int starts_singular(@PREFIX@ *s, const double *u) {
#if S
    @NAME@_singularities(s->t, s->x, &s->constants, u, s->singular);
    for (int k = 0; k < S; ++k) {
        s->closest[k] = fabs(s->singular[k]);
        if (s->closest[k] <= s->margin) {
            s->which = k;
            return 1;
        }
    }
#else
    (void)s, (void)u;
#endif
    return 0;
}

