/* Words in runs: lists of [text, style, level] with style "", "i", "b" and level "", "sub", "sup"; as HTML, as SVG. */
"use strict";

const words = (() => {
  const NS = "http://www.w3.org/2000/svg";
  const SMALL = 0.72;
  const SHIFT = {"": 0, sub: 0.28, sup: -0.42};

  function node(name, attributes, parent) {
    const made = document.createElementNS(NS, name);
    Object.entries(attributes || {}).forEach(([key, value]) => made.setAttribute(key, value));
    if (parent) {
      parent.append(made);
    }
    return made;
  }

  const text = (runs) => runs.map((run) => run[0]).join("");

  function html(runs, parent) {
    runs.forEach(([part, style, level]) => {
      let within = document.createTextNode(part);
      [style, level].filter(Boolean).forEach((tag) => {
        const outer = document.createElement(tag);
        outer.append(within);
        within = outer;
      });
      parent.append(within);
    });
    return parent;
  }

  /* Text in SVG, its middle line at y. */
  function svg(runs, size, attributes, parent) {
    const made = node("text", {"font-size": size, ...attributes}, parent);
    let before = -0.35;
    runs.forEach(([part, style, level]) => {
      const span = node("tspan", {"font-size": level ? SMALL * size : size}, made);
      const shift = SHIFT[level];
      span.setAttribute("dy", ((shift - before) * size).toFixed(2));
      before = shift;
      if (style) {
        span.setAttribute(...(style === "i" ? ["font-style", "italic"] : ["font-weight", "bold"]));
      }
      span.textContent = part;
    });
    return made;
  }

  const pen = document.createElement("canvas").getContext("2d");
  function width(runs, size) {
    return runs.reduce((sum, [part, , level]) => {
      pen.font = (level ? SMALL * size : size) + "px system-ui, sans-serif";
      return sum + pen.measureText(part).width;
    }, 0);
  }

  return {node, text, html, svg, width};
})();
