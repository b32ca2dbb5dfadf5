// Unpacks the numbers of a page's figures, and thins a long series to the width of its drawing.
"use strict";
const goingrateSeries = (() => {
  const packedBlock = 1024; // as in packed.hpp

  // A block is its least value and its step (two doubles), then 16 bits per value; 65535 marks a
  // missing value.
  function unpack({ count, packed }) {
    const text = atob(packed);
    const view = new DataView(Uint8Array.from(text, (c) => c.charCodeAt(0)).buffer);
    const values = new Float64Array(count);
    let at = 0;
    for (let begin = 0; begin < count; begin += packedBlock) {
      const least = view.getFloat64(at, true), step = view.getFloat64(at + 8, true);
      at += 16;
      for (let i = begin; i < Math.min(count, begin + packedBlock); ++i, at += 2) {
        const number = view.getUint16(at, true);
        values[i] = number === 65535 ? NaN : least + step * number;
      }
    }
    return values;
  }

  // The first index whose x is not below `value`.
  function lowerBound(x, value) {
    let from = 0, to = x.length;
    while (from < to) {
      const middle = (from + to) >> 1;
      if (x[middle] < value) from = middle + 1;
      else to = middle;
    }
    return from;
  }

  // Calls see(from, to) with the range of indices in each column of pixels of [low, high], and with
  // one neighbour on either side, so that a line runs on to the edge.
  function forColumns(x, [low, high], columns, see) {
    const begin = Math.max(0, lowerBound(x, low) - 1);
    const end = Math.min(x.length, lowerBound(x, high) + 1);
    const column = (i) => Math.floor(((x[i] - low) / (high - low)) * columns);
    for (let i = begin; i < end;) {
      const first = i, here = column(i);
      while (i < end && column(i) === here) ++i;
      see(first, i);
    }
  }

  // The lowest and the highest value of each column, in the order in which they come.
  function extremes(x, y, range, columns) {
    const out = { x: [], y: [] };
    forColumns(x, range, columns, (from, to) => {
      let low = from, high = from;
      for (let i = from + 1; i < to; ++i) {
        if (Number.isNaN(y[low]) || y[i] < y[low]) low = i;
        if (Number.isNaN(y[high]) || y[i] > y[high]) high = i;
      }
      for (const i of low === high ? [low] : [Math.min(low, high), Math.max(low, high)]) {
        out.x.push(x[i]);
        out.y.push(y[i]);
      }
    });
    return out;
  }

  const visible = (x, [low, high]) => lowerBound(x, high) - lowerBound(x, low);

  // Each stretch as a stroke, because its two values as dots would look like two series.
  function strokes(x, y, range) {
    const body = { x: [], y: [] };
    const end = Math.min(x.length, lowerBound(x, range[1]) + 2);
    for (let i = Math.max(0, lowerBound(x, range[0]) - 2) & ~1; i + 1 < end; i += 2) {
      const middle = 0.5 * (x[i] + x[i + 1]);
      body.x.push(middle, middle, null);
      body.y.push(y[i], y[i + 1], null);
    }
    return body;
  }

  // A cloud: all dots if there is room; else the extremes of each column as dots, and a stroke over
  // its middle 80 %.
  function cloud(x, y, range, columns) {
    if (visible(x, range) <= 6 * columns) {
      const from = Math.max(0, lowerBound(x, range[0]) - 1), to = lowerBound(x, range[1]) + 1;
      return { dots: { x: x.slice(from, to), y: y.slice(from, to) }, body: { x: [], y: [] } };
    }
    const dots = extremes(x, y, range, columns), body = { x: [], y: [] };
    forColumns(x, range, columns, (from, to) => {
      const values = y.slice(from, to).filter(Number.isFinite).sort();
      if (values.length < 3) return;
      const last = values.length - 1, tenth = Math.floor(last / 10);
      body.x.push(x[from], x[from], null);
      body.y.push(values[tenth], values[last - tenth], null);
    });
    return { dots, body };
  }

  // The values of the panels as CSV; for a long log the lowest and highest value of each stretch.
  // Panels of one plot have the same x but different units, so the name of a panel gives its unit.
  function csvOf(panels, arrays) {
    const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
    const { x, y } = panels[0], joint = panels.length > 1;
    const inUnit = (word) => (y.unit && !joint ? `${word} (${y.unit})` : word);
    const heads = [x.title || "x", joint ? "value" : y.title || "y", inUnit("low"), inUnit("high")];
    const lines = [`panel,series,${heads.map(quoted).join(",")}`];
    for (const panel of panels)
      for (const series of panel.series) {
        const columns = ["x", "y", "low", "high"].map((key) => arrays[series[key]]);
        const names = `${quoted(joint ? panel.y.title : panel.title)},${quoted(series.label)}`;
        for (let i = 0; i < columns[0].length; ++i)
          lines.push(names + columns.map((c) => `,${c && Number.isFinite(c[i]) ? c[i] : ""}`).join(""));
      }
    return lines.join("\n") + "\n";
  }

  return { unpack, lowerBound, forColumns, extremes, visible, strokes, cloud, csvOf };
})();
