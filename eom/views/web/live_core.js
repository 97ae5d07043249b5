/* The motion behind a live page: numbers, choices, one integrator; it knows no document.

   createMotion(data, systems, method) takes what `eom.views.live.page` writes: the scene as data, one
   function a right-hand side, and the integrator. Every change starts the motion anew, from the values.
   Under constraints these are made consistent first: after a change of a start value the others change, after
   one of a parameter the start values that were chosen last. */
"use strict";

const createMotion = (data, systems, method) => {
  const TOLERANCE = data.tolerance;
  const values = new Map(data.knobs.map((k) => [k.name, k.value]));
  const knobs = new Map(data.knobs.map((k) => [k.name, k]));
  const off = data.switches.map((s) => s.on);
  const made = new Map(), joined = new Map(), start = createStart(data);
  const motion = {
    values, off, restart, advance, message: "", time: 0, variant: null, view: null, invariants: null,
    first: null, states: null, evaluations: 0, stopped: "", set, choose, original, value, at, inertia, omega,
    left, contact,
  };
  let run = null, samples = null, system = null, p = null, u = null, chosen = new Map(values);

  const key = () => off.map((o) => (o ? "1" : "0")).join("");

  function set(name, number) {
    if (!knobs.has(name)) throw new Error("no number is called " + name);
    values.set(name, number);
    return restart(name);
  }

  function choose(index, on) {
    off[index] = on;
    join(data.variants[key()].equal);
    return restart();
  }

  /* Two moments of inertia that become one take their mean, which every third moment goes with; they get
     their own values back if nobody has changed it. */
  function join(equal) {
    joined.forEach(({other, own, mean}, name) => {
      if (name in equal) return;
      if (values.get(other) === mean) own.forEach(([n, v]) => values.set(n, v));
      joined.delete(name);
    });
    Object.entries(equal).forEach(([name, other]) => {
      if (joined.has(name)) return;
      const own = [name, other].map((n) => [n, values.get(n)]);
      const mean = own[0][1] === own[1][1] ? own[0][1] : Number(((own[0][1] + own[1][1]) / 2).toPrecision(12));
      joined.set(name, {other, own, mean});
      own.forEach(([n]) => values.set(n, mean));
    });
  }

  /* The numbers and the choice of the scene. */
  function original() {
    data.knobs.forEach((k) => values.set(k.name, k.value));
    data.switches.forEach((s, k) => { off[k] = s.on; });
    joined.clear();
    join(data.variants[key()].equal);
    chosen = new Map(values);
    return restart();
  }

  /* A number by name: a knob, or a part of an attitude at the start. */
  function value(name) {
    const other = motion.variant && motion.variant.equal[name];
    return start.number(values, other || name);
  }

  /* The inertia matrix of one body, from the values; null for trees. */
  function inertia() {
    if (!data.inertia.length) return null;
    return data.inertia.map((row) => row.map((name) => (name ? value(name) : 0)));
  }

  /* What no body has, in words; empty where nothing is wrong. */
  function fault() {
    for (const k of data.knobs) {
      if (!Number.isFinite(values.get(k.name))) return k.name + " is no number";
      if (k.positive && !(values.get(k.name) > 0)) return k.name + " must be above zero";
    }
    const J = inertia();
    return J ? EOM_ROTATIONS.inertiaFault(J, data.inertia) : "";
  }

  function load(variant) {
    if (!made.has(variant.system)) {
      const found = systems[variant.system]();
      made.set(variant.system, {
        system: found,
        run: method(found, {rtol: TOLERANCE}),
        samples: createSamples(found, variant.sampled),
        states: new Float64Array(found.SIZES.rates),
        view: new Float64Array(found.SIZES.outputs),
        invariants: new Float64Array(found.SIZES.invariants || 0),
        first: new Float64Array(found.SIZES.invariants || 0),
        scale: new Float64Array(found.SIZES.invariants || 0),
      });
    }
    return made.get(variant.system);
  }

  /* Make the values meet the constraints; in words why they cannot. First what the scene keeps stays, then
     only what was touched. */
  function assemble(touched) {
    const {held} = motion.variant;
    if (!held.length) return "";
    const own = start.isStart(touched) ? [touched] : [];
    const given = own.length ? values : new Map([...values].map(([n, v]) => [n, start.isStart(n) ? chosen.get(n) : v]));
    let end = null;
    for (const keep of [[...data.keep, ...own], own]) {
      end = start.consistent(load(motion.variant).system, held, given, new Set(keep));
      if (!end.message) break;
    }
    const message = end.message || turnedRound(load(motion.variant), end.values);
    if (message) return message;
    end.values.forEach((v, n) => values.set(n, v));
    if (own.length) chosen = new Map(values);
    return "";
  }

  /* Equations of a joint that closes a loop hold, too, where it is turned round; in words which one is. */
  function turnedRound({system: found}, at) {
    const [x, parameters, inputs] = [found.STATES, found.PARAMETERS, found.INPUTS]
      .map((names) => Float64Array.from(names, (n) => start.number(at, n)));
    const v = found.outputs(0, x, parameters, inputs);
    const inSpace = (k, s, i) => (k < 0 ? v[s + i] : [0, 1, 2].reduce((sum, j) => sum + v[s + j] * (v[12 * k + 3 * (j + 1) + i] - v[12 * k + i]), 0));
    for (const {kind, name, bodies: [a, b], at: s, size} of data.fittings) {
      for (let pair = s + 3; kind === "pin" && pair < s + size; pair += 6)
        if ([0, 1, 2].reduce((sum, i) => sum + inSpace(a, pair, i) * inSpace(b, pair + 3, i), 0) < 0)
          return "the joint that closes the loop '" + name + "' is turned round: its axes are opposite";
    }
    return "";
  }

  /* Begin at time zero. Where the values describe no body, or constraints are not met, say so and leave the
     motion as it is. */
  function restart(touched = "") {
    const before = motion.variant;
    motion.variant = data.variants[key()];
    motion.message = fault() || assemble(touched);
    if (motion.message) {
      motion.variant = before || motion.variant;
      return false;
    }
    const parts = load(motion.variant);
    ({system, run, samples} = parts);
    p = Float64Array.from(system.PARAMETERS, value);
    u = Float64Array.from(system.INPUTS, value);
    const from = Float64Array.from(system.STATES, value);
    samples.start();
    samples.change(0, from, p, u);
    run.start(0, from, p, u);
    run.end = samples.next();
    Object.assign(motion, {
      states: parts.states, view: parts.view, invariants: parts.invariants, first: parts.first,
      scale: parts.scale, names: system, time: 0, stopped: "",
    });
    evaluate(0);
    motion.first.set(motion.invariants);
    scales();
    record();
    return true;
  }

  /* What an invariant's drift is compared with: its first value, or, of those that come as components of
     one vector, its length. */
  function scales() {
    system.INVARIANTS.forEach((name, k) => {
      const family = name.replace(/_[123]$/, "");
      let sum = 0;
      system.INVARIANTS.forEach((other, j) => {
        if (other.replace(/_[123]$/, "") === family) sum += motion.first[j] * motion.first[j];
      });
      motion.scale[k] = Math.sqrt(sum) > 1e-12 ? Math.sqrt(sum) : 1;
    });
  }

  function record() {
    const states = {"-2": "numbers are no longer finite", "-1": "the step became too small"};
    if (run.status === 1) motion.stopped = "singular: " + (motion.variant.singular[run.which] || "");
    else if (run.status) motion.stopped = states[run.status];
    motion.evaluations = run.evaluations;
    motion.steps = run.steps;
  }

  function evaluate(t) {
    run.at(t, motion.states);
    system.outputs(t, motion.states, p, u, motion.view);
    if (system.invariants) system.invariants(t, motion.states, p, u, motion.invariants);
    motion.time = t;
  }

  /* Go on to time t with at most so many steps; false where they were too few or the run has ended. */
  function advance(t, steps = Infinity) {
    let reached = run.advance(Math.min(t, run.end), steps);
    while (reached && run.end <= t) {
      samples.change(run.t, run.x, p, u);
      run.refresh();
      run.end = samples.next();
      reached = run.advance(Math.min(t, run.end), steps);
    }
    evaluate(reached ? t : run.t);
    record();
    return reached;
  }

  /* A group of what is drawn, of one body: C (9), omega, H, torque (3 each), in the space frame. */
  function at(group, out) {
    const from = {C: 0, omega: 9, H: 12, torque: 15}[group];
    for (let k = 0; k < out.length; k += 1) out[k] = motion.view[from + k];
    return out;
  }

  /* The angular velocity in the body frame. */
  function omega(out) {
    const v = motion.view;
    for (let i = 0; i < 3; i += 1) out[i] = v[3 * i] * v[9] + v[3 * i + 1] * v[10] + v[3 * i + 2] * v[11];
    return out;
  }

  /* What is left of the constraints now, the largest first; nothing where there are none. */
  function left() {
    return motion.variant.held
      .map(({name, words}) => ({name, words, left: motion.invariants[system.INVARIANTS.indexOf(name)]}))
      .sort((a, b) => Math.abs(b.left) - Math.abs(a.left));
  }

  /* The point at which a fitting of the kind "roll" touches its plane: beneath the centre of a ball, or where an
     ellipsoid of revolution, a disc at the limit, is lowest along the normal. */
  function contact({at: s, bodies: [k]}, out) {
    const v = motion.view, o = 12 * k, radius = v[s], half = v[s + 1];
    const turned = (from, i) => [0, 1, 2].reduce((sum, j) => sum + v[from + j] * (v[o + 3 * (j + 1) + i] - v[o + i]), 0);
    const axis = [0, 1, 2].map((i) => turned(s + 5, i)), n = Array.from(v.subarray(s + 8, s + 11));
    const [a, m] = [Math.hypot(...axis), Math.hypot(...n)];
    const oblate = a ? 1 - (half / radius) ** 2 : 0;
    const along = a ? (axis[0] * n[0] + axis[1] * n[1] + axis[2] * n[2]) / (a * m) : 0;
    const down = Math.sqrt(1 - oblate * along * along);
    for (let i = 0; i < 3; i += 1)
      out[i] = v[o + i] + turned(s + 2, i) - (radius * (n[i] / m - (a ? (oblate * along * axis[i]) / a : 0))) / down;
    return out;
  }

  original();
  return motion;
};

