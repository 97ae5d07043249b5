/* Where a motion starts: states by the numbers of the page, made consistent where constraints hold.

   createStart(data) takes what `eom.views.live.page` writes. number(values, name) is a number by name: a knob,
   or a part of a quaternion whose angles are knobs. consistent(system, held, values, keep) returns the values
   nearest to those given that meet the constraints, coordinates first, then speeds; what is in keep stays.
   Least changes by Levenberg's and Marquardt's iteration, damped by what is left (Yamashita and Fukushima,
   Computing Suppl. 15 (2001) 239), as eom.multibody.assemble has it; of attitudes in their angles. */
"use strict";

const createStart = (data) => {
  const TURNS = 200, SLOW = 8, BARELY = 1e-4, CLOSE = 1e-11;
  const radians = Math.PI / 180;
  const speeds = new Set(data.speeds);
  const starts = data.knobs.filter((k) => k.group === "start");
  const isStart = new Set(starts.map((k) => k.name));
  const parts = new Map(), angles = new Map();
  data.attitudes.forEach((a) => {
    a.states.forEach((name, k) => parts.set(name, [a, k]));
    a.knobs.forEach((name, k) => angles.set(name, [a, k]));
  });
  return {number, consistent, isStart: (name) => isStart.has(name)};

  /* The quaternion of an attitude, or its derivative by the angle of number `by` (in radians). */
  function quaternion(values, attitude, by = -1) {
    return attitude.sequence.reduce((q, axis, k) => {
      const half = (values.get(attitude.knobs[k]) * radians) / 2;
      const turn = k === by ? [-Math.sin(half) / 2, 0, 0, 0] : [Math.cos(half), 0, 0, 0];
      turn[axis] = k === by ? Math.cos(half) / 2 : Math.sin(half);
      return EOM_ROTATIONS.product(q, turn);
    }, [1, 0, 0, 0]);
  }

  function number(values, name) {
    if (values.has(name)) return values.get(name);
    if (!parts.has(name)) return 0;
    const [attitude, k] = parts.get(name);
    return quaternion(values, attitude)[k];
  }

  /* What states a knob moves, by number, and how fast; of angles by radians. */
  function column(system, values, knob) {
    if (!angles.has(knob.name)) return [[system.STATES.indexOf(knob.name), 1]];
    const [attitude, by] = angles.get(knob.name);
    const slopes = quaternion(values, attitude, by);
    return attitude.states.map((name, k) => [system.STATES.indexOf(name), slopes[k]]);
  }

  function moved(values, free, change) {
    const found = new Map(values);
    free.forEach((k, n) => found.set(k.name, values.get(k.name) + change[n] / (angles.has(k.name) ? radians : 1)));
    return found;
  }

  /* What is left of some constraints, and its derivatives by the knobs that are free. */
  function linear(system, rows, free, values) {
    const {PROJECTION_PATTERN: pattern, SIZES} = system, count = (SIZES.projection - pattern.length) / 2;
    const x = Float64Array.from(system.STATES, (name) => number(values, name));
    const [p, u] = [system.PARAMETERS, system.INPUTS].map((names) => Float64Array.from(names, (n) => number(values, n)));
    const out = system.projection(0, x, p, u), whole = rows.map(() => new Float64Array(x.length));
    pattern.forEach(([r, c], e) => { if (rows.includes(r)) whole[rows.indexOf(r)][c] = out[2 * count + e]; });
    const columns = free.map((k) => column(system, values, k));
    return {
      left: rows.map((r) => out[r] - out[count + r]),
      slopes: whole.map((row) => columns.map((c) => c.reduce((sum, [i, s]) => sum + (i < 0 ? 0 : row[i] * s), 0))),
      size: Math.max(1, ...x.map(Math.abs)),
    };
  }

  function dot(a, b) {
    return a.reduce((sum, x, i) => sum + x * b[i], 0);
  }

  function norm(left) {
    const found = Math.sqrt(dot(left, left));
    return Number.isFinite(found) ? found : Infinity;
  }

  /* The damped least change. */
  function change({left, slopes}, damping) {
    const gram = slopes.map((a) => slopes.map((b) => dot(a, b)));
    const largest = Math.max(0, ...gram.map((row, i) => row[i]));
    gram.forEach((row, i) => { row[i] += damping + 1e-15 * largest + 1e-300; });
    const y = solved(gram, left.map((x) => -x));
    return slopes[0].map((_, n) => slopes.reduce((sum, row, i) => sum + row[n] * y[i], 0));
  }

  /* x with A x = b, by Gaussian elimination with partial pivoting. */
  function solved(A, b) {
    const rows = A.map((row, i) => [...row, b[i]]), n = rows.length, x = new Array(n).fill(0);
    for (let k = 0; k < n; k += 1) {
      let best = k;
      for (let i = k + 1; i < n; i += 1) if (Math.abs(rows[i][k]) > Math.abs(rows[best][k])) best = i;
      [rows[k], rows[best]] = [rows[best], rows[k]];
      for (let i = k + 1; i < n; i += 1) {
        const factor = rows[i][k] / rows[k][k];
        for (let j = k; j <= n; j += 1) rows[i][j] -= factor * rows[k][j];
      }
    }
    for (let k = n - 1; k >= 0; k -= 1) {
      x[k] = rows[k][n];
      for (let j = k + 1; j < n; j += 1) x[k] -= rows[k][j] * x[j];
      x[k] /= rows[k][k];
    }
    return x;
  }

  /* The values nearest to those given at which rows are met, as well as the iteration finds. */
  function closed(system, rows, free, given) {
    let values = given, here = linear(system, rows, free, values), size = norm(here.left), damping = 1, slow = 0;
    for (let turn = 0; free.length && turn < TURNS && size > 0 && slow <= SLOW; turn += 1) {
      const trial = moved(values, free, change(here, damping * Math.min(size * size, size)));
      const there = linear(system, rows, free, trial), next = norm(there.left);
      if (next < size) {
        slow = next > size * (1 - BARELY) ? slow + 1 : 0;
        [values, here, size] = [trial, there, next];
        damping /= 4;
      } else if (damping > 1e12 || size < 1e-15) break;
      else damping *= 8;
    }
    return {values, left: here.left, met: here.left.every((x) => Math.abs(x) <= CLOSE * here.size)};
  }

  function shown(x) {
    return Number.isFinite(x) ? "off by " + Number(x.toPrecision(3)) : "without a value";
  }

  function consistent(system, held, values, keep) {
    let found = values;
    for (const rates of [false, true]) {
      const rows = held.map((_, k) => k).filter((k) => held[k].speeds === rates);
      if (!rows.length) continue;
      const free = starts.filter((k) => !keep.has(k.name) && speeds.has(k.name) === rates);
      const end = closed(system, rows, free, found);
      if (!end.met) {
        const sizes = end.left.map((x) => (Number.isFinite(x) ? Math.abs(x) : Infinity)), worst = sizes.indexOf(Math.max(...sizes));
        const none = rates ? "no speeds near these numbers meet the constraints: " : "no configuration near these numbers meets the constraints: ";
        return {values, message: none + held[rows[worst]].words + " is " + shown(end.left[worst])};
      }
      found = end.values;
    }
    return {values: found, message: ""};
  }
};
