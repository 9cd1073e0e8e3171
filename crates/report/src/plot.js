// Replaces the static pictures of a page by charts that zoom, show values and hide series.
// Without scripts, and in print, the static pictures remain.
"use strict";
(() => {
  const root = document.documentElement;
  const figures = [...document.querySelectorAll("figure[data-chart]")];
  const plots = new Map();
  const groups = new Map();
  const columns = new Map();

  const colour = (name) => getComputedStyle(root).getPropertyValue(`--${name}`).trim();
  const seriesColour = (index) => colour(`series-${(index % 6) + 1}`);
  const number = (value) => (value == null ? "–" : String(Number(value.toPrecision(7))));

  /// Column of numbers; not-a-number becomes a gap.
  function column(id) {
    if (!columns.has(id)) {
      const element = document.getElementById(`column-${id}`);
      const text = atob(element.textContent);
      const bytes = Uint8Array.from(text, (c) => c.charCodeAt(0));
      const values = new (element.dataset.bytes === "8" ? Float64Array : Float32Array)(bytes.buffer);
      columns.set(id, values.some(Number.isNaN) ? Array.from(values, (v) => (v === v ? v : null)) : values);
    }
    return columns.get(id);
  }

  /// Values that a logarithmic axis can show.
  const positive = (values) => Array.from(values, (v) => (v > 0 ? v : null));

  /// Columns of all series with a common horizontal axis.
  function aligned(chart) {
    const tables = chart.series
      .filter((series) => series.style !== "shade")
      .map((series) => {
        const y = series.y.map(column).map((values) => (chart.logY ? positive(values) : values));
        return { id: series.x, table: [column(series.x), ...y] };
      });
    if (tables.every((table) => table.id === tables[0].id)) {
      return [tables[0].table[0], ...tables.flatMap((table) => table.table.slice(1))];
    }
    return uPlot.join(tables.map(({ table }) => table));
  }

  /// Label of a tick, with the digits that the distance of the ticks asks for.
  function tick(value, step) {
    if (value === 0) return "0";
    const size = Math.abs(value);
    if (size >= 1e6 || size < 1e-4) return value.toExponential().replace(/(\.\d\d)\d+/, "$1");
    return step ? value.toFixed(Math.min(9, Math.max(0, Math.ceil(-Math.log10(step) - 1e-9)))) : String(value);
  }

  function axis(label, isVertical, isLog) {
    return {
      label,
      labelSize: 22,
      stroke: colour("text"),
      values: (u, splits, index, space, step) =>
        splits.map((value) => (value == null ? "" : tick(value, isLog ? null : step))),
      grid: { stroke: colour("rule"), width: 1 },
      ticks: { stroke: colour("rule"), width: 1 },
      size: isVertical ? (u, values) => 18 + 7 * Math.max(3, ...(values || []).map((v) => v.length)) : 34,
    };
  }

  /// Drawn lines of uPlot for the series of a chart, and the filled bands between them.
  function lines(chart) {
    const out = [{ label: chart.x, value: (u, v) => number(v) }];
    const bands = [];
    chart.series.forEach((series, index) => {
      if (series.style === "shade") return;
      const stroke = seriesColour(index);
      const value = (u, v) => number(v);
      if (series.style === "area") {
        bands.push({ series: [out.length, out.length + 1], fill: `${stroke}55` });
        for (const end of ["highest", "lowest"]) {
          out.push({ label: `${series.name}, ${end}`, stroke: `${stroke}66`, value, points: { show: false } });
        }
        return;
      }
      const isPoints = series.style === "points";
      const isWide = series.style === "wide";
      out.push({
        label: series.name,
        stroke: isWide ? `${stroke}66` : stroke,
        width: isWide ? 5 : 1.5,
        value,
        ...(isPoints && { paths: () => null }),
        points: { show: isPoints || series.style === "both", size: 6, fill: stroke },
      });
    });
    return { series: out, bands };
  }

  /// Curve of a map: its points are not ascending, so uPlot's own path does not fit.
  function curve(style, stroke) {
    return (u, index) => {
      uPlot.orient(u, index, (series, xs, ys, scaleX, scaleY, toX, toY, left, top, width, height) => {
        const path = new Path2D();
        for (let i = 0; i < xs.length; i++) {
          if (xs[i] == null || ys[i] == null) continue;
          const x = toX(xs[i], scaleX, width, left);
          const y = toY(ys[i], scaleY, height, top);
          if (style === "points" || style === "both") path.rect(x - 2, y - 2, 4, 4);
          else path.lineTo(x, y);
        }
        u.ctx.save();
        u.ctx.beginPath();
        u.ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
        u.ctx.clip();
        u.ctx.strokeStyle = stroke;
        u.ctx.lineWidth = devicePixelRatio * (style === "wide" ? 4 : 1.2);
        u.ctx.stroke(path);
        u.ctx.restore();
      });
      return null;
    };
  }

  /// Span of a map's axis; with equal scales both have the same size around the same middle.
  function spans(chart) {
    const ends = ["x", "y"].map((key) => {
      let low = Infinity;
      let high = -Infinity;
      for (const series of chart.series) {
        for (const value of column(key === "x" ? series.x : series.y[0])) {
          if (value != null && value < low) low = value;
          if (value != null && value > high) high = value;
        }
      }
      const margin = 0.04 * (high - low || 1);
      return [low - margin, high + margin];
    });
    if (!chart.equal) return ends;
    const half = Math.max(...ends.map(([low, high]) => (high - low) / 2));
    return ends.map(([low, high]) => [(low + high) / 2 - half, (low + high) / 2 + half]);
  }

  function mapOptions(chart, readout) {
    const [x, y] = spans(chart);
    const range = (whole) => (u, low, high) => (low == null ? whole : [low, high]);
    const scale = (whole) => ({ time: false, auto: false, range: range(whole) });
    return {
      mode: 2,
      scales: { x: scale(x), y: scale(y) },
      series: [
        {},
        ...chart.series.map((series, index) => ({
          label: series.name,
          stroke: seriesColour(index),
          facets: [{ scale: "x" }, { scale: "y" }],
          paths: curve(series.style, seriesColour(index)),
        })),
      ],
      legend: { live: false },
      cursor: { drag: { x: true, y: true }, points: { show: false } },
      hooks: {
        setCursor: [
          (u) => {
            const { left, top } = u.cursor;
            const isInside = left >= 0 && top >= 0;
            const at = isInside ? [u.posToVal(left, "x"), u.posToVal(top, "y")] : [];
            readout.textContent = at.map((value) => value.toPrecision(4)).join(" | ");
          },
        ],
      },
      whole: { x, y },
    };
  }

  /// Grey stretches of the horizontal axis.
  function shades(chart) {
    return (u) => {
      u.ctx.fillStyle = `${colour("grey")}44`;
      for (const { from, to } of chart.series.filter((series) => series.style === "shade")) {
        const [left, right] = [u.valToPos(from, "x", true), u.valToPos(to, "x", true)];
        u.ctx.fillRect(left, u.bbox.top, right - left, u.bbox.height);
      }
    };
  }

  /// Ignores the changes of scale that uPlot reports until the next turn of the event loop.
  function pause(group) {
    group.isPaused = true;
    setTimeout(() => { group.isPaused = false; });
  }

  /// Shows the span of a chart's horizontal axis in all charts that have the same.
  function link({ group, u }) {
    if (!group || group.isPaused) return;
    const { min, max } = u.scales.x;
    group.range = { min, max };
    pause(group);
    for (const plot of group.plots) if (plot.u !== u) plot.u.setScale("x", group.range);
  }

  /// Shows all of the data again in all charts that have the same horizontal axis.
  function unlink({ group }) {
    if (!group) return;
    group.range = null;
    pause(group);
    for (const plot of group.plots) plot.u.setData(plot.u.data);
  }

  function lineOptions(chart, plot) {
    const { series, bands } = lines(chart);
    const scale = (isLog) => (isLog ? { distr: 3, time: false } : { time: false });
    return {
      scales: { x: scale(chart.logX), y: scale(chart.logY) },
      series,
      bands,
      cursor: {
        drag: { x: true, y: true, uni: 30 },
        sync: { key: chart.x, setSeries: false, scales: ["x", null] },
        bind: { dblclick: () => () => unlink(plot) },
      },
      hooks: {
        drawClear: [shades(chart)],
        setScale: [(u, key) => key === "x" && plot.u && link(plot)],
      },
    };
  }

  /// Width and height of a chart in its figure, with the written proportions.
  function size(figure, chart) {
    const width = Math.max(280, Math.min(figure.clientWidth, chart.size[0]));
    const height = Math.max(240, Math.round((chart.size[1] * width) / chart.size[0]));
    return { width, height };
  }

  function save(name, type, parts) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob(parts, { type }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  const fileName = (title) => title.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "");
  const cell = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);

  /// Visible points as CSV: one row a point of the horizontal axis; for a map one row a point.
  function csv({ chart, u }) {
    const { min, max } = u.scales.x;
    if (chart.kind === "map") {
      const rows = [["series", chart.x, chart.y].map(cell)];
      const { min: low, max: high } = u.scales.y;
      chart.series.forEach((series, s) => {
        if (!u.series[s + 1].show) return;
        column(series.x).forEach((x, i) => {
          const y = column(series.y[0])[i];
          if (x >= min && x <= max && y >= low && y <= high) rows.push([cell(series.name), x, y]);
        });
      });
      return rows.map((row) => row.join(",")).join("\n") + "\n";
    }
    const shown = u.series.map((series, i) => i).filter((i) => i === 0 || u.series[i].show);
    const head = shown.map((i) => cell(i === 0 ? chart.x : `${u.series[i].label}, ${chart.y}`));
    const rows = [head.join(",")];
    for (let i = 0; i < u.data[0].length; i++) {
      const x = u.data[0][i];
      if (x >= min && x <= max) rows.push(shown.map((s) => u.data[s][i] ?? "").join(","));
    }
    return rows.join("\n") + "\n";
  }

  /// Creates the chart of a figure in place of its picture.
  function create(figure) {
    const chart = JSON.parse(figure.dataset.chart);
    const old = plots.get(figure);
    if (old) old.u.destroy();
    const holder = old ? old.holder : document.createElement("div");
    const readout = old ? old.readout : document.createElement("output");
    const isLinked = chart.kind === "lines";
    if (isLinked && !groups.has(chart.x)) groups.set(chart.x, { plots: new Set(), range: null });
    const plot = { chart, holder, readout, group: isLinked ? groups.get(chart.x) : null };
    if (plot.group) pause(plot.group);
    if (!old) {
      holder.className = "plot";
      const tools = document.createElement("div");
      tools.className = "tools";
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = "Save visible values (CSV)";
      button.onclick = () => save(`${fileName(chart.title)}.csv`, "text/csv", [csv(plots.get(figure))]);
      tools.append(button, readout);
      figure.querySelector("svg").after(holder, tools);
      figure.classList.add("live");
    }
    const isMap = chart.kind === "map";
    const options = {
      title: chart.title,
      ...size(figure, chart),
      axes: [axis(chart.x, false, chart.logX), axis(chart.y, true, chart.logY)],
      ...(isMap ? mapOptions(chart, readout) : lineOptions(chart, plot)),
    };
    const data = isMap
      ? [null, ...chart.series.map((series) => [column(series.x), column(series.y[0])])]
      : aligned(chart);
    plot.u = new uPlot(options, data, holder);
    if (isMap) {
      const whole = () => ["x", "y"].forEach((key) => {
        const [min, max] = options.whole[key];
        plot.u.setScale(key, { min, max });
      });
      whole();
      plot.u.over.addEventListener("dblclick", whole);
    }
    if (old && old.group) old.group.plots.delete(old);
    if (plot.group) {
      plot.group.plots.add(plot);
      if (plot.group.range) plot.u.setScale("x", plot.group.range);
    }
    plots.set(figure, plot);
    root.dataset.drawn = plots.size;
  }

  function attempt(figure) {
    try {
      create(figure);
    } catch (error) {
      root.dataset.failed = String(error);
      figure.classList.remove("live");
      console.error(error);
    }
  }

  /// Checksum of a file in an archive (CRC-32).
  function checksum(bytes) {
    let sum = -1;
    for (const byte of bytes) {
      sum ^= byte;
      for (let bit = 0; bit < 8; bit++) sum = (sum >>> 1) ^ (0xedb88320 & -(sum & 1));
    }
    return ~sum;
  }

  /// Archive of files without compression (ZIP).
  function archive(files) {
    const words = (...fields) => {
      const view = new DataView(new ArrayBuffer(fields.reduce((sum, [size]) => sum + size, 0)));
      let at = 0;
      for (const [size, value] of fields) {
        if (size === 2) view.setUint16(at, value, true);
        else view.setUint32(at, value, true);
        at += size;
      }
      return new Uint8Array(view.buffer);
    };
    const encoder = new TextEncoder();
    const [parts, index] = [[], []];
    let offset = 0;
    for (const { name, text } of files) {
      const [path, bytes] = [encoder.encode(name), encoder.encode(text)];
      const length = bytes.length;
      // Version, names in UTF-8, no compression, time and date of 1980.
      const about = [[2, 20], [2, 0x800], [2, 0], [2, 0], [2, 0x21], [4, checksum(bytes)], [4, length],
        [4, length], [2, path.length], [2, 0]];
      const head = words([4, 0x04034b50], ...about);
      index.push(words([4, 0x02014b50], [2, 20], ...about, [2, 0], [2, 0], [2, 0], [4, 0], [4, offset]), path);
      parts.push(head, path, bytes);
      offset += head.length + path.length + length;
    }
    const indexLength = index.reduce((sum, part) => sum + part.length, 0);
    const end = words([4, 0x06054b50], [2, 0], [2, 0], [2, files.length], [2, files.length],
      [4, indexLength], [4, offset], [2, 0]);
    return [...parts, ...index, end];
  }

  function saveAll() {
    const files = [...document.querySelectorAll("figure svg")].map((svg, i) => {
      const figure = svg.closest("figure");
      const title = figure.dataset.chart ? JSON.parse(figure.dataset.chart).title : "picture";
      const name = `${String(i + 1).padStart(2, "0")}-${fileName(title)}.svg`;
      return { name, text: new XMLSerializer().serializeToString(svg) };
    });
    save(`${fileName(document.title)}.zip`, "application/zip", archive(files));
  }

  const all = document.getElementById("save-all");
  if (all) {
    all.hidden = false;
    all.onclick = saveAll;
  }
  const redraw = () => [...plots.keys()].forEach(attempt);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  const resized = new ResizeObserver((entries) => {
    for (const { target } of entries) {
      const plot = plots.get(target);
      if (!plot) continue;
      const { width, height } = size(target, plot.chart);
      if (width !== plot.u.width) plot.u.setSize({ width, height });
    }
  });
  // A chart is created when it comes near the window, so a long page opens at once.
  const near = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) {
      if (!isIntersecting || plots.has(target)) continue;
      near.unobserve(target);
      attempt(target);
      resized.observe(target);
    }
  }, { rootMargin: "400px" });
  figures.forEach((figure) => near.observe(figure));
})();