const EOM_ROTATIONS = (() => {
  /* Hamilton's product, scalar first. */
  const product = (p, q) => [
    p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
    p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
    p[0] * q[2] + p[2] * q[0] + p[3] * q[1] - p[1] * q[3],
    p[0] * q[3] + p[3] * q[0] + p[1] * q[2] - p[2] * q[1],
  ];

  /* The unit quaternion of C, which takes components in space to the body: row by row (Shepperd, J. Guid.
     Control 1 (1978) 223). */
  function ofMatrix(C, out = [1, 0, 0, 0]) {
    const trace = C[0] + C[4] + C[8];
    const squares = [1 + trace, 1 + 2 * C[0] - trace, 1 + 2 * C[4] - trace, 1 + 2 * C[8] - trace];
    const n = squares.indexOf(Math.max(...squares));
    const d = 2 * Math.sqrt(squares[n]);
    const less = [C[5] - C[7], C[6] - C[2], C[1] - C[3]];
    const more = [C[5] + C[7], C[6] + C[2], C[1] + C[3]];
    if (n === 0) {
      out[0] = d / 4;
      for (let k = 0; k < 3; k += 1) out[k + 1] = less[k] / d;
      return out;
    }
    const [i, j, k] = [n - 1, n % 3, (n + 1) % 3];
    out[0] = less[i] / d;
    out[i + 1] = d / 4;
    out[j + 1] = more[k] / d;
    out[k + 1] = more[j] / d;
    return out;
  }

  /* Principal moments of a symmetric matrix, and the quaternion of their axes, by Jacobi's turns. */
  function principal(J) {
    const a = J.map((row) => Array.from(row));
    let axes = [1, 0, 0, 0];
    for (let sweep = 0; sweep < 30; sweep += 1) {
      [[0, 1], [1, 2], [0, 2]].forEach(([i, j]) => {
        if (Math.abs(a[i][j]) < 1e-15 * (Math.abs(a[i][i]) + Math.abs(a[j][j]))) return;
        const angle = 0.5 * Math.atan2(2 * a[i][j], a[i][i] - a[j][j]);
        const [c, s] = [Math.cos(angle), Math.sin(angle)];
        for (let m = 0; m < 3; m += 1) [a[m][i], a[m][j]] = [c * a[m][i] + s * a[m][j], c * a[m][j] - s * a[m][i]];
        for (let m = 0; m < 3; m += 1) [a[i][m], a[j][m]] = [c * a[i][m] + s * a[j][m], c * a[j][m] - s * a[i][m]];
        const sign = j === (i + 1) % 3 ? 1 : -1;
        const turn = [Math.cos(angle / 2), 0, 0, 0];
        turn[4 - i - j] = sign * Math.sin(angle / 2);
        axes = product(axes, turn);
      });
    }
    return {moments: [a[0][0], a[1][1], a[2][2]], axes};
  }

  /* In words what is wrong with an inertia matrix, by the triangle inequality of its principal moments. */
  function inertiaFault(J, names) {
    const slack = 1e-12;
    const diagonal = !J[0][1] && !J[0][2] && !J[1][2];
    const {moments} = diagonal ? {moments: [J[0][0], J[1][1], J[2][2]]} : principal(J);
    const of = (k) => (diagonal ? names[k][k] : "principal moment " + (k + 1));
    const shown = (x) => Number(x.toPrecision(4)).toString();
    for (let k = 0; k < 3; k += 1) {
      const [i, j] = [(k + 1) % 3, (k + 2) % 3];
      if (!(moments[k] > 0)) return "no body has the " + of(k) + " = " + shown(moments[k]);
      if (moments[k] > (moments[i] + moments[j]) * (1 + slack))
        return "no body has these moments of inertia: " + of(k) + " = " + shown(moments[k]) + " exceeds " + of(i) +
          " + " + of(j) + " = " + shown(moments[i] + moments[j]) + " (triangle inequality)";
    }
    return "";
  }

  return {product, ofMatrix, principal, inertiaFault};
})();
