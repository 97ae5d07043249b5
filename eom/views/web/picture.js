/* Draws the picture whose data stand in the page: panels in a plane by plane.js, those in space by viewer.js. */
"use strict";

(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const columns = data.columns.map(([kind, text]) => unpacked(text, kind));
  const darkness = window.matchMedia("(prefers-color-scheme: dark)");
  const DARK = {black: "#f2f2f2", blue: "#4aa8e0"};
  const holder = document.getElementById("picture");
  const DASHES = {dashed: [0.02, 0.012], dotted: [0.004, 0.01]};
  const ROD = 0.0034;
  const NEAR = 14;
  const {node} = words;
  const theme = () => (darkness.matches ? "dark" : "light");

  function make(tag, name, parent) {
    const made = document.createElement(tag);
    made.className = name;
    parent.append(made);
    return made;
  }

  // -- space ----------------------------------------------------------------------------------------

  const DRAWN = {
    surface(viewer, item, name, size, at) {
      const shape = {kind: "mesh", vertices: at, faces: columns[item.faces], opacity: item.opacity, smooth: true, plain: true};
      viewer.surface(name, shape, {colour: item.colour, layer: item.layer});
    },
    curve(viewer, item, name, size, at) {
      const dash = DASHES[item.dash] && DASHES[item.dash].map((part) => part * size);
      viewer.trail(name, at, {colour: item.colour, width: item.width, opacity: 1, dash, layer: item.layer});
    },
    marks(viewer, item, name, size, at) {
      viewer.dots(at, {colour: item.colour, size: item.size, layer: item.layer});
    },
    arrow(viewer, item, name, size, at) {
      const vector = [0, 1, 2].map((k) => at[3 + k] - at[k]);
      viewer.arrow(name, at.slice(0, 3), vector, {colour: item.colour, text: item.words, layer: item.layer,
        thickness: ROD * item.width, gap: 0.05, size: {size: 15, weight: 600}});
    },
    words(viewer, item, name, size, at) {
      viewer.text(at, item.words, {colour: item.colour, layer: item.layer, size: {size: 14, weight: 600}});
    },
  };

  /* What a panel in space is drawn by: data to lengths, in which a box without equal scales is a cube. */
  function lengths(panel) {
    const scale = panel.axes.map((axis) => (panel.equal ? 1 : 1 / (axis.high - axis.low)));
    const along = panel.axes.map((axis, k) => (axis.scale === "log" ? (v) => Math.log10(v) * scale[k] : (v) => v * scale[k]));
    const low = panel.axes.map((axis, k) => axis.low * scale[k]);
    const high = panel.axes.map((axis, k) => axis.high * scale[k]);
    return {scale, along, low, high, size: Math.hypot(...low.map((v, k) => high[k] - v))};
  }

  function flat(item, along) {
    const found = [];
    for (let n = 0; n < item.at[0].length; n += 1) {
      along.forEach((to, k) => found.push(to(item.at[k][n])));
    }
    return found;
  }

  function createSpace(box, panel, title) {
    const canvas = make("canvas", "", box);
    const made = lengths(panel);
    const {low, high, size} = made;
    const radius = size / 2;
    const places = panel.items.map((item) => flat(item, made.along));
    const fit = panel.bare ? places.flat().filter(Number.isFinite) : [];
    for (let n = 0; n < 8 && !panel.bare; n += 1) {
      fit.push(...low.map((v, k) => (n >> k & 1 ? high[k] : v)));
    }
    Object.entries({tabindex: 0, role: "application", "aria-roledescription": "three-dimensional view",
                    "aria-label": title + ". Arrow keys turn it, plus and minus move it."})
      .forEach(([key, value]) => canvas.setAttribute(key, value));
    const viewer = createViewer(canvas, {
      radius, centre: low.map((v, k) => (v + high[k]) / 2), view: [panel.view[1], panel.view[0]], fit,
      margins: panel.bare ? [36, 36] : [56, 44], theme: theme(), dark: DARK, paper: true,
    });
    viewer.show("space frame", false);
    panel.items.forEach((item, n) => {
      item.layer = item.label === null ? "always" : "label " + item.label;
      DRAWN[item.kind](viewer, item, "item " + n, size, places[n]);
    });
    if (!panel.bare) {
      const marks = panel.axes.map((axis, k) => ticks.between([axis.low, axis.high], axis.scale, 5)
        .map((t) => ({at: t.at * made.scale[k], runs: t.runs})));
      viewer.box({low, high, ticks: marks, names: panel.axes.map((axis) => axis.words)});
    }
    hovers(canvas, box, panel, places, viewer);
    viewer.render();
    return {
      viewer,
      element: canvas,
      show(label, seen) {
        panel.items.forEach((item) => { item.hidden = item.label === label ? !seen : item.hidden; });
        viewer.show("label " + label, seen);
      },
      draw() { viewer.resize(); },
    };
  }

  /* Values at the point of a line or mark that is nearest to the pointer. */
  function hovers(canvas, box, panel, places, viewer) {
    const tip = make("div", "tip", box);
    tip.hidden = true;
    canvas.addEventListener("pointerleave", () => { tip.hidden = true; });
    canvas.addEventListener("pointermove", (event) => {
      tip.hidden = true;
      if (event.buttons) {
        return;
      }
      const [px, py] = [event.offsetX, event.offsetY];
      let [best, found] = [NEAR * NEAR, null];
      panel.items.forEach((item, n) => {
        if (item.hidden || (item.kind !== "curve" && item.kind !== "marks")) {
          return;
        }
        for (let k = 0; k < places[n].length; k += 3) {
          const [x, y] = viewer.seenAt(places[n].slice(k, k + 3));
          const distance = (x - px) ** 2 + (y - py) ** 2;
          if (distance < best) {
            [best, found] = [distance, [item, k / 3, [x, y]]];
          }
        }
      });
      if (found) {
        createPlane.say(tip, found[0], panel, found[1], found[2], [canvas.clientWidth, canvas.clientHeight]);
      }
    });
  }

  // -- legends ----------------------------------------------------------------------------------------

  function swatch(item, parent) {
    const svg = node("svg", {width: 24, height: 14, class: "c-" + item.colour, "aria-hidden": "true"}, parent);
    if (item.kind === "surface") {
      node("rect", {x: 2, y: 2, width: 20, height: 10, fill: "currentColor", "fill-opacity": Math.max(item.opacity, 0.3)}, svg);
    } else if (item.kind === "marks") {
      node("circle", {cx: 12, cy: 7, r: Math.min(item.size / 2, 6), fill: "currentColor"}, svg);
    } else {
      node("line", {x1: 1, x2: 23, y1: 7, y2: 7, stroke: "currentColor", "stroke-width": item.width,
                    "stroke-dasharray": {dashed: "6 3", dotted: "2 3"}[item.dash] || "none"}, svg);
    }
  }

  /* A list of what is named in some panels; a click hides or shows all of a name. */
  function legend(panels, parent) {
    const named = new Map();
    panels.forEach(({panel}) => panel.items.filter((item) => item.label !== null)
      .forEach((item) => named.set(item.label, item)));
    if (!named.size) {
      return;
    }
    const list = make("ul", "legend", parent);
    named.forEach((item, label) => {
      const button = make("button", "", make("li", "", list));
      button.type = "button";
      button.setAttribute("aria-pressed", "true");
      swatch(item, button);
      words.html(data.labels[label], button.appendChild(document.createElement("span")));
      button.addEventListener("click", () => {
        const seen = button.getAttribute("aria-pressed") === "false";
        button.setAttribute("aria-pressed", String(seen));
        panels.forEach(({drawing}) => drawing.show(label, seen));
      });
    });
  }

  // -- the page -----------------------------------------------------------------------------------------

  function create(panel, parent) {
    const figure = make("figure", "panel", parent);
    figure.style.flex = panel.width + " 1 0";
    if (panel.title.length) {
      words.html(panel.title, make("figcaption", "", figure));
    }
    panel.items.forEach((item) => {
      item.at = item.at.map((n) => columns[n]);
      item.words = item.words || (item.label === null ? [] : data.labels[item.label]);
    });
    return {panel, figure, box: make("div", "drawn", figure)};
  }

  const title = document.querySelector("h1").textContent;
  function drawn({panel, box}) {
    const name = words.text(panel.title) || title;
    if (panel.axes.length === 2) {
      const made = createPlane(box, panel);
      made.element.setAttribute("aria-label", name + ". Arrow keys move it, plus and minus zoom.");
      return made;
    }
    if (document.createElement("canvas").getContext("webgl2")) {
      return createSpace(box, panel, name);
    }
    make("p", "sorry", box).textContent = "This needs WebGL 2, which this browser does not offer or has switched off.";
    return {show() {}, draw() {}};
  }

  const rows = data.rows.map((panels) => {
    const element = make("div", "row", holder);
    return {element, panels: panels.map((panel) => create(panel, element)),
            high: Math.max(...panels.map((panel) => panel.height))};
  });
  const all = rows.flatMap((row) => row.panels);

  /* Rows fill the window, and are not lower than they need to be; or the picture has the size that was asked for. */
  function heights() {
    const usual = rows.reduce((sum, row) => sum + row.high, 0);
    const others = document.querySelector("main").offsetHeight
      - rows.reduce((sum, row) => sum + row.panels[0].box.offsetHeight, 0);
    const room = Math.min(data.size ? data.size[1] : window.innerHeight - others - 4, 2.2 * usual);
    const factor = data.size ? room / usual : Math.max(1, room / usual);
    rows.forEach((row) => row.panels.forEach(({box}) => { box.style.height = Math.round(row.high * factor) + "px"; }));
  }

  if (data.size) {
    holder.style.alignSelf = "center";
    holder.style.width = `min(${data.size[0]}px, 100%)`;
    rows.forEach(({element}) => { element.style.minWidth = data.size[0] + "px"; });
  }
  rows.forEach(({panels}) => panels.forEach(({panel, box}) => { box.style.height = panel.height + "px"; }));
  all.forEach((one) => { one.drawing = drawn(one); });
  rows.forEach((row) => {
    if (row.panels.some(({panel}) => panel.axes.length === 3)) {
      legend(row.panels, row.element);
    } else {
      row.panels.forEach((one) => legend([one], one.figure));
    }
  });
  const planes = all.filter(({panel}) => panel.axes.length === 2);
  const alone = planes.filter(({figure}) => figure.parentElement.querySelectorAll(".panel").length === 1);
  alone.forEach((one) => one.drawing.linked.push(...alone.filter((other) => other !== one
    && one.panel.axes[0].fixed && ["low", "high", "scale"].every((key) => one.panel.axes[0][key] === other.panel.axes[0][key]))
    .map((other) => other.drawing)));
  if (alone.some(({figure}) => figure.querySelector(".legend"))) {
    alone.forEach(({figure}) => {
      if (!figure.querySelector(".legend")) {
        make("div", "legend", figure);
      }
    });
  }

  function draw() {
    heights();
    const left = Math.max(0, ...alone.map(({drawing}) => drawing.needs()));
    all.forEach((one) => one.drawing.draw(alone.includes(one) ? left : one.drawing.needs && one.drawing.needs()));
  }
  draw();
  window.addEventListener("resize", draw);

  const dress = (name) => all.filter(({drawing}) => drawing.viewer).forEach(({drawing}) => {
    drawing.viewer.theme(name);
    drawing.viewer.render();
  });
  darkness.addEventListener("change", () => dress(theme()));
  window.addEventListener("beforeprint", () => {
    dress("light");
    draw();
  });
  window.addEventListener("afterprint", () => {
    dress(theme());
    draw();
  });
  window.picture = all.map(({drawing}) => drawing);
})();
