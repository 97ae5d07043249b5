static int is_small(const double *b, int n, double noise, double from, double to) {
    double slope;
    return fabs(value_at(b, n, 0.5 * (from + to), &slope)) <= noise;
}

static void put(root *items, int *count, root item) {
    int k = (*count)++;
    for (; k > 0 && items[k - 1].at > item.at; --k) items[k] = items[k - 1];
    items[k] = item;
}

/* Crossings, stationary points within the noise of zero, and zeros at the ends, in order. */
static int candidates(const double *b, int n, double noise, int is_first, int before_start, root *items) {
    root still[D + 1];
    double d[D], slope;
    int flat, other, first, last, count = crossings(b, n, noise, items, &flat);
    changes_of_sign(b, n, &first, &last);
    if (flat || fabs(b[0]) <= noise || fabs(b[n]) <= noise) {
        for (int j = 0; j < n; ++j) d[j] = b[j + 1] - b[j];
        const int many = crossings(d, n - 1, noise, still, &other);
        for (int k = 0; k < many; ++k)
            if (fabs(value_at(b, n, still[k].at, &slope)) <= noise) put(items, &count, (root){still[k].at, 0, 0});
    }
    if (before_start == APPROACHED && sign_of(b[0]) * (b[1] - b[0]) > 0.0) put(items, &count, (root){0.0, 0, 0});
    if (is_first && b[0] == 0.0) put(items, &count, (root){0.0, first, 0});
    if (b[n] == 0.0) put(items, &count, (root){1.0, fabs(b[n - 1]) > noise ? -last : 0, 0});
    return count;
}

/* All roots in order, at most 2 n + 2: a zero at 1 is one, a zero at 0 only if is_first. Roots between
 * which the polynomial is within the noise are one: a crossing if their number is odd, else a touch.
 * *before: how the last interval ended, FAR at first; it becomes how this one ends. */
static int roots_of(const double *b, int n, double noise, int is_first, int *before, root *found) {
    root items[2 * D + 4];
    const int at_start = fabs(b[0]) <= noise, at_end = fabs(b[n]) <= noise;
    const int begun = at_start ? *before : FAR;
    const double size = largest(b, n);
    int made = 0;
    *before = FAR;
    if (size == 0.0) {
        if (is_first) found[made++] = (root){0.0, 0, 0};
        return made;
    }
    const int count = candidates(b, n, noise, is_first, begun, items);
    for (int k = 0, end; k < count; k = end) {
        int crossed = items[k].turn != 0, turn = items[k].turn;
        for (end = k + 1; end < count && is_small(b, n, noise, items[end - 1].at, items[end].at); ++end) {
            crossed += items[end].turn != 0;
            if (turn == 0) turn = items[end].turn;
        }
        root one = {0.5 * (items[k].at + items[end - 1].at), 0, 0};
        for (int j = k, nth = 0; j < end; ++j) {
            nth += items[j].turn != 0;
            if (crossed % 2 ? items[j].turn != 0 && nth == (crossed + 1) / 2 : items[j].turn == 0) {
                one.at = items[j].at;
                break;
            }
        }
        if (crossed % 2) one.turn = turn, one.simple = end == k + 1 && items[k].simple;
        const int is_old = k == 0 && begun == REPORTED && one.turn == 0 && is_small(b, n, noise, 0.0, items[0].at);
        if (!is_old) found[made++] = one;
    }
    if (at_end && count > 0 && is_small(b, n, noise, items[count - 1].at, 1.0)) *before = REPORTED;
    else if (at_end && sign_of(b[n]) * (b[n] - b[n - 1]) < 0.0) *before = APPROACHED;
    return made;
}

