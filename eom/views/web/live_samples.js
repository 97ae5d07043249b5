/* Laws that are sampled: inputs are held between samples, at which every step ends, as samples.c has it.

   createSamples(system, laws) takes, of each law, its period and delay (s), the inputs that it sets and the states
   of the control, which change at the sample itself. Sample k is at k period; first all laws that are due are
   evaluated, over what was there before, then inputs change, and what waited for its delay takes effect. */
"use strict";

const createSamples = (system, laws) => {
  const SAME = 4;
  const values = new Float64Array(system.SIZES.samples || 0);
  let from = 0;
  const rows = laws.map(({period, delay, inputs, states}) => {
    const places = [...inputs, ...states].map((name) => system.INPUTS.indexOf(name)), first = from;
    const whole = Math.floor(delay / period);
    from += places.length;
    return {period, delay, places, count: inputs.length, first, whole, rest: delay - whole * period, taken: 0, applied: 0, waiting: []};
  });
  const due = (row) => row.taken * row.period;
  const effect = (row) => (row.applied < row.taken && row.delay ? (row.applied + row.whole) * row.period + row.rest : Infinity);
  return {start, next, change};

  function start() {
    rows.forEach((row) => Object.assign(row, {taken: 0, applied: 0, waiting: []}));
  }

  /* The next time at which a sample is due or takes effect. */
  function next() {
    return Math.min(Infinity, ...rows.map((row) => Math.min(due(row), effect(row))));
  }

  function change(t, x, p, u) {
    const until = t + SAME * Number.EPSILON * Math.abs(t);
    const now = rows.filter((row) => due(row) <= until);
    if (now.length) system.samples(t, x, p, u, values);
    now.forEach((row) => {
      if (row.delay) row.waiting.push(Array.from(values.subarray(row.first, row.first + row.count)));
      row.taken += 1;
    });
    rows.forEach((row) => {
      if (now.includes(row)) for (let i = row.delay ? row.count : 0; i < row.places.length; i += 1) u[row.places[i]] = values[row.first + i];
      while (effect(row) <= until) {
        row.waiting.shift().forEach((value, i) => { u[row.places[i]] = value; });
        row.applied += 1;
      }
    });
  }
};
