#define TERMS 40      /* coefficients of the series at most */
#define LONGEST 0.5   /* radians of a part of a free turn, before and at most */
#define MOST_PARTS 1e8

/* One part of the torque-free motion of a body with principal axes: series in the part of the time that
 * has passed, until two terms in a row are lost in rounding. w: body rates times the time, replaced by
 * those at the end; e: the turn less one. With n the unit vector along the momentum, n0 at the start, the
 * body turns by chi about n0 and then by the least turn that takes n0 to n; d chi/dt = (w n + w n0)/(1 + n n0),
 * where w n is constant. Returns 0 if the series does not end. */
static int free_part(const double *moments, const double *ratios, double *w, double *e) {
    double W[3][TERMS + 1], c[TERMS + 1], B[TERMS + 1], n0[3], scale[3], chi = 0.0;
    const double m[3] = {moments[0] * w[0], moments[1] * w[1], moments[2] * w[2]};
    const double most = fmax(fabs(m[0]), fmax(fabs(m[1]), fabs(m[2])));
    const double a0 = m[0] / most, a1 = m[1] / most, a2 = m[2] / most;
    const double length = sqrt(a0 * a0 + a1 * a1 + a2 * a2);
    const double size = fabs(w[0]) + fabs(w[1]) + fabs(w[2]);
    double constant = 0.0;
    int last = 0, quiet = 0;
    n0[0] = a0 / length, n0[1] = a1 / length, n0[2] = a2 / length;
    for (int i = 0; i < 3; ++i) {
        W[i][0] = w[i];
        scale[i] = moments[i] / most / length;
        constant += w[i] * n0[i];
    }
    B[0] = 2.0;
    c[0] = constant;
    for (int k = 0; k < TERMS && quiet < 2; ++k) {
        double s0 = 0.0, s1 = 0.0, s2 = 0.0;
        for (int j = 0; j <= k; ++j) {
            s0 += W[1][j] * W[2][k - j];
            s1 += W[2][j] * W[0][k - j];
            s2 += W[0][j] * W[1][k - j];
        }
        last = k + 1;
        const double part = 1.0 / last;
        W[0][last] = ratios[0] * s0 * part;
        W[1][last] = ratios[1] * s1 * part;
        W[2][last] = ratios[2] * s2 * part;
        double top = 0.0, change = 0.0;
        B[last] = 0.0;
        for (int i = 0; i < 3; ++i) {
            top += W[i][last] * n0[i];
            B[last] += scale[i] * W[i][last] * n0[i];
            change = fmax(change, fmax(fabs(W[i][last]) / size, fabs(scale[i] * W[i][last])));
        }
        for (int j = 1; j <= last; ++j) top -= B[j] * c[last - j];
        c[last] = 0.5 * top;
        change = fmax(change, fabs(c[last]) / (last + 1));
        quiet = change <= 0x1p-58 ? quiet + 1 : 0;
    }
    if (quiet < 2) return 0;
    double d[3], s[3];
    for (int i = 0; i < 3; ++i) {
        double sum = 0.0;
        for (int k = last; k > 0; --k) sum += W[i][k];
        d[i] = scale[i] * sum;
        w[i] += sum;
    }
    for (int k = last; k >= 0; --k) chi += c[k] / (k + 1);
    const double over = 1.0 / sqrt(4.0 - (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
    s[0] = over * (d[1] * n0[2] - d[2] * n0[1]);
    s[1] = over * (d[2] * n0[0] - d[0] * n0[2]);
    s[2] = over * (d[0] * n0[1] - d[1] * n0[0]);
    const double square = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
    double versed, sinc, rest, both[4];
    turns(0.25 * chi * chi, &versed, &sinc, &rest);
    const double first[4] = {versed, 0.5 * chi * sinc * n0[0], 0.5 * chi * sinc * n0[1], 0.5 * chi * sinc * n0[2]};
    const double second[4] = {-square / (1.0 + sqrt(1.0 - square)), s[0], s[1], s[2]};
    multiplied(first, second, both);
    for (int i = 0; i < 4; ++i) e[i] = first[i] + second[i] + both[i];
    return 1;
}

/* The torque-free motion over the time h from the body rates omega, principal axes: the turn less one. The
 * series are those of parts in which the body turns by at most LONGEST. */
static void free_turn(const double *moments, const double *ratios, double h, const double *omega, double *e) {
    const double most = fmax(fabs(omega[0]), fmax(fabs(omega[1]), fabs(omega[2])));
    double parts = ceil(most * fabs(h) / LONGEST);
    for (int i = 0; i < 4; ++i) e[i] = 0.0;
    if (most * fabs(h) < 1e-100) {
        for (int i = 0; i < 3; ++i) e[i + 1] = 0.5 * h * omega[i];
        return;
    }
    if (!(parts <= MOST_PARTS)) {
        e[0] = NAN;
        return;
    }
    double length = 1.0 / parts, w[3];
    for (int i = 0; i < 3; ++i) w[i] = omega[i] * (h * length);
    for (double k = 0.0; k < parts; k += 1.0) {
        double again[3] = {w[0], w[1], w[2]}, turn[4], both[4];
        if (!free_part(moments, ratios, again, turn)) {
            /* shorter parts, for as long as it takes */
            for (int i = 0; i < 3; ++i) w[i] *= 0.5;
            parts += parts - k;
            k -= 1.0;
            if (parts <= MOST_PARTS) continue;
            e[0] = NAN;
            return;
        }
        multiplied(e, turn, both);
        for (int i = 0; i < 4; ++i) e[i] += turn[i] + both[i];
        for (int i = 0; i < 3; ++i) w[i] = again[i];
    }
}
