// A plot for each chosen signal, all over one range; a line shows the page's cursor, a click moves it there.
// Drawn by uPlot: with the demo's data and eight plots it was there in 0.3 s where Bokeh took 1.1 s, the cursor moved
// in 17 ms (a frame) instead of 39 ms, and its script has 51 kB instead of 1.27 MB.
(() => {
  const { traces, labels, signals, first, drawn } = loomfmu.data("plots"), main = traces[drawn], DEGREE = Math.PI / 180, TURN = 2 * Math.PI;
  const ROLES = ["--blue", "--red", "--green", "--purple", "--orange", "--ink"];
  const DASHES = [[], [8, 4], [2, 3], [10, 3, 2, 3], [14, 5], [5, 2, 1, 2, 1, 2]], HEIGHT = 190, PAPER = 680, BUCKETS = 600;
  const home = document.getElementById("plots-drawn"), choice = document.getElementById("plots-choice");
  const boxes = [...choice.querySelectorAll("input[type=checkbox]")], plots = new Map();
  const unpacked = text => new Float32Array(Uint8Array.from(atob(text), letter => letter.charCodeAt(0)).buffer);
  let over = loomfmu.turns ? "angle" : "time", range = null, setting = 0, printing = false;

  for (const trace of traces) for (const key of ["positions", "times"]) trace[key] = unpacked(trace[key]);
  const later = loomfmu.live ? loomfmu.whenSeen : (_, draw) => draw; // a run redraws what is in sight
  // a curve for each trace: positions and values; a page that runs its scene has others
  let curves = name => signals[name].curves.map(curve => curve && curve.map(unpacked));

  // ---- from positions, angles [rad] or times [s], to what the axis shows: degrees or seconds; and back

  const shown = (trace, position) => over === "angle" ? position / DEGREE
    : trace.turns ? loomfmu.interpolate(trace.positions, trace.times, position) : position;
  const placed = x => over === "angle" ? x * DEGREE
    : main.turns ? loomfmu.interpolate(main.times, main.positions, x) : x;
  const even = x => Number(x.toPrecision(12)); // without rounding, so that the tick at the end is drawn
  const whole = () => [loomfmu.first, loomfmu.last].map(position => even(shown(main, position)));

  function tables(name) {
    return curves(name).map((curve, number) => {
      const trace = traces[number];
      if (!curve || (over === "angle" && !trace.turns)) return [[], []];
      const along = Array.from(curve[0], position => shown(trace, position));
      return [along, Array.from(curve[1], value => Number.isNaN(value) ? null : value)];
    });
  }

  // ---- one plot

  const root = document.documentElement;
  const colour = role => getComputedStyle(root).getPropertyValue(role).trim();

  function axis(label, more) {
    const grid = { stroke: () => colour("--line"), width: 1 };
    return { label, labelSize: 20, labelFont: "12px system-ui, sans-serif", font: "12px system-ui, sans-serif",
             stroke: () => colour("--ink"), grid, ticks: { ...grid, size: 5 }, ...more };
  }

  /* The part of a range of values that shows how far they are from bounds: as `around` of traces/plotting.py. */
  function around(low, high, bounds) {
    const REACH = 10, LEAST = 0.1, known = bounds.filter(({ value, worst }) => value !== null && Number.isFinite(worst));
    const limits = known.map(({ value }) => value);
    const ends = known.map(({ value, worst, sense }) =>
      value + sense * REACH * Math.max(Math.abs(worst - value), LEAST * Math.abs(value)));
    if (known.some(({ sense }) => sense > 0)) high = Math.min(high, Math.max(...ends, ...limits));
    if (known.some(({ sense }) => sense < 0)) low = Math.max(low, Math.min(...ends, ...limits));
    [low, high] = [Math.min(low, ...limits), Math.max(high, ...limits)];
    const room = 0.1 * (high - low) || 1;
    return [low - room, high + room];
  }

  /* Shade the failing sides of bounds, and where there is no limit. */
  function shade(plot, { signal: { bounds, free }, found }) {
    const { ctx, bbox: { left, top, width, height } } = plot, [y, x] = [value => plot.valToPos(value, "y", true), value => plot.valToPos(value, "x", true)];
    const within = (value, low, high) => Math.min(Math.max(value, low), high);
    ctx.save();
    ctx.globalAlpha = 0.15;
    ctx.fillStyle = colour("--fails");
    for (const [place, { value, sense }] of bounds.entries()) {
      const shaded = bounds.slice(0, place).some(other => other.value === value && other.sense === sense);
      if (value === null || !sense || shaded) continue;
      const edge = within(y(value), top, top + height);
      ctx.fillRect(left, sense > 0 ? edge : top, width, sense > 0 ? top + height - edge : edge - top);
    }
    ctx.globalAlpha = 0.4;
    ctx.fillStyle = colour("--line");
    const [along, values] = found[0];
    for (let k = 0; free !== null && k < along.length; k++) {
      if (values[k] !== null) continue;
      let end = k;
      while (end + 1 < along.length && values[end + 1] === null) end++;
      const [from, to] = [k, end].map(place => within(x(along[place]), left, left + width));
      ctx.fillRect(from, top, to - from, height);
      k = end;
    }
    ctx.restore();
  }

  /* Whether values lie so far apart, all above zero, that only a logarithmic axis shows them. */
  function wide(data, { bounds }) {
    if (bounds.length) return false;
    const values = data.slice(1).flatMap(each => each.filter(value => value !== null && value !== undefined));
    const low = values.reduce((a, b) => Math.min(a, b), Infinity), high = values.reduce((a, b) => Math.max(a, b), 0);
    return low > 0 && high > 100 * low;
  }

  function options(made, width, logarithmic) {
    const { signal } = made;
    const stepped = uPlot.paths.stepped({ align: 1 }), path = signal.step ? { paths: stepped } : {};
    const line = { width: 1.5, points: { show: false }, pxAlign: 0 };
    const series = labels.map((label, number) => ({
      label, stroke: () => colour(ROLES[number % ROLES.length]), dash: DASHES[number % DASHES.length],
      ...line, ...path }));
    const bounds = signal.bounds.map(({ text }, number) => ({
      label: text, stroke: () => colour(signal.bounds[number].holds ? "--holds" : "--fails"), dash: [3, 3], ...line }));
    const range = signal.bounds.length && !logarithmic ? { range: (plot, low, high) => low === null ? [0, 1] : around(low, high, signal.bounds) } : {};
    const angles = over === "angle" ? { incrs: [1, 2, 5, 10, 15, 30, 60, 90, 180, 360, 720, 1800, 3600, 7200, 36000] } : {};
    return {
      width, height: HEIGHT, legend: { show: false }, series: [{}, ...series, ...bounds],
      scales: { x: { time: false }, y: { distr: logarithmic ? 3 : 1, ...range } },
      axes: [axis(over === "angle" ? "Shaft angle [deg]" : "Time [s]", { size: 34, ...angles }),
             axis((signal.unit && `[${signal.unit}]`) + (logarithmic ? " log." : ""), { size: 58, labelSize: 18 })],
      cursor: { x: false, y: false, points: { show: false }, drag: { x: true, y: false } },
      hooks: { drawClear: [plot => shade(plot, made)], setScale: [(plot, key) => { if (key === "x" && !setting) show([plot.scales.x.min, plot.scales.x.max]); }] },
    };
  }

  /* Curves at the same places as one table, of what is in sight the lowest and the highest of each few values. A run is
   * drawn in half the time that all its samples would take. */
  function thinned(found) {
    const along = found[0][0], last = along.length - 1, places = new Set([0, last]);
    const { min, max } = bounded(range), from = loomfmu.locate(along, min)[0], to = Math.min(loomfmu.locate(along, max)[0] + 1, last);
    const size = Math.max(1, Math.ceil((to - from) / BUCKETS));
    for (let start = from; start <= to; start += size)
      for (const [, values] of found) {
        let low = start, high = start;
        for (let k = start; k < Math.min(start + size, to + 1); k++) {
          if (values[k] < values[low]) low = k;
          if (values[k] > values[high]) high = k;
        }
        places.add(low).add(high);
      }
    const kept = [...places].sort((one, other) => one - other);
    return [along, ...found.map(([, values]) => values)].map(each => kept.map(k => each[k]));
  }

  /* The curves of runs as one table; one that is not known yet is empty. */
  function together(found) {
    const [[along]] = found, last = along.length - 1;
    const alike = ([its]) => its.length === along.length && [0, last >> 1, last].every(k => Math.abs(its[k] - along[k]) < 1e-9 * along[last]);
    if (along.length && found.every(alike)) return thinned(found);
    return uPlot.join(found.map(each => each[0].length ? thinned([each]) : each));
  }

  function contents(name) {
    const found = tables(name), ends = whole(), { bounds } = signals[name];
    if (loomfmu.live) {
      const table = together(found);
      return { found, data: [...table, ...bounds.map(bound => table[0].map(() => bound.value))] };
    }
    const lines = bounds.map(bound => [ends, [bound.value, bound.value]]);
    const all = [...found, ...lines];
    return { found, data: all.length === 1 ? found[0] : uPlot.join(all) };
  }

  function draw(name) {
    const signal = signals[name], figure = document.createElement("figure"), caption = document.createElement("figcaption");
    const title = document.createElement("code"), value = document.createElement("output"), about = document.createElement("span");
    const inside = document.createElement("div"), line = document.createElement("div");
    title.textContent = name;
    about.className = "about";
    value.setAttribute("aria-live", "off");
    caption.append(title, " ", value, " ", about);
    inside.className = "plot";
    inside.setAttribute("role", "img");
    inside.setAttribute("aria-label", `Plot of ${name}; the table of signals has its lowest, highest and last value`);
    line.className = "cursor-line";
    figure.dataset.name = name;
    figure.append(caption, inside);
    home.append(figure);
    const made = { name, figure, value, about, line, signal, inside, stale: false };
    made.follow = later(figure, () => { if (made.stale) render(made, false); else point(made, loomfmu.position); });
    plots.set(name, made);
    render(made);
  }

  /* Draw a plot, or with other curves than before, if it is not to be made anew. */
  function render(made, fresh = true) {
    const { found, data } = contents(made.name), logarithmic = wide(data, made.signal), { about, bounds } = made.signal;
    const all = found.flatMap(([, values]) => values.filter(value => value !== null)), low = all.reduce((a, b) => Math.min(a, b), Infinity);
    const high = all.reduce((a, b) => Math.max(a, b), -Infinity), [from, to] = around(low, high, bounds), short = value => Number(value.toPrecision(4));
    const beyond = bounds.length ? [high > to && `values go up to ${short(high)}`, low < from && `values go down to ${short(low)}`] : [];
    const free = found.some(([, values]) => made.signal.free !== null && values.includes(null));
    made.about.textContent = [about, made.signal.note, ...bounds.map(bound => bound.text), ...beyond, free && "shaded: no limit"].filter(Boolean).join("; ");
    made.found = found;
    made.largest = found.map(([, values]) => values.reduce((most, value) => Math.max(most, Math.abs(value)), 0));
    made.stale = false;
    setting += 1;
    if (fresh || made.logarithmic !== logarithmic || made.plot.series.length !== data.length) begin(made, data, logarithmic);
    else made.plot.setData(data, false);
    made.plot.setScale("x", bounded(range));
    queueMicrotask(() => { setting -= 1; point(made, loomfmu.position); });
  }

  function begin(made, data, logarithmic) {
    if (made.plot) made.plot.destroy();
    made.logarithmic = logarithmic;
    made.plot = new uPlot(options(made, made.inside.clientWidth || 600, logarithmic), data, made.inside);
    made.plot.over.append(made.line);
    made.plot.over.addEventListener("click", event => {
      if (made.plot.select.width > 2) return;
      const box = made.plot.over.getBoundingClientRect();
      loomfmu.seek(placed(made.plot.posToVal(event.clientX - box.left, "x")));
    });
  }

  // ---- the range of all plots

  function bounded(wanted) {
    const [low, high] = whole();
    if (!wanted) return { min: low, max: high };
    const width = Math.min(Math.max(wanted[1] - wanted[0], (high - low) * 1e-4), high - low);
    const min = Math.min(Math.max(wanted[0], low), high - width);
    return { min, max: min + width };
  }

  function show(wanted) {
    const limits = bounded(wanted);
    range = wanted && [limits.min, limits.max];
    setting += 1;
    for (const made of plots.values()) {
      made.plot.setScale("x", limits);
      made.stale = Boolean(loomfmu.live);
    }
    queueMicrotask(() => { setting -= 1; follow(); });
  }

  const zooms = {
    in: (low, high, at) => [at - (high - low) / 4, at + (high - low) / 4],
    out: (low, high, at) => [at - (high - low), at + (high - low)],
    turn: () => {
      const start = Math.floor(loomfmu.position / TURN + 1e-9) * TURN;
      return [start, start + TURN].map(position => shown(main, position));
    },
    all: () => null,
  };
  for (const button of document.querySelectorAll("#plots [data-zoom]"))
    button.addEventListener("click", () => {
      const { min, max } = bounded(range);
      show(zooms[button.dataset.zoom](min, max, shown(main, loomfmu.position)));
    });

  // ---- the cursor

  function valueAt({ found, largest, signal }, x, position) {
    const worst = signal.bounds.find(({ at }) => at !== null && Math.abs(at - position) < 1e-9); // as the claim says it
    return found.map(([along, values], number) => {
      if (!along.length || x < along[0] - 1e-6 || x > along[along.length - 1] + 1e-6) return "–";
      const [index, share] = loomfmu.locate(along, x), next = Math.min(index + 1, values.length - 1);
      const [before, after] = [values[index], values[next]];
      if (before === null || after === null) return signal.free === null ? "–" : "no limit";
      let value = worst && number === drawn ? worst.worst : signal.step ? (share >= 1 ? after : before) : before + share * (after - before);
      if (Math.abs(value) < 1e-12 * largest[number]) value = 0; // what rounding leaves of it
      return `${Number(value.toPrecision(5))}${signal.unit ? ` ${signal.unit}` : ""}`;
    }).join(" | ");
  }

  function point(made, position) {
    const x = shown(main, position), at = made.plot.valToPos(x, "x");
    made.line.style.transform = `translateX(${at}px)`;
    made.line.hidden = at < 0 || at > made.plot.over.clientWidth + 1;
    made.value.textContent = valueAt(made, x, position);
  }

  function follow() {
    for (const made of plots.values()) made.follow();
  }

  loomfmu.follow(position => {
    const x = shown(main, position);
    if (range && (x < range[0] || x > range[1])) {
      const width = range[1] - range[0], start = x > range[1] && x < range[1] + width ? x : x - width / 2;
      show([start, start + width]);
    } else follow();
  });

  // ---- what is chosen

  function choose(name, wanted) {
    if (wanted && !plots.has(name)) draw(name);
    if (!wanted && plots.has(name)) {
      plots.get(name).plot.destroy();
      plots.get(name).figure.remove();
      plots.delete(name);
    }
    document.getElementById("plots-count").textContent = plots.size;
  }
  choice.addEventListener("change", event => {
    if (event.target.type === "checkbox") choose(event.target.value, event.target.checked);
  });
  document.getElementById("plots-clear").addEventListener("click", () => {
    for (const box of boxes) { box.checked = false; choose(box.value, false); }
  });
  document.getElementById("plots-search").addEventListener("input", event => {
    const words = event.target.value.toLowerCase().split(/\s+/);
    for (const row of choice.querySelectorAll("tr[data-name]")) {
      const text = `${row.dataset.name} ${signals[row.dataset.name].about}`.toLowerCase();
      row.hidden = !words.every(word => text.includes(word));
    }
    for (const group of choice.querySelectorAll("tbody"))
      group.querySelector(".group").hidden = !group.querySelector("tr[data-name]:not([hidden])");
  });
  for (const radio of document.querySelectorAll("#plots input[name=plots-over]"))
    radio.addEventListener("change", () => {
      const kept = range && range.map(placed);
      over = radio.value;
      range = kept && kept.map(position => shown(main, position));
      for (const made of plots.values()) render(made);
    });

  // ---- width, colours and paper

  const fit = width => {
    for (const { plot, inside } of plots.values()) plot.setSize({ width: width || inside.clientWidth, height: HEIGHT });
    queueMicrotask(follow);
  };
  const repaint = () => { for (const { plot } of plots.values()) plot.redraw(false, true); };
  let width = 0;
  new ResizeObserver(() => {
    if (home.clientWidth !== width && !printing) { width = home.clientWidth; fit(); }
  }).observe(home);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", repaint);
  function print(now) {
    printing = now;
    root.classList.toggle("paper", now); // light colours, also in the dark
    fit(now ? PAPER : 0);
    repaint();
  }
  addEventListener("beforeprint", () => print(true));
  addEventListener("afterprint", () => print(false));

  loomfmu.plots = {
    traces, signals,
    /* Other curves, of the same signals, some of which differ; drawn as the cursor moves. */
    show(found, differs) {
      curves = found;
      for (const made of plots.values()) made.stale ||= differs(made.name);
    },
  };
  for (const box of boxes) box.checked = first.includes(box.value);
  for (const name of first) choose(name, true);
})();
