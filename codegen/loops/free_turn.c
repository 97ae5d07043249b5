#define TERMS 40      /* coefficients of a series at most */
#define LONGEST 0.5   /* radians that a body turns in one series, at most */
#define MOST_PARTS 1e8

/* exp(a/2) less one: a turn by |a| about a. */
static inline void turn_about(double a0, double a1, double a2, double *e) {
    double versed, sinc, rest;
    turns(0.25 * (a0 * a0 + a1 * a1 + a2 * a2), &versed, &sinc, &rest);
    e[0] = versed, e[1] = 0.5 * sinc * a0, e[2] = 0.5 * sinc * a1, e[3] = 0.5 * sinc * a2;
}

/* e becomes the turn e followed by other, both less one. */
static inline void follow(double *e, const double *other) {
    double both[4];
    multiplied(e, other, both);
    for (int i = 0; i < 4; ++i) e[i] += other[i] + both[i];
}

/* 1/(k + 1) */
static const double parts[TERMS + 1] = {
    1.0 / 1, 1.0 / 2, 1.0 / 3, 1.0 / 4, 1.0 / 5, 1.0 / 6, 1.0 / 7, 1.0 / 8, 1.0 / 9, 1.0 / 10,
    1.0 / 11, 1.0 / 12, 1.0 / 13, 1.0 / 14, 1.0 / 15, 1.0 / 16, 1.0 / 17, 1.0 / 18, 1.0 / 19, 1.0 / 20,
    1.0 / 21, 1.0 / 22, 1.0 / 23, 1.0 / 24, 1.0 / 25, 1.0 / 26, 1.0 / 27, 1.0 / 28, 1.0 / 29, 1.0 / 30,
    1.0 / 31, 1.0 / 32, 1.0 / 33, 1.0 / 34, 1.0 / 35, 1.0 / 36, 1.0 / 37, 1.0 / 38, 1.0 / 39, 1.0 / 40,
    1.0 / 41,
};

/* One part of the torque-free motion about principal axes, as series in the part of the time that has
 * passed, until two terms in a row are lost in rounding. w: body rates times the time, gained: what they gain
 * on the way; e: the turn less one. n: the unit vector along the momentum, n0 at the start. The body turns
 * by chi about n0 and then by the least turn that takes n0 to n: d chi/dt = (w n + w n0)/(1 + n n0), where
 * w n is constant. The four sums of products of each order stand in lanes: w2 w3, w3 w1, w1 w2, and that
 * of the quotient. Returns 0 if a series does not end. */
static int free_part(const double *moments, const double *ratios, const double *w, double *gained, double *e) {
    double left[TERMS + 1][4], right[TERMS + 1][4], n0[3], scale[3], along[3], c[TERMS + 1];
    const double m[3] = {moments[0] * w[0], moments[1] * w[1], moments[2] * w[2]};
    const double most = larger(fabs(m[0]), larger(fabs(m[1]), fabs(m[2])));
    const double a0 = m[0] / most, a1 = m[1] / most, a2 = m[2] / most;
    const double over_length = 1.0 / sqrt(a0 * a0 + a1 * a1 + a2 * a2);
    const double over_size = 1.0 / (fabs(w[0]) + fabs(w[1]) + fabs(w[2])), over_momentum = over_length / most;
    int last = 0, quiet = 0;
    n0[0] = a0 * over_length, n0[1] = a1 * over_length, n0[2] = a2 * over_length;
    for (int i = 0; i < 3; ++i) {
        scale[i] = moments[i] * over_momentum;
        along[i] = scale[i] * n0[i];
        left[0][i] = w[(i + 1) % 3];
        right[0][i] = w[(i + 2) % 3];
    }
    c[0] = w[0] * n0[0] + w[1] * n0[1] + w[2] * n0[2];
    left[0][3] = 0.0;
    while (last < TERMS && quiet < 2) {
        double sum[4] = {0.0, 0.0, 0.0, 0.0};
        right[last][3] = 0.0; /* of the order that is to be found: its factor is zero */
        for (int j = 0; j <= last; ++j)
            for (int i = 0; i < 4; ++i) sum[i] += left[j][i] * right[last - j][i];
        const double part = parts[last];
        const double w0 = ratios[0] * sum[0] * part, w1 = ratios[1] * sum[1] * part, w2 = ratios[2] * sum[2] * part;
        const double below = along[0] * w0 + along[1] * w1 + along[2] * w2;
        const double next = 0.5 * (w0 * n0[0] + w1 * n0[1] + w2 * n0[2] - below * c[0] - sum[3]);
        right[last][3] = next;
        last += 1;
        c[last] = next;
        left[last][0] = w1, left[last][1] = w2, left[last][2] = w0, left[last][3] = below;
        right[last][0] = w2, right[last][1] = w0, right[last][2] = w1;
        const double most_rate = larger(fabs(w0), larger(fabs(w1), fabs(w2))) * over_size;
        const double most_n = larger(fabs(scale[0] * w0), larger(fabs(scale[1] * w1), fabs(scale[2] * w2)));
        quiet = larger(larger(most_rate, most_n), fabs(next) * part) <= 0x1p-58 ? quiet + 1 : 0;
    }
    if (quiet < 2) return 0;
    double sum0 = 0.0, sum1 = 0.0, sum2 = 0.0, chi = 0.0;
    for (int k = last; k > 0; --k) {
        sum0 += left[k][2], sum1 += left[k][0], sum2 += left[k][1];
        chi += c[k] * parts[k];
    }
    chi += c[0];
    gained[0] = sum0, gained[1] = sum1, gained[2] = sum2;
    const double d0 = scale[0] * sum0, d1 = scale[1] * sum1, d2 = scale[2] * sum2;
    const double over = 1.0 / sqrt(4.0 - (d0 * d0 + d1 * d1 + d2 * d2));
    const double s0 = over * (d1 * n0[2] - d2 * n0[1]), s1 = over * (d2 * n0[0] - d0 * n0[2]);
    const double s2 = over * (d0 * n0[1] - d1 * n0[0]), square = s0 * s0 + s1 * s1 + s2 * s2;
    const double least[4] = {-square / (1.0 + sqrt(1.0 - square)), s0, s1, s2};
    turn_about(chi * n0[0], chi * n0[1], chi * n0[2], e);
    follow(e, least);
    return 1;
}

