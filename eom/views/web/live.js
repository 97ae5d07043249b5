/* The live page: what is drawn, what can be changed, what is shown. The motion itself is createMotion's. */
"use strict";

(() => {
  const data = JSON.parse(document.getElementById("scene").textContent);
  const motion = createMotion(data, EOM_SYSTEMS, EOM_METHOD);
  const STEPS_A_FRAME = 400, MOST_PARTS = 8;
  const LONGEST = 0.1;
  const byId = (id) => document.getElementById(id);
  const all = (selector) => Array.from(document.querySelectorAll(selector));
  const still = matchMedia("(prefers-reduced-motion: reduce)");
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const state = {playing: !still.matches, speed: data.speed, last: null, shown: 0, frames: 0, late: false};
  const single = data.kind !== "tree";
  const shown = (x, digits = 5) => (Number.isFinite(x) ? Number(x.toPrecision(digits)).toString() : "–");
  const theme = () => (dark.matches ? "dark" : "light");

  // -- the bodies -----------------------------------------------------------------------------------

  const TRACKS = ["blue", "red", "green", "purple"];
  const COLOURS = ["sky", "orange", "green", "yellow", "purple", "blue", "red", "grey"];
  const C = new Float64Array(9), omega = new Float64Array(3), H = new Float64Array(3), torque = new Float64Array(3);
  const turn = [1, 0, 0, 0], origin = [0, 0, 0], tip = [0, 0, 0], inBody = [0, 0, 0];
  const size = {omega: 1, H: 1, torque: 1};
  let viewer = null, radius = 1, traced = 0, following = true;

  const length = (v) => Math.hypot(v[0], v[1], v[2]);

  /* A box, or a cylinder where two moments are equal, that has the principal moments of a mass of one. */
  function solid(moments) {
    const [a, b, c] = moments;
    const even = (x, y) => Math.abs(x - y) < 1e-9 * (x + y);
    const alone = even(a, b) ? 2 : even(b, c) ? 0 : even(a, c) ? 1 : -1;
    if (alone < 0) {
      const edge = (i, j, k) => Math.sqrt(Math.max(6 * (moments[i] + moments[j] - moments[k]), 0));
      return {kind: "box", size: [edge(1, 2, 0), edge(2, 0, 1), edge(0, 1, 2)]};
    }
    const along = moments[alone], across = moments[(alone + 1) % 3];
    const turns = [[Math.SQRT1_2, 0, Math.SQRT1_2, 0], [Math.SQRT1_2, -Math.SQRT1_2, 0, 0], [1, 0, 0, 0]];
    return {kind: "cylinder", radius: Math.sqrt(2 * along), length: Math.sqrt(Math.max(12 * (across - along / 2), 0)),
            quaternion: turns[alone]};
  }

  /* A shape as large as asked, its edges no thinner than can be seen. */
  function scaled(shape, wanted) {
    const s = Object.assign({}, shape);
    if (s.kind === "box") {
      const factor = (2 * wanted) / length(s.size);
      s.size = s.size.map((x) => Math.max(x * factor, 0.03 * wanted));
    } else {
      const factor = wanted / Math.hypot(s.radius, s.length / 2);
      s.radius = Math.max(s.radius * factor, 0.02 * wanted);
      s.length = Math.max(s.length * factor, 0.02 * wanted);
    }
    return s;
  }

  const turned = (shape, axes) => Object.assign(shape, {quaternion: EOM_ROTATIONS.product(axes, shape.quaternion || [1, 0, 0, 0])});

  /* The turn that takes axis 3 to a direction. */
  function towards(v) {
    const n = length(v);
    const [x, y, z] = n ? v.map((c) => c / n) : [0, 0, 1];
    if (z < -0.999999) return [0, 1, 0, 0];
    const q = [1 + z, -y, x, 0];
    const m = Math.hypot(...q);
    return q.map((c) => c / m);
  }

  function singleShapes() {
    const J = motion.inertia();
    const r = data.centre.map((name) => (name ? motion.value(name) : 0));
    if (data.kind === "spinner") {
      const along = [Math.SQRT1_2, -Math.SQRT1_2, 0, 0], away = Math.sign(r[1] || 0);
      if (!away) return [{kind: "wheel", radius: 0.75, axle: 0.95, quaternion: along}];
      return [{kind: "wheel", radius: 0.62, axle: 0.4, quaternion: along, position: [0, 0.4 * away, 0]}];
    }
    if (data.centre.length) {
      return [{kind: "cone", radius: 0.3, height: 0.62, quaternion: towards(r), marked: true},
              {kind: "sphere", radius: 0.035, plain: true, colour: "grey"}];
    }
    const {moments, axes} = EOM_ROTATIONS.principal(J);
    return [turned(scaled(solid(moments), 0.72), axes)];
  }

  /* What holds the end of the axle of a wheel. */
  function stand() {
    if (data.kind !== "spinner" || !data.centre.length) return [];
    return [{kind: "rod", length: 0.75, radius: 0.018, position: [0, 0, -0.375]},
            {kind: "cylinder", radius: 0.2, length: 0.03, position: [0, 0, -0.75]},
            {kind: "sphere", radius: 0.035}].map((s) => Object.assign(s, {colour: "grey", plain: true}));
  }

  /* Of a tree: what is drawn of body k is at 12 k; masses and the rest follow in order. */
  const shapesFrom = (() => {
    const starts = [];
    let at = 12 * data.bodies.length;
    data.joints.forEach((count) => { starts.push(at); at += 10 + 3 * count; });
    return starts;
  })();

  function treeShapes(k) {
    const v = motion.view, s = shapesFrom[k];
    const centre = [v[s + 1], v[s + 2], v[s + 3]];
    const [xx, xy, xz, yy, yz, zz] = v.subarray(s + 4, s + 10);
    const shapes = [], rolls = data.fittings.find((f) => f.kind === "roll" && f.bodies[0] === k);
    if (rolls) shapes.push(rolling(rolls.at, (a) => inertiaAbout(k, a) / v[s]));
    else if (v[s] > 0) {
      const {moments, axes} = EOM_ROTATIONS.principal([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
      const point = {kind: "box", size: [0.2 * radius, 0.1 * radius, 0.1 * radius]};
      const found = Math.max(...moments) > 0 ? solid(moments.map((m) => m / v[s])) : point;
      const thin = 0.025 * radius;
      if (found.kind === "box") found.size = found.size.map((x) => Math.max(x, thin));
      else Object.assign(found, {radius: Math.max(found.radius, thin / 2), length: Math.max(found.length, thin)});
      shapes.push(Object.assign(turned(found, axes), {position: centre, opacity: hides(k, centre, moments) ? 0.35 : 1}));
    }
    const ends = Array.from({length: data.joints[k]}, (_, n) => Array.from(v.subarray(s + 10 + 3 * n, s + 13 + 3 * n)));
    [centre, ...ends].forEach((end) => {
      if (length(end) > 0.03 * radius) shapes.push(
        {kind: "rod", length: length(end), radius: 0.008 * radius, colour: "grey", plain: true,
         position: end.map((x) => x / 2), quaternion: towards(end)});
    });
    shapes.push({kind: "sphere", radius: 0.018 * radius, colour: "grey", plain: true});
    return shapes;
  }

  /* The moment of inertia of a body about an axis through its centre of mass. */
  function inertiaAbout(k, [x, y, z]) {
    const [xx, xy, xz, yy, yz, zz] = motion.view.subarray(shapesFrom[k] + 4, shapesFrom[k] + 10);
    return xx * x * x + yy * y * y + zz * z * z + 2 * (xy * x * y + xz * x * z + yz * y * z);
  }

  /* What rolls, as it touches: a ball, an ellipsoid, and with a thin edge a disc, or a wheel with spokes where
     the mass is farther out than that of a disc. */
  function rolling(at, gyration) {
    const v = motion.view, r = v[at], half = v[at + 1], axis = Array.from(v.subarray(at + 5, at + 8));
    const placed = {position: Array.from(v.subarray(at + 2, at + 5)), quaternion: towards(axis)};
    if (!length(axis)) return Object.assign({kind: "sphere", radius: r}, placed);
    if (half) return Object.assign({kind: "ellipsoid", size: [r, r, half]}, placed);
    const hollow = gyration(axis.map((x) => x / length(axis))) > 0.5 * r * r * (1 + 1e-9);
    if (hollow) return Object.assign({kind: "wheel", radius: 0.97 * r, tube: 0.03 * r, axle: 0.15 * r}, placed);
    return Object.assign({kind: "cylinder", radius: r, length: 0.04 * r}, placed);
  }

  /* A place of a body in space, by its components in the body; of the ground as it is. */
  function placeOf(k, at, out = [0, 0, 0]) {
    const v = motion.view, s = 12 * k;
    for (let i = 0; i < 3; i += 1) {
      out[i] = k < 0 ? v[at + i] : v[s + i];
      for (let j = 0; k >= 0 && j < 3; j += 1) out[i] += v[at + j] * (v[s + 3 * (j + 1) + i] - v[s + i]);
    }
    return out;
  }

  const touching = (f) => f.kind === "roll";
  const onGround = (f) => f.bodies[0] < 0 && (f.kind === "ball" || f.kind === "rail");
  const point = [0, 0, 0], plain = (shape, colour) => Object.assign(shape, {plain: true, colour});

  /* What does not move, or moves with a body: supports, pins of loops, knife edges, planes that are not level. */
  function fittingShapes(k) {
    const v = motion.view, here = data.fittings.filter((f) => f.bodies[0] === k);
    const at = (f, from = 0) => Array.from(v.subarray(f.at + from, f.at + from + 3));
    const shapes = {
      pin: (f) => plain({kind: "sphere", radius: 0.026 * radius, position: at(f)}, "orange"),
      edge: (f) => plain({kind: "box", size: [0.12 * radius, 0.12 * radius, 0.006 * radius], position: at(f), quaternion: towards(at(f, 3))}, "orange"),
      ball: (f) => plain({kind: "sphere", radius: 0.035 * radius, position: at(f)}, "grey"),
      rail: (f) => plain({kind: "rod", length: 3 * radius, radius: 0.008 * radius, position: at(f), quaternion: towards(at(f, 3))}, "grey"),
    };
    return here.filter((f) => f.kind in shapes).map((f) => shapes[f.kind](f));
  }

  /* The height of the plane that bodies roll on, where it is level, and whether all are this one plane. */
  function floor() {
    const v = motion.view, up = data.up, heights = data.fittings.filter(touching).map((f) => {
      const n = v.subarray(f.at + 8, f.at + 11), o = v.subarray(f.at + 11, f.at + 14);
      const level = Math.abs(n[0] * up[0] + n[1] * up[1] + n[2] * up[2]) > (1 - 1e-12) * length(n);
      return level ? o[0] * up[0] + o[1] * up[1] + o[2] * up[2] : NaN;
    });
    return heights.length && heights.every((h) => Math.abs(h - heights[0]) < 1e-9) ? heights[0] : null;
  }

  function dressGround() {
    fittingShapes(-1).forEach((shape, n) => viewer.surface("support " + n, shape, {colour: "grey"}));
    const height = floor();
    if (height !== null) viewer.ground(height);
    else data.fittings.filter(touching).forEach((f, n) => {
      const normal = Array.from(motion.view.subarray(f.at + 8, f.at + 11)), thin = 0.004 * radius, q = towards(normal);
      viewer.surface("plane " + n, {kind: "box", size: [8 * radius, 8 * radius, thin], opacity: 0.3, plain: true}, {colour: "grey"});
      viewer.place("plane " + n, Array.from(motion.view.subarray(f.at + 11, f.at + 14), (x, i) => x - (0.6 * thin * normal[i]) / length(normal)), q);
    });
  }

  function drawFittings() {
    data.fittings.forEach((f, n) => {
      if (f.kind === "line") viewer.line("line " + n, placeOf(f.bodies[0], f.at), placeOf(f.bodies[1], f.at + 3), {colour: "grey", width: 2});
      if (!touching(f)) return;
      motion.contact(f, point);
      viewer.place("contact " + n, point, [1, 0, 0, 0]);
      viewer.trailAdd("path " + n, point, {colour: TRACKS[n % TRACKS.length], most: 4000, width: 2.5});
    });
  }

  /* Whether the centre of mass of another body lies in this one, about where its mass is. */
  function hides(k, centre, moments) {
    const v = motion.view, s = 12 * k;
    const size = Math.sqrt((0.75 * Math.max(...moments)) / v[shapesFrom[k]]);
    return data.bodies.some((_, n) => {
      if (n === k || !(v[shapesFrom[n]] > 0)) return false;
      const other = shapesFrom[n], at = [0, 0, 0];
      for (let i = 0; i < 3; i += 1) {
        at[i] = v[12 * n + i] - v[s + i];
        for (let j = 0; j < 3; j += 1) {
          at[i] += v[other + 1 + j] * (v[12 * n + 3 * (j + 1) + i] - v[12 * n + i]);
          at[i] -= centre[j] * (v[s + 3 * (j + 1) + i] - v[s + i]);
        }
      }
      return length(at) < size && v[shapesFrom[n]] < v[shapesFrom[k]];
    });
  }

  /* The ball that holds a tree at its start, with room to move. */
  function reach() {
    const v = motion.view;
    let most = 0.1;
    data.bodies.forEach((_, k) => {
      const s = shapesFrom[k];
      const own = Math.max(length([v[s + 1], v[s + 2], v[s + 3]]), ...data.fittings.filter((f) => touching(f) && f.bodies[0] === k).map((f) => Math.max(v[f.at], v[f.at + 1])));
      const edge = v[s] > 0 ? Math.sqrt((1.5 * (v[s + 4] + v[s + 7] + v[s + 9])) / v[s]) : 0;
      most = Math.max(most, length([v[12 * k], v[12 * k + 1], v[12 * k + 2]]) + own + edge);
    });
    return most;
  }

  function makeViewer() {
    radius = single ? 1 : reach();
    viewer = createViewer(byId("body"), {
      radius: single ? 1.05 : radius, up: data.up, view: single ? [35, 18] : [-62, 16], ground: single ? null : floor(), theme: theme(),
      names: {space: createViewer.triad(data.kind === "spinner" ? "i" : "a")},
      bodies: data.bodies.map((name, k) => ({name, colour: COLOURS[k % COLOURS.length], frame: single ? 0.98 : 0.16 * radius, shapes: []})),
      stand: stand(),
    });
    dress();
  }

  function dress() {
    data.bodies.forEach((_, k) => viewer.dress(k, single ? singleShapes() : [...treeShapes(k), ...fittingShapes(k)]));
    if (single) return;
    dressGround();
    data.fittings.forEach((f, n) => {
      if (!touching(f)) return;
      viewer.surface("contact " + n, {kind: "sphere", radius: 0.02 * radius, plain: true}, {colour: TRACKS[n % TRACKS.length]});
      viewer.trailClear("path " + n);
    });
  }

  const scaledTo = (v, whole, room) => v.map((x) => (x * room) / whole);

  function drawBody() {
    if (!single) {
      const v = motion.view;
      data.bodies.forEach((_, k) => {
        const s = 12 * k;
        for (let i = 0; i < 3; i += 1) {
          origin[i] = v[s + i];
          for (let j = 0; j < 3; j += 1) C[3 * j + i] = v[s + 3 * (j + 1) + i] - v[s + i];
        }
        viewer.pose(k, origin, EOM_ROTATIONS.ofMatrix(C, turn));
        if (following && k === data.follow) viewer.follow(origin);
        if (k === data.bodies.length - 1) {
          const c = shapesFrom[k];
          for (let i = 0; i < 3; i += 1)
            tip[i] = origin[i] + C[i] * motion.view[c + 1] + C[3 + i] * motion.view[c + 2] + C[6 + i] * motion.view[c + 3];
        }
      });
      drawFittings();
      drawVectors();
      if (!data.fittings.some(touching)) trace(tip);
      return;
    }
    motion.at("C", C);
    viewer.pose(0, [0, 0, 0], EOM_ROTATIONS.ofMatrix(C, turn));
    Object.entries({omega, H, torque}).forEach(([name, v]) => {
      motion.at(name, v);
      size[name] = Math.max(size[name], length(v));
      const words = {omega: "ω", H: "H", torque: "τ"}[name];
      const colour = {omega: "red", H: "blue", torque: "green"}[name];
      const room = {omega: 0.95, H: 0.8, torque: 0.6}[name];
      const vector = size[name] > 0 ? scaledTo(Array.from(v), size[name], room) : null;
      viewer.arrow(name, [0, 0, 0], vector, {colour, text: words});
    });
    const axis = data.kind === "spinner" ? 1 : 2;
    for (let i = 0; i < 3; i += 1) tip[i] = 0.99 * C[3 * axis + i];
    trace(tip);
  }

  // -- vectors of a tree: components and places are the last six outputs of each ---------------------

  const most = {}, ROOM = {"rad/s": 0.6, "N m s": 0.55, "N m": 0.5, N: 0.45}, SHORTEST = 0.02;
  let vectorCells = [];

  function vectorAt(n) {
    const from = data.arrows + 6 * n;
    return [Array.from(motion.view.subarray(from, from + 3)), Array.from(motion.view.subarray(from + 3, from + 6))];
  }

  function setVectors() {
    if (single) return;
    const body = byId("vectors"), {vectors} = motion.variant;
    byId("vectors-part").hidden = !vectors.length;
    body.replaceChildren();
    vectorCells = vectors.map(({text, words: meaning, colour, unit}) => {
      const row = body.insertRow(), head = document.createElement("th"), mark = document.createElement("span");
      head.scope = "row";
      mark.className = "dot";
      mark.style.background = createViewer.colours[colour];
      head.append(mark);
      words.html(text, head);
      head.title = meaning;
      row.append(head);
      const cell = row.insertCell();
      row.insertCell().textContent = unit;
      return cell;
    });
    viewer.arrows().forEach((name) => viewer.arrow(name, [0, 0, 0], null));
  }

  function drawVectors() {
    const {vectors} = motion.variant, found = vectors.map((_, n) => vectorAt(n));
    vectors.forEach(({unit}, n) => { most[unit] = Math.max(most[unit] || 0, length(found[n][0])); });
    vectors.forEach(({unit, layer, colour, text}, n) => {
      const [vector, place] = found[n];
      const long = length(vector) * ROOM[unit] > SHORTEST * most[unit]; // others would be dots with names
      const shownVector = long ? scaledTo(vector, most[unit], ROOM[unit] * radius) : null;
      viewer.arrow(words.text(text) + " " + layer + " " + n, place, shownVector, {colour, text, layer});
    });
  }

  function trace(point) {
    viewer.trailAdd("trail", point, {colour: "orange", most: 2500, width: 2});
  }

  // -- Poinsot's construction -------------------------------------------------------------------------

  let poinsot = null;
  const figure = {scale: 1, turn: [1, 0, 0, 0]};

  function makePoinsot() {
    if (!single) return;
    poinsot = createViewer(byId("poinsot"), {
      radius: 1.2, view: [40, 24], centre: [0, 0, -0.1], ground: null, theme: theme(), names: {space: ["", "", ""]},
      bodies: [{name: "energy ellipsoid", colour: "sky", frame: 0, shapes: []}],
    });
    poinsot.show("space frame", false);
  }

  /* The ellipsoid omega . J omega = 2 T in the body, the plane omega . H = 2 T in space. The figure is
     turned so that H points down, and scaled so that the longest semi-axis is one. */
  function setPoinsot() {
    const seen = single && motion.variant.free && !motion.message;
    byId("poinsot-figure").hidden = !seen;
    if (!seen) return;
    const {moments, axes} = EOM_ROTATIONS.principal(motion.inertia());
    motion.at("omega", omega);
    motion.at("H", H);
    const twice = omega[0] * H[0] + omega[1] * H[1] + omega[2] * H[2];
    figure.still = !(twice > 0);
    if (figure.still) return;
    const semi = moments.map((m) => Math.sqrt(twice / m));
    figure.scale = 1 / Math.max(...semi);
    figure.distance = (figure.scale * twice) / length(H);
    const [w, x, y, z] = towards(H.map((h) => -h));
    figure.turn = [w, -x, -y, -z];
    poinsot.dress(0, [{kind: "ellipsoid", size: semi.map((s) => s * figure.scale), opacity: 0.45, quaternion: axes}]);
    poinsot.surface("plane", {kind: "box", size: [2.7, 2.7, 0.004], opacity: 0.35, plain: true}, {colour: "grey"});
    poinsot.place("plane", [0, 0, -figure.distance], [1, 0, 0, 0]);
    poinsot.trailClear("polhode");
    poinsot.trailClear("herpolhode");
    poinsot.resize();
  }

  const turnedBy = (q, v) => {
    const p = EOM_ROTATIONS.product(EOM_ROTATIONS.product(q, [0, v[0], v[1], v[2]]), [q[0], -q[1], -q[2], -q[3]]);
    return [p[1], p[2], p[3]];
  };

  function drawPoinsot() {
    if (!single || byId("poinsot-figure").hidden || figure.still) return;
    poinsot.pose(0, [0, 0, 0], EOM_ROTATIONS.product(figure.turn, turn));
    motion.omega(inBody);
    const touch = turnedBy(figure.turn, Array.from(omega, (x) => x * figure.scale));
    poinsot.trailAdd("polhode", inBody.map((x) => 1.004 * x * figure.scale), {colour: "red", body: 0, most: 6000, width: 3});
    poinsot.trailAdd("herpolhode", [touch[0], touch[1], -figure.distance + 0.006], {colour: "blue", most: 6000, width: 2.5});
    poinsot.arrow("omega", [0, 0, 0], touch, {colour: "red", text: "ω"});
    poinsot.arrow("H", [0, 0, 0], [0, 0, -figure.distance], {colour: "blue", text: "H"});
  }

  // -- invariants --------------------------------------------------------------------------------------

  const INKS = ["--blue", "--red", "--green", "--purple", "--orange", "--ink"];
  const DASHES = [[], [6, 3], [2, 2], [8, 3, 2, 3], [1, 3], [12, 4], [12, 3, 3, 3, 3, 3]];
  const MOST = 1200, LOWEST = -17, HIGHEST = 0;
  const history = {t: [], drift: []};
  let cells = [], constants = [], leftCells = new Map();

  function drifts() {
    return constants.map((k) => Math.abs(motion.invariants[k] - motion.first[k]) / motion.scale[k]);
  }

  /* What constraints keep at zero, in a table of its own. */
  function setConstraints() {
    const body = byId("constraints"), held = motion.variant.held;
    body.replaceChildren();
    leftCells = new Map(held.map(({name, words}) => {
      const row = body.insertRow(), head = document.createElement("th");
      head.scope = "row";
      head.textContent = words;
      row.append(head);
      return [name, row.insertCell()];
    }));
    byId("constraints-part").hidden = !held.length;
  }

  function setInvariants() {
    const body = byId("invariants");
    body.replaceChildren();
    history.t.length = 0;
    const held = new Set(motion.variant.held.map(({name}) => name)), names = motion.names.INVARIANTS;
    constants = names.map((_, k) => k).filter((k) => !held.has(names[k]));
    history.drift = constants.map(() => []);
    cells = constants.map((number, k) => {
      const name = names[number];
      const row = body.insertRow();
      const head = document.createElement("th");
      head.scope = "row";
      head.title = data.meanings[name] || name;
      const words = document.createElement("span");
      words.className = "unseen";
      words.textContent = name + ": " + head.title;
      const swatch = document.createElementNS("http://www.w3.org/2000/svg", "svg");
      swatch.setAttribute("class", "swatch");
      swatch.setAttribute("viewBox", "0 0 24 6");
      swatch.setAttribute("aria-hidden", "true");
      const line = document.createElementNS("http://www.w3.org/2000/svg", "line");
      Object.entries({x1: 0, x2: 24, y1: 3, y2: 3, "stroke-width": 2.5, "stroke-dasharray": DASHES[k % DASHES.length].join(" ")})
        .forEach(([n, v]) => line.setAttribute(n, v));
      line.style.stroke = "var(" + INKS[k % INKS.length] + ")";
      swatch.append(line);
      head.append(swatch, " ", symbolOf(name), words);
      row.append(head);
      return [row.insertCell(), row.insertCell()];
    });
    byId("no-invariants").hidden = cells.length > 0;
    byId("invariants-table").hidden = byId("drift-figure").hidden = cells.length === 0;
  }

  function symbolOf(name) {
    const span = document.createElement("span");
    span.setAttribute("aria-hidden", "true");
    span.append(byId("symbol-" + name).content.cloneNode(true));
    return span;
  }

  function remember() {
    const last = history.t[history.t.length - 1];
    if (last !== undefined && motion.time <= last) return;
    history.t.push(motion.time);
    drifts().forEach((d, k) => history.drift[k].push(d));
    if (history.t.length > MOST) {
      const thinned = (list) => list.filter((_, k) => k % 2 === 0);
      history.t = thinned(history.t);
      history.drift = history.drift.map(thinned);
    }
  }

  function plot() {
    const canvas = byId("drift");
    if (byId("drift-figure").hidden) return;
    const pen = canvas.getContext("2d");
    const ratio = window.devicePixelRatio || 1;
    const [wide, high] = [canvas.clientWidth, canvas.clientHeight];
    canvas.width = wide * ratio;
    canvas.height = high * ratio;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    const style = getComputedStyle(document.documentElement);
    const ink = (name) => style.getPropertyValue(name).trim();
    const [left, right, top, bottom] = [46, 10, 8, 22];
    const t0 = history.t[0] || 0, t1 = Math.max(history.t[history.t.length - 1] || 0, t0 + 1e-9);
    const x = (t) => left + ((wide - left - right) * (t - t0)) / (t1 - t0);
    const y = (d) => {
      const p = Math.min(HIGHEST, Math.max(LOWEST, Math.log10(d || 1e-20)));
      return top + ((high - top - bottom) * (HIGHEST - p)) / (HIGHEST - LOWEST);
    };
    pen.font = "12px system-ui, sans-serif";
    pen.fillStyle = ink("--soft");
    pen.strokeStyle = ink("--line");
    pen.lineWidth = 1;
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (let p = -16; p <= HIGHEST; p += 4) {
      pen.beginPath();
      pen.moveTo(left, y(10 ** p));
      pen.lineTo(wide - right, y(10 ** p));
      pen.stroke();
      pen.fillText(p === 0 ? "1" : "1e" + p, left - 6, y(10 ** p));
    }
    pen.textBaseline = "alphabetic";
    pen.fillText(shown(t1, 4) + " s", wide - right, high - 6);
    pen.textAlign = "left";
    pen.fillText("0", left, high - 6);
    pen.lineWidth = 1.75;
    history.drift.forEach((list, k) => {
      pen.strokeStyle = ink(INKS[k % INKS.length]);
      pen.setLineDash(DASHES[k % DASHES.length]);
      pen.beginPath();
      list.forEach((d, n) => (n ? pen.lineTo(x(history.t[n]), y(d)) : pen.moveTo(x(history.t[n]), y(d))));
      pen.stroke();
    });
    pen.setLineDash([]);
  }

  function tellNumbers() {
    const found = drifts();
    motion.left().forEach(({name, left}) => { leftCells.get(name).textContent = left === 0 ? "0" : Math.abs(left).toExponential(1); });
    cells.forEach(([now, drift], k) => {
      now.textContent = shown(motion.invariants[constants[k]]);
      drift.textContent = found[k] === 0 ? "0" : found[k].toExponential(1);
    });
    vectorCells.forEach((cell, n) => { cell.textContent = shown(length(vectorAt(n)[0]), 4); });
    byId("time").textContent = motion.time.toFixed(motion.time < 1000 ? 2 : 0) + " s";
    byId("work").textContent = motion.steps.toLocaleString("en") + " steps, " + motion.evaluations.toLocaleString("en") + " right-hand sides";
    byId("states").textContent = motion.names.STATES.map((n, k) => n + " = " + shown(motion.states[k], 6)).join("\n");
    const note = motion.stopped ? "The motion ends here, " + motion.stopped + "." : state.late ? "Slower than asked: a frame takes " + STEPS_A_FRAME + " steps at most." : "";
    if (byId("note").textContent !== note) byId("note").textContent = note;
    plot();
  }

  // -- what can be left out, equations --------------------------------------------------------------

  const key = () => motion.off.map((o) => (o ? "1" : "0")).join("");

  function fill(id, template) {
    byId(id).replaceChildren(template ? byId(template).content.cloneNode(true) : "");
  }

  function setEquations() {
    const chosen = data.equations[key()], whole = data.equations[data.none];
    fill("statements", chosen.statements[byId("notation") ? byId("notation").value : ""]);
    fill("components", chosen.components);
    byId("left-out").replaceChildren(...chosen.left_out.map((words) => {
      const item = document.createElement("li");
      item.textContent = words;
      return item;
    }));
    byId("nothing").hidden = chosen.left_out.length > 0;
    byId("operations").textContent = chosen.after.toLocaleString("en");
    byId("general").textContent = whole.general.toLocaleString("en");
    byId("generated").textContent = motion.variant.operations.toLocaleString("en");
    byId("bar").style.width = Math.max(2, (100 * chosen.after) / whole.general) + "%";
  }

  // -- changes -----------------------------------------------------------------------------------------

  /* Whether a number occurs in the equations as they are, or in the body's shape. */
  function occurs(name) {
    const {STATES, PARAMETERS, INPUTS} = motion.names;
    if (name.startsWith("attitude_")) return true;
    return [STATES, PARAMETERS, INPUTS, data.centre, ...data.inertia].some((names) => names.includes(name));
  }

  function restarted() {
    byId("fault").textContent = motion.message ? motion.message[0].toUpperCase() + motion.message.slice(1) + "." : "";
    all("[data-knob]").forEach((input) => {
      const name = input.dataset.knob, other = motion.variant.equal[name];
      const row = input.closest(".knob");
      input.disabled = Boolean(other) || !occurs(name);
      row.classList.toggle("same", input.disabled);
      if (document.activeElement !== input || other) input.value = shown(motion.value(other || name), 8);
    });
    if (motion.message) return;
    size.omega = size.H = size.torque = 0;
    Object.keys(most).forEach((unit) => { most[unit] = 0; });
    viewer.trailClear("trail");
    dress();
    setVectors();
    setPoinsot();
    setInvariants();
    setConstraints();
    remember();
    draw();
    tellNumbers();
  }

  function render() {
    viewer.render();
    if (poinsot && !byId("poinsot-figure").hidden) poinsot.render();
  }

  function draw() {
    drawBody();
    drawPoinsot();
    render();
  }

  /* Lines are drawn through more points than there are frames where the body turns fast. */
  function parts(seconds) {
    return single ? Math.min(MOST_PARTS, Math.max(1, Math.ceil((length(omega) * seconds) / 0.05))) : 2;
  }

  function move(seconds) {
    const span = Math.min(seconds, LONGEST) * state.speed, begin = motion.time, count = parts(span);
    state.late = false;
    for (let k = 1; k <= count && !state.late && !motion.stopped; k += 1) {
      state.late = !motion.advance(begin + (span * k) / count, STEPS_A_FRAME / count) && !motion.stopped;
      drawBody();
      drawPoinsot();
    }
    state.frames += 1;
    remember();
  }

  function frame(seconds) {
    move(seconds);
    render();
  }

  function tick(now) {
    if (state.playing && !motion.stopped && !motion.message) {
      if (state.last !== null) frame((now - state.last) / 1000);
      if (now - state.shown > 200) {
        state.shown = now;
        tellNumbers();
      }
    }
    state.last = now;
    requestAnimationFrame(tick);
  }

  function play(on) {
    state.playing = on;
    byId("play").textContent = on ? "Pause" : "Play";
    if (!on) tellNumbers();
  }

  function set(input) {
    const number = input.type === "range" ? Number(input.valueAsNumber.toPrecision(4)) : input.valueAsNumber;
    if (Number.isNaN(number)) return;
    motion.set(input.dataset.knob, number);
    restarted();
  }

  function connect() {
    all("[data-knob]").forEach((input) => input.addEventListener("input", () => set(input)));
    all("[data-switch]").forEach((input) => input.addEventListener("change", () => {
      motion.choose(Number(input.dataset.switch), input.checked);
      setEquations();
      restarted();
    }));
    byId("play").addEventListener("click", () => play(!state.playing));
    byId("reset").addEventListener("click", () => {
      motion.restart();
      restarted();
    });
    byId("original").addEventListener("click", () => {
      motion.original();
      all("[data-switch]").forEach((box) => { box.checked = motion.off[Number(box.dataset.switch)]; });
      setEquations();
      restarted();
    });
    byId("speed").addEventListener("change", (event) => { state.speed = data.speed * Number(event.target.value); });
    if (byId("notation")) byId("notation").addEventListener("change", setEquations);
    dark.addEventListener("change", () => {
      [viewer, poinsot].forEach((v) => v && v.theme(theme()));
      plot();
    });
    still.addEventListener("change", () => play(!still.matches));
    const show = (input) => {
      if (input.dataset.show === "camera") following = input.checked;
      else viewer.show(input.dataset.show, input.checked);
    };
    all("[data-show]").forEach((input) => input.addEventListener("change", () => show(input)));
    all("[data-show]").filter((input) => !input.checked).forEach(show);
  }

  makeViewer();
  makePoinsot();
  connect();
  setEquations();
  restarted();
  play(state.playing);
  globalThis.eomLive = {motion, data, state, play, move, frame, draw, tellNumbers, viewer, poinsot};
  requestAnimationFrame(tick);
})();
