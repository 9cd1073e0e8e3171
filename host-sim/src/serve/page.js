// Page of a live run: receives the events of the server and draws them.
"use strict";
(() => {
  const root = document.documentElement;
  const element = (id) => document.getElementById(id);
  const colour = (name) => getComputedStyle(root).getPropertyValue(`--${name}`).trim();

  /// Rows of the table of impacts; the totals count all.
  const MAX_ROWS = 500;
  /// Points of the orbit.
  const TRAIL = 2000;

  let run;
  let x, lower, upper, smallest, largest;
  let orbit;
  let flagged;
  let impacts;
  let impactPeak, peak, last;
  let plot = null;
  let whole = true;

  function reset(start) {
    run = start;
    [x, lower, upper, smallest, largest, orbit, impacts] = [[], [], [], [], [], [], []];
    flagged = new Map();
    [impactPeak, peak, last] = [0, 0, null];
    element("title").textContent = start.title;
    document.title = `${start.title} – live run`;
    element("gap").hidden = true;
    element("impacts").tBodies[0].replaceChildren();
    element("orbit-caption").textContent = `Journal centre in the bearing, y to the right, z up. Circle: `
      + `the clearance of ${(start.clearance_nm * 1e-3).toFixed(0)} µm. Recent points are drawn stronger.`;
    whole = true;
    createPlot();
  }

  function showState(state, text) {
    root.dataset.state = state;
    element("state").textContent = text;
  }

  /// Span of the vertical axis over the visible blocks: that of the forces, not of the band, which is
  /// wide while little is known.
  function forceRange(u) {
    const { min, max } = u.scales.x;
    let high = 0;
    for (let i = 0; i < x.length; i++) {
      if (x[i] >= min && x[i] <= max && largest[i] > high) high = largest[i];
    }
    return [-0.04 * (high || 1), 1.12 * (high || 1)];
  }

  function drawPeaks(u) {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.strokeStyle = colour("series-2");
    ctx.lineWidth = 1.5 * devicePixelRatio;
    for (const impact of impacts) {
      ctx.beginPath();
      const [left, top] = [u.valToPos(impact.peak_us * 1e-6, "x", true), u.valToPos(impact.peak_force_n, "y", true)];
      ctx.arc(left, top, 4 * devicePixelRatio, 0, 2 * Math.PI);
      ctx.stroke();
    }
    ctx.restore();
  }

  const plotSize = () => {
    const width = Math.max(200, element("force").clientWidth);
    return { width, height: Math.min(420, Math.max(240, Math.round(0.4 * width))) };
  };

  function createPlot() {
    const range = plot && !whole ? { min: plot.scales.x.min, max: plot.scales.x.max } : null;
    if (plot) plot.destroy();
    const [force, band] = [colour("series-1"), colour("series-6")];
    const value = (u, v) => (v == null ? "–" : `${v.toFixed(1)} N`);
    const axis = { stroke: colour("text"), grid: { stroke: colour("rule"), width: 1 }, ticks: { stroke: colour("rule"), width: 1 } };
    const edge = (label) => ({ label, stroke: `${band}99`, width: 1, value, points: { show: false } });
    const options = {
      ...plotSize(),
      scales: {
        x: { time: false, range: (u, min, max) => (whole ? [0, run.duration_s] : [min, max]) },
        y: { range: forceRange },
      },
      axes: [
        { ...axis, label: "time, s", labelSize: 22, size: 34 },
        { ...axis, label: "force, N", labelSize: 22, size: 62 },
      ],
      series: [
        { label: "time", value: (u, v) => (v == null ? "–" : `${v.toFixed(4)} s`) },
        edge("upper edge, +2 sd"),
        edge("lower edge, −2 sd"),
        { label: "largest", stroke: force, width: 1.5, value, points: { show: false } },
        { label: "smallest", stroke: force, width: 1.5, value, points: { show: false } },
      ],
      bands: [
        { series: [1, 2], fill: `${band}55` },
        { series: [3, 4], fill: force },
      ],
      hooks: {
        draw: [drawPeaks],
        setSelect: [(u) => { whole = u.select.width <= 0; }],
      },
    };
    const holder = document.createElement("div");
    element("force").prepend(holder);
    plot = new uPlot(options, [x, upper, lower, largest, smallest], holder);
    plot.over.addEventListener("dblclick", () => { whole = true; schedule(); });
    if (range) plot.setScale("x", range);
  }

  function addBlocks(blocks) {
    for (let i = 0; i < blocks.samples.length; i++) {
      const time = 0.5e-6 * (blocks.first_us[i] + blocks.last_us[i]);
      x.push(time);
      lower.push(blocks.lower_n[i]);
      upper.push(blocks.upper_n[i]);
      smallest.push(blocks.min_force_n[i]);
      largest.push(blocks.max_force_n[i]);
      if (blocks.max_force_n[i] > peak) peak = blocks.max_force_n[i];
      orbit.push([blocks.outermost_y_nm[i], blocks.outermost_z_nm[i]], [blocks.journal_y_nm[i], blocks.journal_z_nm[i]]);
      for (const { bit, name } of run.flags) {
        if ((blocks.flags[i] & bit) === 0) continue;
        flagged.set(name, { bit, count: (flagged.get(name)?.count ?? 0) + 1, time });
      }
      last = {
        us: blocks.last_us[i],
        force: blocks.force_n[i],
        torque: blocks.friction_torque_nm[i],
        flags: blocks.flags[i],
      };
    }
    if (orbit.length > 2 * TRAIL) orbit.splice(0, orbit.length - TRAIL);
  }

  /// Names of the flags in a word of bits.
  const flagNames = (bits) => run.flags.filter(({ bit }) => (bits & bit) !== 0).map(({ name }) => name);

  function addImpact(impact) {
    impacts.push(impact);
    if (impact.peak_force_n > impactPeak) impactPeak = impact.peak_force_n;
    const number = (value, digits) => (value == null ? "–" : value.toFixed(digits));
    const cells = [
      String(impact.number),
      number(impact.onset_us * 1e-6, 4),
      number(impact.peak_force_n, 0),
      number(impact.peak_force_sd_n, 0),
      number(impact.duration_us * 1e-3, 2),
      number(impact.approach_speed_m_s, 4),
      impact.end === "separation" ? number(impact.separation_speed_m_s, 4) : "–",
      number(impact.energy_lost_j, 3),
      number(impact.speed_ratio, 2),
      impact.end,
      flagNames(impact.flags).join(", ") || "none",
    ];
    const row = element("impacts").tBodies[0].insertRow(0);
    cells.forEach((text, i) => {
      const cell = row.insertCell();
      cell.textContent = text;
      if (i < 9) cell.className = "n";
    });
    const { rows } = element("impacts").tBodies[0];
    if (rows.length > MAX_ROWS) rows[MAX_ROWS].remove();
  }

  function showNumbers() {
    const seconds = last ? last.us * 1e-6 : 0;
    element("time").textContent = `${seconds.toFixed(3)} of ${run.duration_s.toFixed(2)} s`;
    if (last) {
      element("force-now").textContent = `${last.force == null ? "–" : last.force.toFixed(0)} N`;
      element("torque-now").textContent = `${last.torque == null ? "–" : last.torque.toFixed(1)} N m`;
    }
    element("force-max").textContent = `${peak.toFixed(0)} N`;
    const shown = Math.min(impacts.length, MAX_ROWS);
    const rest = shown < impacts.length ? `; the last ${shown} are shown` : "";
    element("impacts").hidden = impacts.length === 0;
    element("impacts-note").textContent = impacts.length === 0
      ? "none so far"
      : `${impacts.length} so far, largest peak ${impactPeak.toFixed(0)} N; the last one first${rest}`;
  }

  function showFlags() {
    if (flagged.size === 0) return;
    const items = [...flagged].map(([name, { bit, count, time }]) => {
      const item = document.createElement("li");
      item.textContent = `${name}: ${count} ${count === 1 ? "block" : "blocks"}, last at ${time.toFixed(3)} s`;
      if ((last.flags & bit) !== 0) item.className = "active";
      return item;
    });
    element("flags").replaceChildren(...items);
    element("flags-note").textContent = `Over ${x.length} blocks of ${run.block_samples} samples. Bold: in the last block.`;
  }

  function drawOrbit() {
    const canvas = element("orbit");
    const side = Math.max(120, canvas.clientWidth) * devicePixelRatio;
    if (canvas.width !== Math.round(side)) canvas.width = canvas.height = Math.round(side);
    const context = canvas.getContext("2d");
    const scale = side / (2.5 * Math.max(1, run.clearance_nm));
    const place = ([y, z]) => [side / 2 + y * scale, side / 2 - z * scale];
    context.clearRect(0, 0, side, side);
    context.lineWidth = devicePixelRatio;
    context.strokeStyle = colour("rule");
    context.strokeRect(0.5, 0.5, side - 1, side - 1);
    context.beginPath();
    for (const [from, to] of [[[0, 0.5], [1, 0.5]], [[0.5, 0], [0.5, 1]]]) {
      context.moveTo(from[0] * side, from[1] * side);
      context.lineTo(to[0] * side, to[1] * side);
    }
    context.stroke();
    context.strokeStyle = colour("grey");
    context.lineWidth = 1.5 * devicePixelRatio;
    context.beginPath();
    context.arc(side / 2, side / 2, run.clearance_nm * scale, 0, 2 * Math.PI);
    context.stroke();
    context.fillStyle = colour("quiet");
    context.font = `${13 * devicePixelRatio}px system-ui, sans-serif`;
    context.fillText("y", side - 14 * devicePixelRatio, side / 2 - 6 * devicePixelRatio);
    context.fillText("z", side / 2 + 6 * devicePixelRatio, 16 * devicePixelRatio);
    context.strokeStyle = colour("series-1");
    const half = Math.max(1, orbit.length - TRAIL / 4);
    for (const [from, to, alpha] of [[0, half, 0.5], [half - 1, orbit.length, 1]]) {
      context.globalAlpha = alpha;
      context.beginPath();
      for (let i = from; i < to; i++) context.lineTo(...place(orbit[i]));
      context.stroke();
    }
    context.globalAlpha = 1;
    if (orbit.length === 0) return;
    context.fillStyle = colour("series-2");
    context.beginPath();
    context.arc(...place(orbit[orbit.length - 1]), 5 * devicePixelRatio, 0, 2 * Math.PI);
    context.fill();
  }

  let isScheduled = false;
  let busyUntil = 0;

  /// Draws soon; the longer a picture takes, the fewer are drawn.
  function schedule() {
    if (isScheduled || !run) return;
    isScheduled = true;
    setTimeout(() => {
      isScheduled = false;
      const began = performance.now();
      draw();
      const ended = performance.now();
      busyUntil = ended + Math.max(30, 2 * (ended - began));
    }, Math.max(0, busyUntil - performance.now()));
  }

  function draw() {
    try {
      showNumbers();
      showFlags();
      const { min, max } = plot.scales.x;
      plot.batch(() => {
        plot.setData([x, upper, lower, largest, smallest], false);
        plot.setScale("x", whole ? { min: 0, max: run.duration_s } : { min, max });
      });
      drawOrbit();
      root.dataset.blocks = x.length;
      root.dataset.impacts = impacts.length;
      root.dataset.peak = peak;
    } catch (error) {
      root.dataset.error = String(error);
      console.error(error);
    }
  }

  let missing = 0;

  // A browser tries again after a lost connection, but not after a refusal, such as that of a
  // server whose connections are all taken. A new source begins with `start`, which resets the page.
  function connect() {
    const source = new EventSource(`events${location.search}`);
    source.onopen = () => {
      showState("receiving", run ? "receiving" : "connected; the run is being prepared");
    };
    source.onerror = () => {
      if (source.readyState === EventSource.CLOSED) {
        showState("failed", "the server refused the connection (is the token in the address?); trying again");
        setTimeout(connect, 3000);
      } else {
        showState("reconnecting", "the connection is lost; trying again");
      }
    };
    source.onmessage = ({ data }) => {
      const event = JSON.parse(data);
      if (event.event === "start") {
        reset(event);
        missing = 0;
        element("gap").hidden = true;
      }
      if (event.event === "blocks") addBlocks(event);
      if (event.event === "impact") addImpact(event);
      if (event.event === "gap") {
        missing += event.missing_events;
        element("gap").textContent = `${missing} events are missing: the server no longer has them.`;
        element("gap").hidden = false;
      }
      if (event.event === "end") {
        source.close();
        if (event.error == null) showState("complete", "the run is complete; everything was received");
        else showState("failed", `the run failed: ${event.error}`);
      } else {
        showState("receiving", "receiving");
      }
      schedule();
    };
  }
  connect();

  new ResizeObserver(() => {
    if (plot && plot.width !== plotSize().width) plot.setSize(plotSize());
    schedule();
  }).observe(element("force"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    if (run) createPlot();
    schedule();
  });
})();