/* The motion in parts, each short enough for its series. */
static void triaxial_turn(const double *moments, const double *ratios, double h, const double *omega, double *gained, double *e) {
    const double most = larger(fabs(omega[0]), larger(fabs(omega[1]), fabs(omega[2])));
    double count = larger(1.0, ceil(most * fabs(h) / LONGEST)), length = h / count;
    double w[3] = {omega[0] * length, omega[1] * length, omega[2] * length};
    for (int i = 0; i < 4; ++i) e[i] = 0.0;
    for (int i = 0; i < 3; ++i) gained[i] = 0.0;
    while (count > 0.0) {
        double more[3], turn[4];
        if (!(count <= MOST_PARTS)) {
            e[0] = NAN;
            return;
        }
        if (!free_part(moments, ratios, w, more, turn)) {
            count *= 2.0, length *= 0.5;
            for (int i = 0; i < 3; ++i) w[i] *= 0.5;
            continue;
        }
        count -= 1.0;
        follow(e, turn);
        for (int i = 0; i < 3; ++i) gained[i] += more[i] / length, w[i] += more[i];
    }
}

/* The torque-free motion over the time h from the body rates omega about principal axes: what the rates
 * gain, and the turn less one. ratios[i] = (J[i+1] - J[i+2])/J[i]. With two equal moments J, the body turns by
 * h |M|/J about the momentum M, and then by the rest about its axis. */
static void free_turn(const double *moments, const double *ratios, double h, const double *omega, double *gained, double *e) {
    const double most = larger(fabs(omega[0]), larger(fabs(omega[1]), fabs(omega[2])));
    for (int i = 0; i < 3; ++i) gained[i] = 0.0;
    if (most * fabs(h) < 1e-100) {
        turn_about(h * omega[0], h * omega[1], h * omega[2], e);
        return;
    }
    for (int i = 0; i < 3; ++i) {
        if (ratios[i] != 0.0) continue;
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        double a[3] = {h * omega[0], h * omega[1], h * omega[2]}, b[3] = {0.0, 0.0, 0.0}, other[4];
        b[i] = a[i] * ratios[j];
        a[i] *= moments[i] / moments[j];
        turn_about(a[0], a[1], a[2], e);
        turn_about(b[0], b[1], b[2], other);
        follow(e, other);
        const double half = other[i + 1], versed = -2.0 * half * half, sine = 2.0 * half * (1.0 + other[0]);
        gained[j] = versed * omega[j] + sine * omega[k];
        gained[k] = versed * omega[k] - sine * omega[j];
        return;
    }
    triaxial_turn(moments, ratios, h, omega, gained, e);
}
