/* Bounds of the states over the last step, by the sizes of all terms. */
static void box_of_step(const @PREFIX@ *s, double *box) {
    for (int i = 0; i < N; ++i) {
        double far = 0.0;
        for (int k = P - 1; k >= 0; --k) far = (far + fabs(s->jet[k][i])) * fabs(s->h_old);
        box[2 * i] = s->x_old[i] - far, box[2 * i + 1] = s->x_old[i] + far;
    }
}
