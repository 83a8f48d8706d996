/* Plots of the chosen signals over the shaft's angle, or time: every extreme is kept when points are thinned. */
(() => {
  const SVG = "http://www.w3.org/2000/svg", DEGREE = Math.PI / 180, WIDTH = 900, HEIGHT = 170;
  const BOX = { left: 70, right: 874, top: 12, bottom: 140 }, BUCKETS = 400, TICKS = 8;
  const { signals } = loomfmu.live.plan, home = document.getElementById("plots-drawn");
  const boxes = [...document.querySelectorAll("#plots-choice input")], plots = new Map(), before = new Map();
  let run = null, first = null;

  const make = (name, parent, attributes = {}) => {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    return parent.appendChild(made);
  };
  const x = position => BOX.left + (BOX.right - BOX.left) * (position - loomfmu.first) / (loomfmu.last - loomfmu.first);
  const short = value => String(Number(value.toPrecision(5)));

  /* Round numbers between two, about so many. */
  function ticks(low, high, count) {
    const raw = (high - low) / count, unit = 10 ** Math.floor(Math.log10(raw));
    const step = loomfmu.turns && count === TICKS ? [10, 30, 45, 90, 180, 360, 720, 1800, 3600].find(each => each >= raw) || raw
      : unit * [1, 2, 5, 10].find(each => each * unit >= raw);
    const found = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
    return found;
  }

  /* The lowest and the highest sample of each bucket, as a path. */
  function path(positions, values, y, stepped) {
    const size = Math.max(1, Math.ceil(values.length / BUCKETS)), parts = [];
    const add = k => {
      const [across, up] = [x(positions[k]).toFixed(1), y(values[k]).toFixed(1)];
      parts.push(stepped && parts.length ? `H${across}V${up}` : `${parts.length ? "L" : "M"}${across},${up}`);
    };
    for (let start = 0; start < values.length; start += size) {
      let low = start, high = start;
      for (let k = start; k < Math.min(start + size, values.length); k++) {
        if (values[k] < values[low]) low = k;
        if (values[k] > values[high]) high = k;
      }
      add(Math.min(low, high));
      if (low !== high) add(Math.max(low, high));
    }
    add(values.length - 1);
    return parts.join("");
  }

  function extent(values, [low, high] = [Infinity, -Infinity]) {
    for (const value of values) { low = Math.min(low, value); high = Math.max(high, value); }
    return [low, high];
  }

  function render(name) {
    const plot = plots.get(name), signal = signals[name];
    plot.picture.replaceChildren();
    plot.value.textContent = "";
    if (!run) return;
    const values = run.signal(name), old = before.get(name);
    let [low, high] = extent(values, old && extent(old));
    const margin = 0.05 * (high - low || Math.abs(high) || 1);
    [low, high] = [low - margin, high + margin];
    const y = value => BOX.bottom - (BOX.bottom - BOX.top) * (value - low) / (high - low);
    for (const tick of ticks(low / signal.factor, high / signal.factor, 4)) {
      const up = y(tick * signal.factor);
      make("line", plot.picture, { x1: BOX.left, x2: BOX.right, y1: up, y2: up, class: "line" });
      make("text", plot.picture, { x: BOX.left - 6, y: up + 4, "text-anchor": "end", class: "faint" }).textContent = short(tick);
    }
    const scale = loomfmu.turns ? DEGREE : 1;
    for (const tick of ticks(loomfmu.first / scale, loomfmu.last / scale, TICKS)) {
      const across = x(tick * scale);
      make("line", plot.picture, { x1: across, x2: across, y1: BOX.bottom, y2: BOX.bottom + 4, class: "line" });
      make("text", plot.picture, { x: across, y: BOX.bottom + 18, "text-anchor": "middle", class: "faint" })
        .textContent = loomfmu.turns ? `${short(tick)}°` : `${short(tick)} s`;
    }
    if (old && old.length === values.length) make("path", plot.picture, { d: path(first, old, y, signal.steps), class: "before" });
    make("path", plot.picture, { d: path(run.positions, values, y, signal.steps), class: "now" });
    plot.cursor = make("line", plot.picture, { y1: BOX.top, y2: BOX.bottom, class: "cursor" });
    point(name, loomfmu.position);
  }

  function point(name, position) {
    const plot = plots.get(name), signal = signals[name];
    if (!run || !plot.cursor) return;
    plot.cursor.setAttribute("x1", x(position));
    plot.cursor.setAttribute("x2", x(position));
    const [k, share] = loomfmu.locate(run.positions, position), values = run.signal(name);
    const value = signal.steps ? values[share < 1 ? k : k + 1] : loomfmu.interpolate(run.positions, values, position);
    plot.value.textContent = `${short(value / signal.factor)}${signal.unit && ` ${signal.unit}`}`;
  }

  function choose(name, wanted) {
    if (!wanted) {
      if (plots.has(name)) plots.get(name).figure.remove();
      plots.delete(name);
      return;
    }
    const figure = document.createElement("figure"), caption = document.createElement("figcaption");
    const title = document.createElement("code"), value = document.createElement("output"), about = document.createElement("small");
    [title.textContent, about.textContent, figure.dataset.name] = [name, signals[name].about, name];
    value.setAttribute("aria-live", "off");
    caption.append(title, " ", value, " ", about);
    const frame = document.createElement("div");
    frame.className = "wide";
    figure.append(caption, frame);
    const picture = make("svg", frame, { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "diagram plot", role: "img", "aria-label": `Plot of ${name}` });
    picture.addEventListener("click", event => {
      const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(picture.getScreenCTM().inverse());
      loomfmu.seek(loomfmu.first + (place.x - BOX.left) / (BOX.right - BOX.left) * (loomfmu.last - loomfmu.first));
    });
    home.append(figure);
    plots.set(name, { figure, picture, value });
    render(name);
  }

  /* The scene's own run stays, faint, for as long as the page is open. */
  function keep() {
    first = run.positions.slice();
    for (const name of Object.keys(signals)) before.set(name, run.signal(name).slice());
  }

  for (const box of boxes) {
    box.checked = loomfmu.data("plots").first.includes(box.value);
    box.addEventListener("change", () => choose(box.value, box.checked));
    if (box.checked) choose(box.value, true);
  }
  loomfmu.live.follow(found => {
    run = found;
    if (run && !first) keep();
    for (const name of plots.keys()) render(name);
  });
  loomfmu.follow(position => { for (const name of plots.keys()) point(name, position); });
})();
