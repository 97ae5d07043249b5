/* Bounds of the states over the last step: the change from end to end, and a quarter of all other terms, which
 * are multiplied by theta (1 - theta) and less. */
static void box_of_step(const @PREFIX@ *s, double *box) {
    enum { TERMS = sizeof s->dense / sizeof s->dense[0] };
    for (int i = 0; i < N; ++i) {
        double far = 0.0;
        for (int k = 1; k < TERMS; ++k) far += 0.25 * fabs(s->dense[k][i]);
        box[2 * i] = s->x_old[i] + fmin(0.0, s->dense[0][i]) - far;
        box[2 * i + 1] = s->x_old[i] + fmax(0.0, s->dense[0][i]) + far;
    }
}
