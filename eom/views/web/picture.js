/* Draws the picture whose data stand in the page, in the colours of the theme. */
"use strict";
(() => {
  const media = matchMedia("(prefers-color-scheme: dark)");
  const swapped = {
    "#ffffff": "#14171c", "#222222": "#e8e8e8", "#000000": "#f2f2f2", "#dddddd": "#3a3f48",
    "#777777": "#9aa0a8", "#0072b2": "#4aa8e0",
  };
  const words = new Set(["text", "name", "legendgroup"]);
  const text = document.getElementById("data").textContent;
  const draw = () => {
    const given = JSON.parse(text, (key, value) =>
      media.matches && !words.has(key) && Object.hasOwn(swapped, value) ? swapped[value] : value);
    Plotly.react("picture", given.data, given.layout, { responsive: true, displaylogo: false });
  };
  draw();
  media.addEventListener("change", draw);
})();
