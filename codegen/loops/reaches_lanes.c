/* How far argument m moves in the time h, at most, in any direction of the complex plane: the last two terms
 * count twice, as what follows them falls at least like a half. The row is its limit, then its coefficients. */
INLINE_ lane_ moved_(const run_ *r, int m, lane_ h) {
    const lane_ *q = r->jet + @FIRST@ + @LINEAR@ + m * P;
    lane_ sum = h * (2.0 * lanes_abs_(q[P - 1]));
    sum = h * (sum + 2.0 * lanes_abs_(q[P - 2]));
    for (int k = P - 3; k > 0; --k) sum = h * (sum + lanes_abs_(q[k]));
    return sum;
}

/* The part of a step h in which argument m stays within its limit, to within 2 %. */
APART_ lane_ shortened_(const run_ *r, int m, lane_ h, lane_ smallest) {
    const lane_ limit = r->jet[@FIRST@ + @LINEAR@ + m * P];
    lane_ far = h;
    for (;;) {
        const mask_ again = (mask_)(h > smallest) & ~(mask_)(moved_(r, m, h) <= limit);
        if (!any_(again)) break;
        far = lanes_choose_(again, h, far);
        h = lanes_choose_(again, 0.125 * h, h);
    }
    for (int k = 0; k < 7; ++k) {
        lane_ between;
        EACH(n) between[n] = sqrt(h[n]) * sqrt(far[n]);
        const mask_ inside = (mask_)(moved_(r, m, between) <= limit);
        h = lanes_choose_(inside, between, h);
        far = lanes_choose_(inside, far, between);
    }
    return h;
}

/* The part of a step h in which every argument stays where its series may be trusted (codegen/watch/trust.py). */
INLINE_ lane_ within_reach_(const run_ *r, lane_ h, lane_ smallest) {
#if @LINEAR@
    h = smaller_(h, r->jet[@FIRST@]);
#endif
    for (int m = 0; m < @LIMITS@; ++m) {
        const mask_ beyond = r->active & ~(mask_)(moved_(r, m, h) <= r->jet[@FIRST@ + @LINEAR@ + m * P]);
        if (any_(beyond)) h = lanes_choose_(beyond, shortened_(r, m, h, smallest), h);
    }
    return h;
}

