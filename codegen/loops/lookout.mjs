// What bounds a step beside the estimate of its error: how far arguments move of operations that have a
// scale of their own. ahead, watched, verdict and WATCH of the module say which; seen: the values of
// watched at stages in order of time that stand apart, place: where, nearness: one over the distances.
function lookout(system, rtol, seen) {
  const { ahead, verdict, SIZES, WATCH = {} } = system;
  const { columns = 0, guards = 0, pieces = 0, always = [], toZero = [] } = WATCH;
  const place = [@PLACES@];
  const nearness = [@NEARNESS@];
  const first = SIZES.rates, guarded = always.length, last = seen.length - 1, depth = @DEPTH@ - Math.log(rtol);
  const span = new Float64Array(3 * columns + 1); // of each value: now, the least, the largest
  const slope = new Float64Array(columns * (seen.length + 1)), allowed = new Float64Array(guards + pieces);
  const times = new Float64Array(4), clear = new Float64Array(2), none = [];
  let wanted = 0, passed = -Infinity, passing = false, sure = true, crowded = 0, tries = 0;
  const s = { h: 0, start, lookAhead, isCut, foresee };
  span[3 * columns] = times[3] = depth;
  return s;

  function start() {
    wanted = crowded = tries = 0;
    passed = -Infinity;
    passing = false;
  }

  // Of two numbers that which is one, if the other is none.
  function least(a, b) {
    return a < b || b !== b ? a : b;
  }

  function most(a, b) {
    return a > b || b !== b ? a : b;
  }

  // Whether between t and t + along every operation of time alone keeps its character, clear[0], and every
  // condition and table stays on its piece, clear[1]; by intervals.
  function isClear(t, along, p, u) {
    times[0] = times[1] = t;
    times[2] = t + along;
    ahead(0, times, p, u, clear);
    return clear[0] !== 0 && clear[1] !== 0;
  }

  // Make the proposed step, now h, so short that it passes over nothing: 2 where it ends at a change of
  // piece, to within rounding, or is as short as can be and passes it; 1 where it is shorter otherwise.
  function lookAhead(t, proposed, p, u) {
    const smallest = 10 * spacing(t);
    let low = 0, high = proposed;
    s.h = proposed;
    if (high <= smallest || isClear(t, high, p, u)) return 0;
    let jumps = clear[1] === 0;
    for (let turn = 0; turn < 1100 && high > smallest; ++turn) {
      if (high - low <= (jumps ? 2 * spacing(t + high) : 0.1 * high)) break;
      const middle = 0.5 * (low + high);
      if (isClear(t, middle, p, u)) low = middle;
      else {
        high = middle;
        jumps = clear[1] === 0;
      }
    }
    if (jumps) low -= 2 * spacing(t + high);
    s.h = Math.max(low, smallest);
    return jumps ? 2 : 1;
  }

  // Whether a movement of a guarded value is always allowed. Of some the way towards zero alone counts.
  function isAllowed(c, here, down, up) {
    const nearer = here < 0 ? up : down, further = here < 0 ? down : up;
    const move = toZero[c] || nearer > further ? nearer : further;
    return move <= always[c][0] * Math.abs(here) || move <= always[c][1];
  }

  // How fast a value moves between stages, over the length of the step; none before and behind them.
  function paces(c) {
    const i = first + c, at = c * (seen.length + 1);
    for (let m = 0; m < last; ++m) slope[at + m + 1] = Math.abs(seen[m + 1][i] - seen[m][i]) * nearness[m];
  }

  // Half the second derivative at a stage where a value turns round, as the parabola through that and the
  // stages beside it has; 0 elsewhere.
  function bend(c, m) {
    if (m < 1 || m > last - 1) return 0;
    const i = first + c, v = seen[m][i];
    const left = (v - seen[m - 1][i]) * nearness[m - 1], right = (seen[m + 1][i] - v) * nearness[m];
    return left * right < 0 ? (right - left) / (place[m + 1] - place[m - 1]) : 0;
  }

  // Widen the span of a value to its bounds between two stages: it moves no faster than beside them, and
  // goes no further beyond a stage where it turns round than a parabola does within half the distance.
  function widen(c, gap) {
    const i = first + c, at = c * (seen.length + 1) + gap, half = 0.5 * (place[gap + 1] - place[gap]);
    let steepest = slope[at + 1], low = span[3 * c + 1], high = span[3 * c + 2];
    if (slope[at] > steepest) steepest = slope[at];
    if (slope[at + 2] > steepest) steepest = slope[at + 2];
    const reach = half * steepest, middle = 0.5 * (seen[gap][i] + seen[gap + 1][i]);
    if (middle - reach < low) low = middle - reach;
    if (middle + reach > high) high = middle + reach;
    for (let m = gap; m <= gap + 1; ++m) {
      const summit = seen[m][i] - half * half * bend(c, m);
      if (summit < low) low = summit;
      if (summit > high) high = summit;
    }
    span[3 * c + 1] = low;
    span[3 * c + 2] = high;
  }

  // The span of a value at the stages alone.
  function extremes(c) {
    const i = first + c;
    let low = seen[0][i], high = low;
    for (let m = 1; m <= last; ++m) {
      const v = seen[m][i];
      if (v < low) low = v;
      if (v > high) high = v;
    }
    span[3 * c] = seen[0][i];
    span[3 * c + 1] = low;
    span[3 * c + 2] = high;
  }

  // The span of a value over the step. A divisor, or what goes into a logarithm, that has one sign at all
  // stages keeps it.
  function spanOf(c) {
    paces(c);
    extremes(c);
    const low = span[3 * c + 1], high = span[3 * c + 2];
    for (let gap = 0; gap < last; ++gap) widen(c, gap);
    if (c >= guarded || !toZero[c]) return;
    if (low > 0 && span[3 * c + 1] < 1e-3 * low) span[3 * c + 1] = 1e-3 * low;
    if (high < 0 && span[3 * c + 2] > 1e-3 * high) span[3 * c + 2] = 1e-3 * high;
  }

  // Whether every guarded value moves no more than is always allowed. Most do by their stages alone: bounds
  // are beyond these by @BEYOND@ times what lies between the extremes at most.
  function isQuiet() {
    for (let c = 0; c < guarded; ++c) {
      extremes(c);
      const here = span[3 * c], down = here - span[3 * c + 1], up = span[3 * c + 2] - here;
      const beyond = @BEYOND@ * (span[3 * c + 2] - span[3 * c + 1]);
      if (isAllowed(c, here, down + beyond, up + beyond)) continue;
      spanOf(c);
      if (!isAllowed(c, here, here - span[3 * c + 1], span[3 * c + 2] - here)) return false;
    }
    return true;
  }

  // The least share of the step that an operation allows, and, in allowed, whether pieces stay.
  function judge() {
    let share = 1;
    verdict(0, span, none, none, allowed);
    for (let g = 0; g < guards; ++g) if (allowed[g] < share) share = allowed[g];
    return share;
  }

  function stays() {
    for (let k = guards; k < guards + pieces; ++k) if (allowed[k] === 0) return false;
    return true;
  }

  // Where in the step a piece first changes, as values go straight between stages; sure is false where it
  // may change, but has not at either stage. 2 where none does.
  function firstPassage() {
    sure = true;
    for (let c = 0; c < columns; ++c) paces(c);
    for (let gap = 0; gap < last; ++gap) {
      straight(gap, 1);
      for (let c = 0; c < columns; ++c) widen(c, gap);
      judge();
      if (stays()) continue;
      const length = place[gap + 1] - place[gap];
      straight(gap, 1);
      judge();
      sure = !stays();
      if (!sure) return place[gap] + 0.25 * length;
      let low = 0, high = 1;
      for (let turn = 1; turn < 54; ++turn) {
        const middle = 0.5 * (low + high);
        straight(gap, middle);
        judge();
        if (stays()) low = middle;
        else high = middle;
      }
      return place[gap] + high * length;
    }
    return 2;
  }

  // Spans from a stage to a part of the way to the next.
  function straight(gap, part) {
    for (let c = 0; c < columns; ++c) {
      const v = seen[gap][first + c], next = seen[gap + 1][first + c];
      const there = part === 1 ? next : v + part * (next - v);
      span[3 * c] = v;
      span[3 * c + 1] = least(v, there);
      span[3 * c + 2] = most(v, there);
    }
  }

  // Whether a step must be shorter since a piece changes in it. One as short as `near` passes the change.
  function passes(t, h) {
    const longest = Math.max(wanted, h), near = Math.max(32 * spacing(t), 1e-3 * rtol * longest);
    if (crowded > @CROWDED@ && h <= 64 * near) return false;
    const at = firstPassage();
    tries = at > 1 ? 0 : tries + 1;
    if (at > 1) return false;
    if (h <= 1.001 * near || tries > 100) {
      crowded = Math.abs(t - passed) <= 8 * near ? crowded + 1 : 0;
      passed = t;
      passing = true;
      return false;
    }
    const target = at * h;
    wanted = longest;
    if (sure) s.h = target > 1.75 * near ? target - 0.75 * near : near;
    else s.h = Math.max(target, near);
    return true;
  }

  // Whether a step is not taken since what is watched moves too far in it, and a shorter one, h, is proposed.
  function isCut(t, h) {
    passing = false;
    if (!pieces && isQuiet()) return false;
    for (let c = 0; c < columns; ++c) spanOf(c);
    const share = judge();
    if (share < 1 && h > 64 * spacing(t)) {
      s.h = h * Math.max(0.1, 0.9 * share);
      return true;
    }
    if (!stays()) return passes(t, h);
    tries = 0;
    return false;
  }

  // What follows a step of length h, if `next` is proposed: as much as was to be before a change of piece,
  // and no more than what is watched allows if it moves on as it did last.
  function foresee(h, next) {
    if (passing) {
      next = Math.max(next, wanted);
      wanted = 0;
    }
    const part = next / (h * (place[last] - place[last - 1]));
    let quiet = true;
    for (let c = 0; c < columns; ++c) {
      const here = seen[last][first + c], move = part * (here - seen[last - 1][first + c]);
      const there = c < guarded ? here + move : here;
      span[3 * c] = here;
      span[3 * c + 1] = least(here, there);
      span[3 * c + 2] = most(here, there);
      quiet = quiet && (c >= guarded || isAllowed(c, here, -move, move));
    }
    if (quiet) return next;
    const share = judge();
    return share < 0.5 ? next * Math.max(0.05, 1.8 * share) : next; // a guess: what moves less may slow down
  }
}
