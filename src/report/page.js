// Draws the figures of a report's page with plotly.js from the data in the page.
//
// A long series is thinned to the width of its drawing: the lowest and the highest value in each
// column of pixels stay. A zoom redraws the part that it shows from all values in the page.
"use strict";
(() => {
  const { unpack, lowerBound, forColumns, extremes, visible, strokes, cloud, csvOf } = goingrateSeries;
  const data = JSON.parse(document.getElementById("figure-data").textContent);
  const margin = { l: 62, r: 12, t: 30, b: 46 }; // px; the buttons are in the top margin
  const panelHeight = 250, titleRow = 24; // px
  const legendHeight = (rows) => (rows > 1 ? 30 : 22) * rows; // px

  // ---- the numbers

  const arrays = data.arrays.map((a) => (Array.isArray(a) ? a.map((v) => v ?? NaN) : unpack(a)));
  const isLong = (series) => series.style !== "cells" && arrays[series.x].length > 1000;

  // Whether the zoom is so close that single stretches show, of which the page holds only the lowest
  // and the highest value.
  const isCoarse = (series, range, columns) => series.style === "points" && series.stretch > 1
    && visible(arrays[series.x], range) < 4 * columns;

  // ---- colours

  // The colours of the page's style sheet, which has a light and a dark scheme.
  function theme() {
    const root = getComputedStyle(document.documentElement);
    const holder = document.createElement("div");
    holder.className = "figure";
    document.body.append(holder);
    const ink = Array.from({ length: 8 }, (_, i) => {
      const probe = holder.appendChild(document.createElement("i"));
      probe.className = `c${i}`;
      return getComputedStyle(probe).getPropertyValue("--ink").trim();
    });
    holder.remove();
    const of = (name) => root.getPropertyValue(name).trim();
    return { ink, text: of("--text"), grid: of("--grid"), paper: of("--paper") };
  }

  const faded = (colour, opacity) => colour + Math.round(255 * opacity).toString(16).padStart(2, "0");

  // ---- from series to traces

  const dashes = ["solid", "dash", "dot", "dashdot"];

  // The outline of a band: the lowest and the highest limit in each column of pixels.
  function outline(series, range, columns) {
    const all = { x: arrays[series.x], low: arrays[series.low], high: arrays[series.high] };
    if (!isLong(series)) return all;
    const out = { x: [], low: [], high: [] };
    forColumns(all.x, range, columns, (from, to) => {
      out.x.push(all.x[from]);
      out.low.push(all.low.slice(from, to).reduce((a, b) => Math.min(a, b)));
      out.high.push(all.high.slice(from, to).reduce((a, b) => Math.max(a, b)));
    });
    return out;
  }

  function bandTraces(series, base, colour, range, columns) {
    const { x, low, high } = outline(series, range, columns);
    const edge = { ...base, mode: "lines", line: { width: 0 }, hoverinfo: "skip" };
    return [{ ...edge, x, y: low, showlegend: false },
      { ...edge, x, y: high, fill: "tonexty", fillcolor: faded(colour, 0.25) }];
  }

  function barTrace(series, base, colour) {
    const y = arrays[series.y], low = arrays[series.low], high = arrays[series.high];
    const known = (i) => Number.isFinite(low[i]) && Number.isFinite(high[i]);
    return {
      ...base, mode: "markers", x: arrays[series.x], y, marker: { color: colour, size: 7 },
      error_y: { type: "data", symmetric: false, color: colour, thickness: 1.5, width: 4,
        array: Array.from(y, (v, i) => (known(i) ? high[i] - v : 0)),
        arrayminus: Array.from(y, (v, i) => (known(i) ? v - low[i] : 0)) },
    };
  }

  // The numbers on the squares; the squares themselves are shapes of the layout.
  function cellTrace(series, base, width) {
    const text = Array.from(arrays[series.low], (v) => (Number.isFinite(v) ? v.toFixed(2) : ""));
    const side = (width - 190) / Math.sqrt(text.length); // 190 px: about the width of the names
    return { ...base, mode: "text", x: arrays[series.x], y: arrays[series.y], hoverinfo: "skip",
      text: text.map((t) => t.replace("-0.00", "0.00").replace("-", "−")),
      textfont: { size: Math.min(13, Math.max(7, side / 3)) } };
  }

  function pointTraces(series, base, colour, range, columns) {
    const x = arrays[series.x], y = arrays[series.y];
    if (!isLong(series))
      return [{ ...base, mode: "markers", x, y, marker: { color: colour, size: x.length > 160 ? 4 : 7 } }];
    if (isCoarse(series, range, columns))
      return [{ ...base, ...strokes(x, y, range), mode: "lines", line: { color: faded(colour, 0.7), width: 2 } }];
    const stroke = 2; // px: narrower than a dot, so that the dots of neighbouring columns touch
    const { dots, body } = cloud(x, y, range, columns / stroke);
    return [
      { ...base, ...body, mode: "lines", line: { color: faded(colour, 0.45), width: stroke },
        hoverinfo: "skip", showlegend: false },
      { ...base, ...dots, mode: "markers", marker: { color: faded(colour, 0.7), size: 3 } },
    ];
  }

  // A line that fills its panel with noise is drawn thinner.
  function widthOf(y) {
    let travel = 0, low = Infinity, high = -Infinity;
    for (let i = 1; i < y.length; ++i) {
      travel += Math.abs(y[i] - y[i - 1]) || 0;
      low = Math.min(low, y[i]);
      high = Math.max(high, y[i]);
    }
    return travel > 30 * (high - low) ? 1 : 1.8;
  }

  // Triangles at the edge for the values beyond it, one on each side for every dozen pixels; each
  // shows the farthest of the values it stands for.
  function rimTraces(series, base, colour, panel, plot) {
    if (!panel.bulk || series.style !== "points") return [];
    const x = arrays[series.x], y = arrays[series.y], [low, high] = panel.shown;
    // A plot without a range is not against time, and its x may be in any order.
    const range = plot.range ?? [Math.min(...x), Math.max(...x)], farthest = new Map();
    for (let i = plot.range ? lowerBound(x, range[0]) : 0; i < x.length && x[i] <= range[1]; ++i) {
      if (!(y[i] > high || y[i] < low)) continue;
      const key = `${y[i] > high}${Math.floor(((x[i] - range[0]) / (range[1] - range[0])) * plot.width / 12)}`;
      const before = farthest.get(key);
      if (before === undefined || Math.abs(y[i]) > Math.abs(y[before])) farthest.set(key, i);
    }
    return [true, false].map((above) => {
      const marks = [...farthest.values()].filter((i) => (y[i] > high) === above);
      return { ...base, mode: "markers", showlegend: false, cliponaxis: false,
        x: marks.map((i) => x[i]), y: marks.map(() => (above ? high : low)),
        text: marks.map((i) => `${y[i].toPrecision(4)} at ${x[i].toPrecision(6)}`), hoverinfo: "text",
        marker: { color: colour, size: 9, symbol: above ? "triangle-up" : "triangle-down" } };
    });
  }

  // The range of a panel whose y axis is set by the bulk of its values, for the part now in view.
  function shownRange(panel, plot) {
    const [least, greatest] = panel.bulk;
    let low = Infinity, high = -Infinity;
    for (const { x: xs, y: ys } of panel.series) {
      const x = arrays[xs], y = arrays[ys], [from, to] = plot.range ?? [-Infinity, Infinity];
      for (let i = lowerBound(x, from); i < x.length && x[i] <= to; ++i) {
        if (!(y[i] >= least && y[i] <= greatest)) continue;
        low = Math.min(low, y[i]);
        high = Math.max(high, y[i]);
      }
    }
    if (!(low < high)) return [least, greatest];
    const room = 0.05 * (high - low);
    return [low - room, high + room];
  }

  function tracesOf(series, panel, plot, look) {
    const k = panel.number;
    const base = { type: "scatter", name: series.label, xaxis: "x", yaxis: `y${k || ""}`,
      legend: `legend${k || ""}`, legendgroup: series.label, showlegend: panel.series.length > 1 };
    const colour = look.ink[series.colour % look.ink.length];
    const columns = plot.width - margin.l - margin.r;
    if (series.style === "band") return bandTraces(series, base, colour, plot.range, columns);
    if (series.style === "bars") return [barTrace(series, base, colour)];
    if (series.style === "cells") return [cellTrace(series, base, plot.width)];
    if (series.style === "points")
      return [...pointTraces(series, base, colour, plot.range, columns),
        ...rimTraces(series, base, colour, panel, plot)];
    const x = arrays[series.x], y = arrays[series.y];
    const drawn = isLong(series) ? extremes(x, y, plot.range, columns) : { x, y };
    const lines = panel.series.filter((s) => s.style === "line");
    return [{ ...base, ...drawn, mode: "lines",
      line: { color: colour, width: widthOf(drawn.y), dash: dashes[lines.indexOf(series) % dashes.length] } }];
  }

  // ---- the layout

  function axisLook(axis, look) {
    const common = { gridcolor: look.grid, tickcolor: look.text, zeroline: false, ticks: "outside", ticklen: 4 };
    if (axis.names.length)
      return { ...common, tickvals: axis.names.map((_, i) => i), ticktext: axis.names, showgrid: false,
        range: [-0.5, axis.names.length - 0.5], automargin: true };
    return { ...common, type: axis.logarithmic ? "log" : "linear", exponentformat: "power",
      minexponent: 4, nticks: 7, hoverformat: ".6g" };
  }

  function cellShapes(panel, look) {
    return panel.series.filter((s) => s.style === "cells").flatMap((s) =>
      Array.from(arrays[s.low], (v, i) => ({
        type: "rect", layer: "below", line: { width: 0 },
        x0: arrays[s.x][i] - 0.5, x1: arrays[s.x][i] + 0.5,
        y0: arrays[s.y][i] - 0.5, y1: arrays[s.y][i] + 0.5,
        fillcolor: faded(look.ink[v < 0 ? 1 : 0], 0.8 * Math.min(1, Math.abs(v) || 0)),
      })));
  }

  // About how many rows a legend takes: if the entries do not fit into one row, plotly makes them all
  // as wide as the widest.
  function legendRows(panel, width) {
    if (panel.series.length < 2) return 0;
    const pen = document.createElement("canvas").getContext("2d");
    pen.font = "12px system-ui, sans-serif"; // as the legend below
    const widths = panel.series.map((s) => 50 + pen.measureText(s.label).width); // 50: the sample
    const room = width - margin.l - margin.r;
    if (widths.reduce((a, b) => a + b) < room) return 1;
    return Math.ceil(widths.length / Math.max(1, Math.floor((room + 12) / Math.max(...widths))));
  }

  // The lines run through all panels; their numbers are in the first.
  function markersOf(plot, look, layout) {
    const logarithmic = plot.panels[0].x.logarithmic;
    const [from, to] = plot.range ?? [-Infinity, Infinity];
    let end = -Infinity, row = 0; // numbers that would touch are put in different rows
    for (const { x, label } of plot.panels[0].markers) {
      if (x < from || x > to) continue; // its number would be outside the drawing
      const at = ((x - from) / (to - from)) * (plot.width - margin.l - margin.r);
      row = at < end ? (row + 1) % 4 : 0;
      end = at + 10 + 8 * label.length;
      layout.shapes.push({ type: "line", x0: x, x1: x, yref: "paper", y0: 0, y1: 1, layer: "above",
        line: { color: look.text, width: 1, dash: "dot" } });
      layout.annotations.push({ x: logarithmic ? Math.log10(x) : x, yref: "paper", y: 1, text: label,
        yanchor: "top", yshift: -18 * row, showarrow: false, bgcolor: look.paper, font: { weight: 600 } });
    }
  }

  function strokeNote(panel, plot) {
    const coarse = panel.series.find((s) =>
      isLong(s) && isCoarse(s, plot.range, plot.width - margin.l - margin.r));
    return coarse ? ` – each stroke: lowest to highest of ${coarse.stretch}` : "";
  }

  function layoutOf(plot, look) {
    const count = plot.panels.length;
    const rows = Math.max(...plot.panels.map((panel) => legendRows(panel, plot.width)));
    const gap = titleRow + legendHeight(rows) + 8; // above each panel, for its title and legend
    const inner = count * panelHeight + (count - 1) * gap;
    const narrow = plot.width < 600;
    const layout = {
      width: plot.width, height: inner + margin.t + gap + margin.b, margin: { ...margin, t: margin.t + gap },
      paper_bgcolor: look.paper, plot_bgcolor: look.paper, uirevision: "kept",
      font: { color: look.text, family: "system-ui, sans-serif", size: 13 },
      hovermode: "closest", dragmode: narrow ? false : "zoom", shapes: [], annotations: [],
      hoverlabel: { bgcolor: look.paper, font: { color: look.text } },
      modebar: { bgcolor: "transparent", color: look.text, activecolor: look.ink[0] },
      xaxis: { ...axisLook(plot.panels[0].x, look), title: { text: plot.panels[0].x.title, font: { size: 13 } },
        anchor: `y${count > 1 ? count : ""}` },
    };
    if (plot.range) layout.xaxis.range = [...plot.range];
    if (narrow && plot.panels[0].x.logarithmic) layout.xaxis.dtick = 1; // there is only room for decades
    plot.panels.forEach((panel, i) => {
      const k = panel.number, top = 1 - (i * (panelHeight + gap)) / inner;
      layout[`yaxis${k || ""}`] = { ...axisLook(panel.y, look), fixedrange: Boolean(plot.range),
        domain: [Math.max(0, top - panelHeight / inner), top],
        ...(panel.bulk ? { range: [...panel.shown] } : {}) };
      layout[`legend${k || ""}`] = { orientation: "h", x: 0, xanchor: "left", y: top, yanchor: "bottom",
        bgcolor: "transparent", font: { size: 12 } };
      const above = 4 + legendHeight(legendRows(panel, plot.width));
      if (panel.y.title)
        layout.annotations.push({ text: `<b>${panel.y.title}</b>${strokeNote(panel, plot)}`, xref: "paper", x: 0, yref: "paper",
          y: top, xanchor: "left", yanchor: "bottom", yshift: above, showarrow: false });
      layout.shapes.push(...cellShapes(panel, look), { type: "rect", xref: "paper", x0: 0, x1: 1,
        yref: "paper", y0: top - panelHeight / inner, y1: top, line: { color: look.text, width: 1 } });
    });
    markersOf(plot, look, layout);
    return layout;
  }

  // ---- drawing, zooming

  const config = { displaylogo: false, doubleClick: "reset", displayModeBar: true,
    // The buttons are listed, because by default plotly also offers to send the figure to a server.
    modeBarButtons: [["zoom2d", "pan2d"], ["zoomIn2d", "zoomOut2d", "resetScale2d"]] };

  async function draw(plot) {
    const look = theme();
    plot.width = plot.place.clientWidth;
    for (const panel of plot.panels) if (panel.bulk) panel.shown = shownRange(panel, plot);
    const traces = plot.panels.flatMap((panel) =>
      panel.series.flatMap((series) => tracesOf(series, panel, plot, look)));
    await Plotly.react(plot.place, traces, layoutOf(plot, look), config);
    // A screen reader reads the plot's name and caption; a mark for each beat would be of no use to it.
    plot.place.firstElementChild?.setAttribute("aria-hidden", "true");
  }

  // The range of a plot against time, any part of which can be redrawn; null for other plots.
  function wholeRange(plot) {
    const long = plot.panels.some((panel) => panel.series.some(isLong));
    const axis = plot.panels[0].x;
    if (axis.logarithmic || axis.names.length || !(long || axis.title.startsWith("time"))) return null;
    let low = Infinity, high = -Infinity;
    for (const panel of plot.panels)
      for (const { x } of panel.series) {
        low = Math.min(low, arrays[x][0]);
        high = Math.max(high, arrays[x][arrays[x].length - 1]);
      }
    return low < high ? [low, high] : null;
  }

  const plots = data.plots.map((plot, i) => ({ ...plot, place: document.querySelectorAll(".live")[i] }));
  let timed = [];      // the plots against time
  let whole = [0, 1]; // the common range of the plots against time

  function zoom([low, high]) {
    const [least, greatest] = whole;
    const length = Math.min(high - low, greatest - least);
    const from = Math.min(Math.max(low, least), greatest - length);
    for (const plot of timed) {
      plot.range = [from, from + length];
      if (plot.isDrawn) draw(plot);
    }
  }

  function onRelayout(plot, event) {
    if (event["xaxis.autorange"]) return zoom(whole);
    const low = event["xaxis.range[0]"] ?? event["xaxis.range"]?.[0];
    const high = event["xaxis.range[1]"] ?? event["xaxis.range"]?.[1];
    if (low === undefined || (low === plot.range[0] && high === plot.range[1])) return;
    zoom([low, high]);
  }

  function onKey(plot, event) {
    if (event.ctrlKey || event.altKey || event.metaKey || !plot.range) return;
    const [low, high] = plot.range, length = high - low;
    const to = { "+": [low + length / 4, high - length / 4], "=": [low + length / 4, high - length / 4],
      "-": [low - length / 2, high + length / 2], "0": whole,
      ArrowLeft: [low - length / 4, high - length / 4],
      ArrowRight: [low + length / 4, high + length / 4] }[event.key];
    if (!to) return;
    event.preventDefault();
    zoom(to);
  }

  // ---- saving

  const fileName = (plot) => plot.panels[0].title.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/-$/, "");

  function download(name, text, type) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  }

  function save(plot, format) {
    if (format === "csv") return download(`${fileName(plot)}.csv`, csvOf(plot.panels, arrays), "text/csv");
    return Plotly.downloadImage(plot.place, { format, filename: fileName(plot), width: plot.width,
      height: plot.place.clientHeight, scale: format === "png" ? 2 : 1 });
  }

  // The element that contains the place of a plot and the static drawings that it replaces.
  const holderOf = (plot) => plot.place.parentElement;
  const pause = () => new Promise((done) => setTimeout(done));

  async function drawFirst(plot, resized) {
    holderOf(plot).classList.add("drawn"); // first, so that the place has a width
    await draw(plot);
    plot.isDrawn = true;
    resized.observe(plot.place);
    for (const button of plot.place.nextElementSibling.querySelectorAll("button"))
      button.addEventListener("click", () => save(plot, button.dataset.format));
    if (!plot.range) return;
    plot.place.on("plotly_relayout", (event) => onRelayout(plot, event));
    plot.place.addEventListener("keydown", (event) => onKey(plot, event));
  }

  // The page opens with its static drawings. They are replaced one by one, with pauses, so that the
  // page responds meanwhile.
  async function start() {
    if (document.readyState !== "complete") await new Promise((done) => addEventListener("load", done));
    timed = plots.filter((plot) => (plot.range = wholeRange(plot)));
    const low = Math.min(...timed.map((plot) => plot.range[0]));
    const high = Math.max(...timed.map((plot) => plot.range[1]));
    const room = 0.01 * (high - low); // so that dots at the edge are not cut
    whole = [low - room, high + room];
    const resized = new ResizeObserver((entries) => {
      for (const plot of plots)
        if (entries.some((e) => e.target === plot.place) && plot.place.clientWidth > 0
            && plot.place.clientWidth !== plot.width) draw(plot);
    });
    for (const plot of plots) {
      plot.panels.forEach((panel, i) => { panel.number = i === 0 ? 0 : i + 1; });
      if (plot.range) plot.range = whole;
    }
    document.querySelectorAll(".hint").forEach((hint) => hint.classList.add("drawn"));
    for (const plot of plots) {
      await pause();
      await drawFirst(plot, resized);
    }
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => plots.forEach(draw));
    document.getElementById("js-plotly-tester")?.setAttribute("aria-hidden", "true");
    document.documentElement.dataset.figures = plots.length; // all are drawn
  }

  start().catch((error) => {
    // Show the static drawings again.
    document.querySelectorAll(".drawn").forEach((holder) => holder.classList.remove("drawn"));
    console.error(error);
  });
})();
