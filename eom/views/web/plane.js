/* Panels of pictures in a plane as SVG: axes with ticks, curves, arrows, values under the pointer, zoom.

   Words are runs, as in words.js. Places on a logarithmic axis are powers of ten. */
"use strict";

const ticks = (() => {
  const signed = (text) => text.replace(/-/g, "\u2212");
  const power = (k) => [["10", "", ""], [signed(String(k)), "", "sup"]];

  /* A number for people; runs. */
  function number(x, digits = 4) {
    const size = Math.abs(x);
    if (x === 0 || (size >= 1e-3 && size < 1e5)) {
      return [[signed(String(Number(x.toPrecision(digits)))), "", ""]];
    }
    const [front, exponent] = x.toExponential(digits - 1).split("e");
    return [[signed(String(Number(front))) + "\u00b7", "", ""], ...power(Number(exponent))];
  }

  function steps(low, high, most) {
    const raw = (high - low) / Math.max(most, 1);
    const unit = Math.pow(10, Math.floor(Math.log10(raw)));
    const step = unit * [1, 2, 5, 10].find((n) => n * unit >= raw * 0.999);
    const found = [];
    for (let k = Math.ceil(low / step - 1e-9); k <= high / step + 1e-9; k += 1) {
      found.push(k * step);
    }
    return found;
  }

  function linear(low, high, most) {
    const at = steps(low, high, most);
    const digits = Math.ceil(Math.log10(Math.max(Math.abs(low), Math.abs(high)) / (at[1] - at[0] || high - low))) + 1;
    return at.map((x) => ({at: x, runs: number(x, Math.min(12, Math.max(2, digits)))}));
  }

  function logarithmic(low, high, most) {
    const decades = Math.floor(high + 1e-9) - Math.ceil(low - 1e-9);
    const every = Math.max(1, Math.ceil((high - low) / most));
    const found = [];
    if (decades < 1) {
      return linear(10 ** low, 10 ** high, most).filter((t) => t.at > 0)
        .map((t) => ({at: Math.log10(t.at), runs: t.runs}));
    }
    for (let k = Math.floor(low); k <= high + 1e-9; k += 1) {
      if (k >= low - 1e-9 && k % every === 0) {
        found.push({at: k, runs: power(k)});
      }
      for (let n = 2; every === 1 && n < 10; n += 1) {
        const at = k + Math.log10(n);
        if (at >= low && at <= high) {
          found.push({at, runs: decades < 2 && (n === 2 || n === 5) ? number(n * 10 ** k) : null});
        }
      }
    }
    return found;
  }

  /* Places and words of ticks between two ends, `most` of them with words; ends of a logarithmic axis are powers. */
  function between(ends, scale, most) {
    const [low, high] = [Math.min(...ends), Math.max(...ends)];
    return (scale === "log" ? logarithmic : linear)(low, high, Math.max(2, most));
  }
  return {between, number};
})();

