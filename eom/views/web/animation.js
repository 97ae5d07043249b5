/* Plays the animation whose data stand in the page. */
"use strict";

(() => {
  const byId = (id) => document.getElementById(id);
  const data = JSON.parse(byId("data").textContent);
  const still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
  const darkness = window.matchMedia("(prefers-color-scheme: dark)");
  const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];
  const LONGEST_FRAME = 0.1, SHORTEST = 0.02;

  // -- data ---------------------------------------------------------------------------------------

  const floats = (text) => (text ? unpacked(text) : null);
  const meshes = data.meshes.map((m) => ({
    vertices: floats(m.vertices),
    faces: unpacked(m.faces, m.wide ? "u4" : "u2"),
    round: m.round,
    flat: m.flat,
  }));
  const shape = (s) => ({
    kind: "mesh", vertices: meshes[s.mesh].vertices, faces: meshes[s.mesh].faces, marked: meshes[s.mesh].round,
    flat: meshes[s.mesh].flat,
    colour: s.colour, opacity: s.opacity,
  });
  const bodies = data.bodies.map((b) => ({
    name: b.name, colour: b.colour, tip: b.tip, positions: floats(b.positions), quaternions: floats(b.quaternions),
  }));
  const arrows = data.arrows.map((a) => Object.assign({}, a, {values: floats(a.values), places: floats(a.places)}));
  const readouts = data.readouts.map((t) => Object.assign({}, t, {values: floats(t.values)}));
  const span = data.end - data.start;
  const count = data.count;
  const several = bodies.length > 1;

  // -- values between the samples -------------------------------------------------------------------

  function between(values, width, k, part) {
    const found = new Array(width);
    for (let n = 0; n < width; n += 1) {
      const [a, b] = [values[width * k + n], values[width * Math.min(k + 1, count - 1) + n]];
      found[n] = a + part * (b - a);
    }
    return found;
  }

  /* On the great circle; neighbours are of the sign that makes the way short. */
  function slerp(values, k, part) {
    const a = values.subarray(4 * k, 4 * k + 4);
    const next = Math.min(k + 1, count - 1);
    const b = values.subarray(4 * next, 4 * next + 4);
    const cosine = Math.min(1, a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]);
    const angle = Math.acos(cosine);
    const sine = Math.sin(angle);
    const [p, q] = sine > 1e-5 ? [Math.sin((1 - part) * angle) / sine, Math.sin(part * angle) / sine] : [1 - part, part];
    return [0, 1, 2, 3].map((n) => p * a[n] + q * b[n]);
  }

  const ORIGIN = [0, 0, 0];
  const position = (body, k, part) => (body.positions ? between(body.positions, 3, k, part) : ORIGIN);

  /* Components in space of a vector with components in a body. */
  function turned(q, v) {
    const [s, x, y, z] = q;
    const t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])];
    return [v[0] + s * t[0] + y * t[2] - z * t[1], v[1] + s * t[1] + z * t[0] - x * t[2], v[2] + s * t[2] + x * t[1] - y * t[0]];
  }

  const length = (v) => Math.hypot(v[0], v[1], v[2]);

  // -- the picture ----------------------------------------------------------------------------------

  const canvas = byId("view");
  let viewer;
  try {
    viewer = createViewer(canvas, {
      radius: data.radius, centre: data.centre, up: data.up, view: data.view, ground: data.ground,
      theme: darkness.matches ? "dark" : "light",
      names: {space: data.axes},
      bodies: data.bodies.map((b) => ({name: b.name, colour: b.colour, frame: b.frame, axes: b.axes, shapes: b.shapes.map(shape)})),
      stand: data.stand.map(shape),
    });
  } catch (error) {
    byId("sorry").hidden = false;
    byId("sorry").textContent = "This page needs WebGL, which this browser does not offer or has switched off.";
    return;
  }

  const factor = (arrow) => data.scales[arrow.unit] || 0;
  const short = (vector) => length(vector) < SHORTEST * data.radius;

  const TRAIL = {width: 2, opacity: 0.75, layer: "trails"};
  const trailColour = (n) => (several ? data.bodies[n].colour : "orange");
  const tipAt = (body, at, q) => turned(q, body.tip).map((x, m) => at[m] + x);

  function drawTrails() {
    bodies.forEach((body, n) => {
      if (!body.tip) {
        return;
      }
      body.path = new Float32Array(3 * count);
      for (let k = 0; k < count; k += 1) {
        body.path.set(tipAt(body, position(body, k, 0), body.quaternions.subarray(4 * k, 4 * k + 4)), 3 * k);
      }
      viewer.trail("tip " + n, body.path, {colour: trailColour(n), ...TRAIL});
    });
    if (!several) {
      const points = arrows[0].values.map((x) => x * factor(arrows[0]));
      viewer.trail("omega", points, {colour: "red", width: 1.5, opacity: 0.55, layer: "path of omega"});
    }
  }
  drawTrails();

  // -- what is shown ----------------------------------------------------------------------------------

  const state = {time: 0, playing: false, speed: 1, chosen: 0, last: 0, follow: data.follow};
  const shown = {};
  const OMEGA = ["\u03c9", "i", ""];
  const plain = (text) => [text, "", ""];

  function swatch(colour) {
    const found = document.createElement("span");
    found.className = "swatch";
    found.style.background = createViewer.colours[colour];
    return found;
  }

  function box(id, runs, on, act, colour) {
    const label = document.createElement("label");
    const input = document.createElement("input");
    Object.assign(input, {type: "checkbox", checked: on, id: "show-" + id});
    input.addEventListener("change", () => {
      act(input.checked);
      draw();
    });
    label.append(input);
    if (colour) {
      label.append(swatch(colour));
    }
    words.html(typeof runs === "string" ? [plain(runs)] : runs, label.appendChild(document.createElement("span")));
    byId("show").append(label);
    act(on);
    return input;
  }

  const kinds = [...new Set(arrows.map((a) => a.kind))];
  kinds.forEach((kind) => {
    const colour = arrows.find((a) => a.kind === kind).colour;
    const acts = arrows.some((a) => a.kind === kind && a.words);
    const seen = acts ? data.kinds[kind].few : !several || data.ground === null;
    box(kind, data.kinds[kind].words, seen, (on) => { shown[kind] = on; }, colour);
  });
  if (several) {
    const label = document.createElement("label");
    const select = document.createElement("select");
    select.id = "chosen";
    bodies.forEach((body, n) => select.append(new Option(body.name, n)));
    select.addEventListener("change", () => {
      state.chosen = Number(select.value);
      chosenRow();
      draw();
      say();
    });
    words.html([OMEGA, plain(" of")], label.appendChild(document.createElement("span")));
    label.append(select);
    byId("show").append(label);
  }
  const trails = box("trails", several ? "paths of the tips" : "path of the tip", true, (on) => viewer.show("trails", on));
  if (!several) {
    box("path", [plain("path of "), OMEGA], false, (on) => viewer.show("path of omega", on));
  }
  const space = box("space", "space frame", !several, (on) => viewer.show("space frame", on));
  const frames = box("frames", several ? "body frames" : "body frame", !several, (on) => viewer.show("body frames", on));
  if (data.ground !== null) {
    box("ground", "ground, squares of " + Number(viewer.cell.toPrecision(2)) + " m", true, (on) => viewer.show("ground", on));
  }

  if (bodies.some((body) => body.positions)) {
    const label = document.createElement("label");
    const select = document.createElement("select");
    select.id = "follow";
    select.append(new Option("nothing", -1));
    bodies.forEach((body, n) => select.append(new Option(body.name, n)));
    select.value = String(state.follow);
    select.addEventListener("change", () => {
      state.follow = Number(select.value);
      draw();
    });
    label.append(document.createTextNode("camera follows"), select);
    byId("show").append(label);
  }

  const rows = [];
  function row(name, unit, value, {table = "readouts", colour, title} = {}) {
    const line = byId(table).tBodies[0].insertRow();
    const head = document.createElement("th");
    head.scope = "row";
    if (colour) {
      head.append(swatch(colour), " ");
    }
    words.html(name, head);
    if (title) {
      head.title = title;
      const unseen = head.appendChild(document.createElement("span"));
      unseen.className = "unseen";
      unseen.textContent = ", " + title;
    }
    line.append(head);
    const cell = line.insertCell();
    line.insertCell().textContent = unit;
    rows.push({line, cell, head, value, name: words.text(name), unit});
  }
  const places = Math.max(0, Math.min(6, 3 - Math.floor(Math.log10(span))));
  const timeText = () => (data.start + state.time).toFixed(places);
  function number(x) {
    const away = Math.abs(x);
    const text = away < 1e-12 ? "0" : (away < 1e-3 || away >= 1e6 ? x.toExponential(2) : x.toPrecision(4));
    return text.replace(/-/g, "\u2212");
  }
  const size = (arrow) => (k, part) => length(between(arrow.values, 3, k, part));
  const sized = (runs) => [plain("|"), ...runs, plain("|")];
  row([["t", "i", ""]], "s", () => data.start + state.time);
  rows[0].fixed = true;
  row(sized([OMEGA]), "rad/s", (k, part) => size(arrows[state.chosen])(k, part));
  function chosenRow() {
    rows[1].head.replaceChildren();
    words.html([...sized([OMEGA]), plain(several ? " of " + bodies[state.chosen].name : "")], rows[1].head);
  }
  chosenRow();
  arrows.filter((a) => !a.words && a.kind !== "omega").forEach((a) => row(sized(a.text), a.unit, size(a)));
  readouts.forEach((t) => row(t.name, t.unit, (k, part) => between(t.values, 1, k, part)[0]));
  const acting = arrows.filter((a) => a.words);
  byId("acting").hidden = !acting.length;
  acting.forEach((a) => {
    row(a.text, a.unit, size(a), {table: "forces", colour: a.colour, title: a.words});
    rows[rows.length - 1].arrow = a;
  });

  if (several) {
    bodies.forEach((body) => {
      const item = document.createElement("li");
      item.append(swatch(body.colour), document.createTextNode(body.name));
      byId("legend").append(item);
    });
  } else {
    byId("bodies").remove();
  }
  byId("sizes").textContent = "Arrows of one unit have one scale; the longest are " + Object.entries(data.scales).map(([unit]) => {
    const most = Math.max(...arrows.filter((a) => a.unit === unit).map((a) => {
      let found = 0;
      for (let k = 0; k < count; k += 1) {
        found = Math.max(found, length(a.values.subarray(3 * k, 3 * k + 3)));
      }
      return found;
    }));
    return Number(most.toPrecision(3)) + " " + unit;
  }).join(", ") + ". Momentum " + (several ? "is about the common centre of mass. Forces and torques are those on the body that is named; in grey are those too short to be drawn."
    : "and torque are about the body's origin.");

  // -- one moment -----------------------------------------------------------------------------------

  function moment() {
    const place = span ? (state.time / span) * (count - 1) : 0;
    const k = Math.min(Math.floor(place), count - 1);
    return [k, place - k];
  }

  function draw() {
    const [k, part] = moment();
    const at = bodies.map((body, n) => {
      const where = position(body, k, part);
      const q = slerp(body.quaternions, k, part);
      viewer.pose(n, where, q);
      if (body.tip) { // to the last sample, and from there to where the tip is now
        viewer.trailTo("tip " + n, k + 1);
        viewer.line("end " + n, body.path.subarray(3 * k, 3 * k + 3), tipAt(body, where, q), {colour: trailColour(n), ...TRAIL});
      }
      return where;
    });
    if (!several) {
      viewer.trailTo("omega", k + 2);
    }
    data.links.forEach((link, n) => {
      const [a, b] = link.points.map((p, end) => {
        const body = link.bodies[end];
        const turn = body < 0 ? p : turned(slerp(bodies[body].quaternions, k, part), p);
        return body < 0 ? p : at[body].map((x, m) => x + turn[m]);
      });
      viewer.line("link " + n, a, b, {colour: "grey", width: 3, opacity: 1});
    });
    arrows.forEach((arrow, n) => {
      const seen = shown[arrow.kind] && (arrow.kind !== "omega" || n === state.chosen);
      const origin = arrow.body >= 0 ? at[arrow.body] : (arrow.places ? between(arrow.places, 3, k, part) : ORIGIN);
      const whole = between(arrow.values, 3, k, part).map((x) => x * factor(arrow));
      const vector = seen && !short(whole) ? whole : null;
      viewer.arrow(arrow.kind + n, origin, vector, {colour: arrow.colour, text: arrow.text});
    });
    if (state.follow >= 0) {
      viewer.follow(at[state.follow]);
    }
    viewer.render();
    const slider = byId("time");
    slider.value = String(Math.round(1000 * (span ? state.time / span : 0)));
    slider.setAttribute("aria-valuetext", timeText() + " seconds");
    byId("clock").textContent = "t = " + timeText() + " s";
  }

  function say() {
    const [k, part] = moment();
    rows.forEach((r) => {
      r.cell.textContent = r.fixed ? timeText() : number(r.value(k, part));
      if (r.arrow) {
        r.line.classList.toggle("faint", r.value(k, part) * factor(r.arrow) < SHORTEST * data.radius);
      }
    });
    if (!state.playing) {
      byId("status").textContent = rows.slice(0, 4).map((r) => r.name + " " + r.cell.textContent + " " + r.unit).join(", ");
    }
  }

  function go(time) {
    state.time = Math.max(0, Math.min(span, time));
    draw();
    say();
  }

  // -- time -------------------------------------------------------------------------------------------

  function frame(now) {
    if (!state.playing) {
      return;
    }
    const passed = Math.max(0, Math.min((now - state.last) / 1000, LONGEST_FRAME));
    state.last = now;
    let time = state.time + passed * state.speed * data.speed;
    if (time >= span) {
      time = byId("loop").checked ? time % span : span;
      if (!byId("loop").checked) {
        play(false);
      }
    }
    state.time = time;
    draw();
    say(); // the panel is of the instant that the clock shows
    requestAnimationFrame(frame);
  }

  function play(on) {
    const fresh = on && !state.playing;
    state.playing = on;
    byId("play").textContent = on ? "Pause" : "Play";
    if (fresh) {
      if (state.time >= span) {
        state.time = 0;
      }
      byId("status").textContent = "";
      state.last = performance.now();
      requestAnimationFrame(frame);
    } else if (!on) {
      say();
    }
  }

  const select = byId("speed");
  SPEEDS.forEach((s) => {
    const whole = Number((s * data.speed).toPrecision(4));
    select.append(new Option(whole.toLocaleString("en") + "\u00d7", s, s === 1, s === 1));
  });
  function speed(index) {
    select.selectedIndex = Math.max(0, Math.min(SPEEDS.length - 1, index));
    state.speed = SPEEDS[select.selectedIndex];
  }
  const step = (sign) => () => {
    play(false);
    go(state.time + (sign * span) / Math.min(count - 1, 300));
  };
  const toggled = (input) => () => { input.click(); };

  function vectors() {
    const inputs = kinds.map((kind) => byId("show-" + kind));
    const on = !inputs.some((i) => i.checked);
    inputs.filter((i) => i.checked !== on).forEach((i) => i.click());
  }

  const theme = byId("theme");
  function dress(dark) {
    document.documentElement.dataset.theme = dark ? "dark" : "light";
    theme.textContent = dark ? "Light background" : "Dark background";
    viewer.theme(dark ? "dark" : "light");
  }
  const isDark = () => document.documentElement.dataset.theme === "dark";

  const KEYS = {
    " ": () => play(!state.playing), ",": step(-1), ".": step(1),
    "[": () => speed(select.selectedIndex - 1), "]": () => speed(select.selectedIndex + 1),
    r: () => go(0), l: toggled(byId("loop")), t: toggled(trails), v: vectors, s: toggled(space), b: toggled(frames),
    d: () => dress(!isDark()),
  };
  document.addEventListener("keydown", (event) => {
    const own = event.target.closest("button, select, summary, a, input[type=checkbox]");
    if (event.ctrlKey || event.metaKey || event.altKey || !KEYS[event.key]) {
      return;
    }
    if (own && (event.key === " " || own.tagName === "SELECT")) {
      return;
    }
    KEYS[event.key]();
    event.preventDefault();
  });
  byId("play").addEventListener("click", () => play(!state.playing));
  byId("back").addEventListener("click", step(-1));
  byId("forth").addEventListener("click", step(1));
  select.addEventListener("change", () => speed(select.selectedIndex));
  byId("time").addEventListener("input", (event) => {
    play(false);
    go((span * Number(event.target.value)) / 1000);
  });
  theme.addEventListener("click", () => dress(!isDark()));
  darkness.addEventListener("change", () => dress(darkness.matches));

  dress(darkness.matches);
  window.animation = {viewer, go};
  go(0);
  play(!still);
})();
