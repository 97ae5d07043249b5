/* A jump of the rates may put value i off by so much. Kept is the worst, against what may be allowed from there on. */
static inline void keep_jump(@PREFIX@ *s, int i, double t, double off, double allowed) {
    if (off * s->allowed[i] > s->off[i] * allowed) {
        s->off[i] = fmax(off, s->off[i]);
        s->allowed[i] = allowed;
        s->off_at[i] = t;
    }
    s->allowed[i] = fmax(s->allowed[i], allowed);
}

