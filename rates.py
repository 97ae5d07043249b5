def f(t, y, p):
    w1, w2, w3 = y
    I1, I2, I3 = p
    return [(I2 - I3) * w2 * w3 / I1, (I3 - I1) * w3 * w1 / I2, (I1 + I2) * w1 * w2 / I3]