const createPlane = (() => {
  const DASHES = {solid: "none", dashed: "6.5 3.5", dotted: "1.5 3"};
  const TICK = 12;
  const WORDS = 13;
  const NEAR = 28;
  const {node} = words;
  let made = 0;

  const create = (holder, panel) => {
    const svg = node("svg", {tabindex: 0, role: "application", "aria-roledescription": "diagram"}, holder);
    const tip = document.createElement("div");
    tip.className = "tip";
    tip.hidden = true;
    holder.append(tip);
    const clip = "clip-" + (made += 1);
    const hidden = new Set();
    const home = panel.axes.map((axis) => [axis.low, axis.high]);
    const linked = [];
    let ranges = home.map((ends) => [...ends]);
    let [wide, high, left] = [1, 1, 0];
    let area = {};
    const points = panel.items.map((item) =>
      item.at && item.at.map((column, k) => (panel.axes[k].scale === "log" ? Array.from(column, Math.log10) : column)));

    // -- scales -------------------------------------------------------------------------------------

    const x = (v) => area.left + ((v - ranges[0][0]) / (ranges[0][1] - ranges[0][0])) * area.wide;
    const y = (v) => area.top + (1 - (v - ranges[1][0]) / (ranges[1][1] - ranges[1][0])) * area.high;
    const back = [
      (px) => ranges[0][0] + ((px - area.left) / area.wide) * (ranges[0][1] - ranges[0][0]),
      (py) => ranges[1][0] + (1 - (py - area.top) / area.high) * (ranges[1][1] - ranges[1][0]),
    ];
    const marks = (k) => (panel.bare ? []
      : ticks.between(ranges[k], panel.axes[k].scale, k ? holder.clientHeight / 38 : holder.clientWidth / 75));

    /* Room that ticks and words need to the left. */
    function needs() {
      if (panel.bare) {
        return 2;
      }
      const widest = Math.max(0, ...marks(1).filter((t) => t.runs).map((t) => words.width(t.runs, TICK)));
      return Math.ceil(widest) + 12 + (panel.axes[1].words.length ? WORDS + 10 : 0);
    }

    function measure() {
      [wide, high] = [Math.max(holder.clientWidth, 60), Math.max(holder.clientHeight, 60)];
      const below = panel.bare ? 2 : TICK + 12 + (panel.axes[0].words.length ? WORDS + 8 : 0);
      const beside = panel.bare ? 2 : 18;
      area = {left, top: 9, wide: Math.max(wide - left - beside, 20), high: Math.max(high - 9 - below, 20)};
    }

    /* Widen one range so that a unit is as long on both axes. */
    function evened() {
      if (!panel.equal) {
        return;
      }
      const units = [area.wide, area.high].map((size, k) => Math.abs(ranges[k][1] - ranges[k][0]) / size);
      const k = units[0] < units[1] ? 0 : 1;
      const [a, b] = ranges[k];
      const more = ((b - a) * (units[1 - k] / units[k] - 1)) / 2;
      ranges[k] = [a - more, b + more];
    }

    // -- drawing --------------------------------------------------------------------------------------

    const fixed = (v) => Math.max(-1e5, Math.min(1e5, v)).toFixed(1);

    function path(at) {
      let text = "";
      let open = false;
      for (let k = 0; k < at[0].length; k += 1) {
        const [a, b] = [x(at[0][k]), y(at[1][k])];
        const whole = Number.isFinite(a) && Number.isFinite(b);
        text += whole ? (open ? "L" : "M") + fixed(a) + " " + fixed(b) : "";
        open = whole;
      }
      return text;
    }

    const DRAWN = {
      curve(item, at, group) {
        node("path", {d: path(at), fill: "none", stroke: "currentColor", "stroke-width": item.width,
                      "stroke-dasharray": DASHES[item.dash], "stroke-linejoin": "round"}, group);
      },
      marks(item, at, group) {
        for (let k = 0; k < at[0].length; k += 1) {
          const [a, b] = [x(at[0][k]), y(at[1][k])];
          if (Number.isFinite(a) && Number.isFinite(b)) {
            node("circle", {cx: fixed(a), cy: fixed(b), r: item.size / 2, fill: "currentColor"}, group);
          }
        }
      },
      arrow(item, at, group) {
        const [a, b, c, d] = [x(at[0][0]), y(at[1][0]), x(at[0][1]), y(at[1][1])];
        const length = Math.hypot(c - a, d - b);
        if (length > 0.5) {
          const [u, v] = [(c - a) / length, (d - b) / length];
          const head = Math.min(5.3 + 1.2 * item.width, length);
          const foot = [c - head * u, d - head * v];
          const side = 0.4 * head;
          node("line", {x1: a, y1: b, x2: foot[0], y2: foot[1], stroke: "currentColor", "stroke-width": item.width}, group);
          node("polygon", {fill: "currentColor", points: `${c},${d} ${foot[0] - side * v},${foot[1] + side * u} `
            + `${foot[0] + side * v},${foot[1] - side * u}`}, group);
        }
        if (item.words.length) {
          const [p, q] = [sign(at[0][1] - at[0][0]), sign(at[1][1] - at[1][0])];
          words.svg(item.words, TICK, {x: c + 7 * p, y: d - (q ? 12 : 0) * q, class: "halo", fill: "currentColor",
            "text-anchor": ["end", "middle", "start"][p + 1]}, group);
        }
      },
      words(item, at, group) {
        words.svg(item.words, TICK, {x: x(at[0][0]), y: y(at[1][0]), fill: "currentColor", "text-anchor": "middle"}, group);
      },
    };
    const sign = (v) => (Math.abs(v) < 1e-12 ? 0 : Math.sign(v));

    function axes() {
      const {left: l, top, wide: w, high: h} = area;
      const grid = node("g", {class: "grid"}, svg);
      const scale = node("g", {class: "scale", "font-size": TICK}, svg);
      marks(0).forEach((t) => {
        const at = x(t.at);
        node("line", {x1: at, x2: at, y1: top, y2: top + h, class: t.runs ? "" : "minor"}, grid);
        if (t.runs) {
          words.svg(t.runs, TICK, {x: at, y: top + h + 14, "text-anchor": "middle"}, scale);
        }
      });
      marks(1).forEach((t) => {
        const at = y(t.at);
        node("line", {x1: l, x2: l + w, y1: at, y2: at, class: t.runs ? "" : "minor"}, grid);
        if (t.runs) {
          words.svg(t.runs, TICK, {x: l - 7, y: at, "text-anchor": "end"}, scale);
        }
      });
      node("rect", {x: l, y: top, width: w, height: h, class: "frame"}, svg);
      words.svg(panel.axes[0].words, WORDS, {x: l + w / 2, y: high - 10, "text-anchor": "middle", class: "words"}, svg);
      const place = `translate(${WORDS / 2 + 3},${top + h / 2}) rotate(-90)`;
      words.svg(panel.axes[1].words, WORDS, {transform: place, "text-anchor": "middle", class: "words"}, svg);
    }

    function draw() {
      measure();
      evened();
      svg.replaceChildren();
      svg.setAttribute("viewBox", `0 0 ${wide} ${high}`);
      const room = node("clipPath", {id: clip}, node("defs", {}, svg));
      node("rect", {x: area.left, y: area.top, width: area.wide, height: area.high}, room);
      if (!panel.bare) {
        axes();
      }
      const all = node("g", {}, svg);
      panel.items.forEach((item, k) => {
        const clipped = !panel.bare && (item.kind === "curve" || item.kind === "marks");
        const group = node("g", {class: "c-" + item.colour, ...(clipped ? {"clip-path": `url(#${clip})`} : {})}, all);
        if (!hidden.has(item.label)) {
          DRAWN[item.kind](item, points[k], group);
        }
      });
      pointed(null);
    }

    // -- values under the pointer -----------------------------------------------------------------------

    function nearest(px, py) {
      let [best, found] = [NEAR * NEAR, null];
      panel.items.forEach((item, n) => {
        if (hidden.has(item.label) || (item.kind !== "curve" && item.kind !== "marks")) {
          return;
        }
        for (let k = 0; k < points[n][0].length; k += 1) {
          const distance = (x(points[n][0][k]) - px) ** 2 + (y(points[n][1][k]) - py) ** 2;
          if (distance < best) {
            [best, found] = [distance, {item, n, k}];
          }
        }
      });
      return found;
    }

    function pointed(found) {
      const old = svg.querySelector(".pointed");
      if (old) {
        old.remove();
      }
      tip.hidden = !found;
      if (!found) {
        return;
      }
      const at = [x(points[found.n][0][found.k]), y(points[found.n][1][found.k])];
      const group = node("g", {class: "pointed c-" + found.item.colour}, svg);
      node("circle", {cx: at[0], cy: at[1], r: 5, fill: "none", stroke: "currentColor", "stroke-width": 2}, group);
      createPlane.say(tip, found.item, panel, found.k, at, [wide, high]);
    }

    function place(event) {
      const box = svg.getBoundingClientRect();
      return [((event.clientX - box.left) * wide) / box.width, ((event.clientY - box.top) * high) / box.height];
    }

    // -- zoom ---------------------------------------------------------------------------------------------

    function look(next, told = false) {
      ranges = next.map((ends) => [...ends]);
      draw();
      if (!told) {
        linked.forEach((other) => other.along(ranges[0], next === home));
      }
    }
    function zoom(factor) {
      look(ranges.map(([a, b]) => [(a + b) / 2 - ((b - a) / 2) * factor, (a + b) / 2 + ((b - a) / 2) * factor]));
    }
    function move(across, up) {
      look(ranges.map(([a, b], k) => [a + [across, up][k] * (b - a), b + [across, up][k] * (b - a)]));
    }
    const KEYS = {
      ArrowLeft: () => move(-0.1, 0), ArrowRight: () => move(0.1, 0), ArrowUp: () => move(0, 0.1),
      ArrowDown: () => move(0, -0.1), "+": () => zoom(0.8), "=": () => zoom(0.8), "-": () => zoom(1.25),
      Home: () => look(home), "0": () => look(home),
    };
    svg.addEventListener("keydown", (event) => {
      if (KEYS[event.key] && !event.ctrlKey && !event.metaKey && !event.altKey) {
        KEYS[event.key]();
        event.preventDefault();
      }
    });
    svg.addEventListener("dblclick", () => look(home));

    let from = null;
    svg.addEventListener("pointerdown", (event) => {
      if (event.button === 0 && event.pointerType !== "touch") {
        from = place(event);
        svg.setPointerCapture(event.pointerId);
      }
    });
    svg.addEventListener("pointermove", (event) => {
      const to = place(event);
      if (!from) {
        pointed(nearest(...to));
        return;
      }
      const box = svg.querySelector(".chosen") || node("rect", {class: "chosen"}, svg);
      const [[a, b], [c, d]] = sides(from, to);
      Object.entries({x: a, y: c, width: b - a, height: d - c}).forEach(([key, value]) => box.setAttribute(key, value));
    });
    svg.addEventListener("pointerup", (event) => {
      const start = from;
      from = null;
      if (start) {
        const [[a, b], [c, d]] = sides(start, place(event));
        if (b - a > 6 && d - c > 6) {
          look([ordered(back[0](a), back[0](b), 0), ordered(back[1](d), back[1](c), 1)]);
        } else if (svg.querySelector(".chosen")) {
          svg.querySelector(".chosen").remove();
        }
      }
    });
    svg.addEventListener("pointercancel", () => {
      from = null;
      draw();
    });
    svg.addEventListener("pointerleave", () => pointed(null));
    const ordered = (a, b, k) => ((a < b) === (ranges[k][0] < ranges[k][1]) ? [a, b] : [b, a]);

    /* Ends of a box between two places; where it is thin it is as long as the panel. */
    function sides(start, end) {
      const limits = [[area.left, area.left + area.wide], [area.top, area.top + area.high]];
      const box = [0, 1].map((k) => [start[k], end[k]].map((v) => Math.max(limits[k][0], Math.min(limits[k][1], v)))
        .sort((a, b) => a - b));
      const sizes = box.map(([a, b]) => b - a);
      return box.map((ends, k) => (sizes[k] < 12 && sizes[1 - k] > 20 ? limits[k] : ends));
    }

    return {
      element: svg,
      needs,
      /* Draw anew, `room` to the left of the axes. */
      draw(room) {
        left = room;
        ranges = panel.equal ? home.map((ends) => [...ends]) : ranges;
        draw();
      },
      /* Show or hide what has a label. */
      show(label, seen) {
        hidden[seen ? "delete" : "add"](label);
        draw();
      },
      /* Panels whose range across follows this one's. */
      linked,
      along(range, whole) { look(whole ? home : [range, ranges[1]], true); },
      ranges: () => ranges,
    };
  };

  /* Write into a box beside a place what is there: the name of an item, its values by the words of the axes. */
  create.say = (tip, item, panel, k, at, room) => {
    tip.replaceChildren();
    if (item.words.length) {
      words.html(item.words, tip.appendChild(document.createElement("strong")));
    }
    panel.axes.forEach((axis, n) => {
      const line = tip.appendChild(document.createElement("span"));
      words.html(axis.words.length ? axis.words : [["xyz"[n], "i", ""]], line);
      line.append(": ");
      words.html(ticks.number(item.at[n][k], 5), line);
    });
    tip.hidden = false;
    const left = at[0] + 14 + tip.offsetWidth > room[0] ? at[0] - 14 - tip.offsetWidth : at[0] + 14;
    tip.style.left = Math.max(0, left) + "px";
    tip.style.top = Math.max(0, Math.min(at[1] - 10, room[1] - tip.offsetHeight)) + "px";
  };
  return create;
})();
