// Projection after steps (`project`), projection.c in JavaScript: the state is brought back onto invariants by
// the least change in states over their scales (Hairer, Lubich and Wanner, Geometric Numerical Integration,
// 2nd ed., sect. IV.4). `projection` of the module gives their values, what these are to be, and derivatives
// by the states, PROJECTION_PATTERN whose these are, UNITS which states are measured together. What an
// invariant is to be is a parameter behind the others; where it is no number, or left out, the value is kept
// that the invariant has at the start (`begin`).
function projector(system, rtol, atol) {
  const { projection, SIZES, PROJECTION_PATTERN: pattern, UNITS } = system;
  const n = SIZES.rates, count = (SIZES.projection - pattern.length) / 2;
  const unit = UNITS.map((name) => UNITS.indexOf(name));
  const rows = Array.from({ length: count }, () => new Float64Array(n));
  const value = new Float64Array(SIZES.projection), largest = new Float64Array(n), change = new Float64Array(n);
  const left = new Float64Array(count), noise = new Float64Array(count), spread = new Float64Array(count);
  const whole = new Float64Array(count), free = new Uint8Array(count), nothing = new Float64Array(n);
  const first = new Float64Array(count);
  const allowed = Math.max(rtol, 1024 * Number.EPSILON) / 16;
  return { begin, project, projectPoint };

  function product(a, b) {
    let sum = 0;
    for (let i = 0; i < n; ++i) sum += a[i] * b[i];
    return sum;
  }

  // The derivatives by the states over their scales, and how far rounding alone can move each invariant.
  function gradients(x) {
    for (let k = 0; k < count; ++k) {
      noise[k] = Math.abs(value[k]);
      rows[k].fill(0);
    }
    for (let e = 0; e < pattern.length; ++e) {
      const [r, c] = pattern[e], slope = value[2 * count + e];
      rows[r][c] = slope * largest[unit[c]];
      noise[r] += Math.abs(slope * x[c]);
    }
    for (let k = 0; k < count; ++k) noise[k] *= 2 * Number.EPSILON;
  }

  // The least change, in scaled states: gradients orthogonalised one by one, that with most left of it first;
  // one counts while rounding moves the state along what is left of it by less than a part of the tolerance.
  function leastChange() {
    let moved = false;
    for (let k = 0; k < count; ++k) moved = moved || Math.abs(left[k]) > noise[k];
    if (!moved) return false;
    moved = false;
    change.fill(0);
    for (let k = 0; k < count; ++k) {
      whole[k] = Math.sqrt(product(rows[k], rows[k]));
      spread[k] = noise[k];
      free[k] = 1;
    }
    for (;;) {
      let most = 0, square = 0, best = -1;
      for (let k = 0; k < count; ++k) {
        const rest = product(rows[k], rows[k]), length = Math.sqrt(rest);
        if (!free[k] || !(length * allowed > spread[k]) || !(length > most * whole[k])) continue;
        most = length / whole[k];
        square = rest;
        best = k;
      }
      if (best < 0) return moved && product(change, change) < 0.0625;
      free[best] = 0;
      const step = Math.abs(left[best]) > noise[best] ? left[best] / square : 0;
      moved = moved || step !== 0;
      for (let i = 0; i < n; ++i) change[i] += step * rows[best][i];
      for (let k = 0; k < count; ++k) {
        if (!free[k]) continue;
        const part = product(rows[k], rows[best]) / square;
        left[k] -= step * part * square;
        spread[k] += Math.abs(part) * spread[best];
        for (let i = 0; i < n; ++i) rows[k][i] -= part * rows[best][i];
      }
    }
  }

  function begin(t, x, p, u) {
    projection(t, x, p, u, value);
    for (let k = 0; k < count; ++k) first[k] = value[k];
  }

  // Bring x, with what its rounding lost in xLow, back onto the invariants. Whether x was moved.
  function project(t, x, xLow, p, u) {
    let moved = false;
    for (let turn = 0; turn < 4; ++turn) {
      largest.fill(atol / rtol);
      for (let i = 0; i < n; ++i) largest[unit[i]] = Math.max(largest[unit[i]], Math.abs(x[i]));
      projection(t, x, p, u, value);
      for (let k = 0; k < count; ++k) {
        const kept = value[count + k];
        left[k] = (Number.isNaN(kept) ? first[k] : kept) - value[k];
      }
      gradients(x);
      if (!leastChange()) return moved;
      for (let i = 0; i < n; ++i) {
        const b = xLow[i] + largest[unit[i]] * change[i], sum = x[i] + b, part = sum - x[i];
        xLow[i] = (x[i] - (sum - part)) + (b - part);
        x[i] = sum;
      }
      moved = true;
    }
    return moved;
  }

  // The same for a state between two steps.
  function projectPoint(t, x, p, u) {
    project(t, x, nothing.fill(0), p, u);
  }
}
