/* The timing diagram of the run: rows and rules are those of report/occasions.py, places those of diagram.py. */
(() => {
  const { rows, left, right, centre, top, row: height, outer, width } = loomfmu.data("diagram"), TURN = 2 * Math.PI;
  const SVG = "http://www.w3.org/2000/svg", CURVE_POINTS = 180;
  const pictures = ["straight", "round"].map(name => document.getElementById(`diagram-${name}`));
  const details = document.querySelector("#diagram details"), drawings = [];
  let run = null, bars = [], curves = [], drawn = null, begun = false; // bars and curves: functions of live_rules.js, null while they wait

  // ---- one revolution

  /* A rule along one revolution, with its values at both ends: angles within the revolution, and values. */
  function along(value, number) {
    const { positions } = run, start = (number - 1) * TURN;
    const first = Math.max(start, positions[0]), last = Math.min(start + TURN, positions[positions.length - 1]);
    const [[from, share], [to, rest]] = [first, last].map(position => loomfmu.locate(positions, position));
    const angles = [first - start], found = [between(value, from, share)];
    for (let k = from; k <= to + 1 && positions[k] < last; k++)
      if (positions[k] > first) { angles.push(positions[k] - start); found.push(value(k, 0)); }
    angles.push(last - start);
    found.push(between(value, to, rest));
    return [angles, found];
  }
  const between = (value, k, share) => share ? value(k, 0) + share * (value(k + 1, 0) - value(k, 0)) : value(k, 0);

  function positive([angles, values]) {
    const edges = values[0] > 0 ? [angles[0]] : [];
    for (let k = 0; k < values.length - 1; k++)
      if ((values[k] > 0) !== (values[k + 1] > 0))
        edges.push(angles[k] + values[k] / (values[k] - values[k + 1]) * (angles[k + 1] - angles[k]));
    if (values[values.length - 1] > 0) edges.push(angles[angles.length - 1]);
    return edges.filter((_, k) => k % 2 === 0).map((low, k) => [low, edges[2 * k + 1]]).filter(([low, high]) => high > low);
  }

  // ---- drawing

  const x = angle => left + (right - left) * angle / TURN;
  const onCircle = (radius, angle) => [centre[0] + radius * Math.sin(angle), centre[1] - radius * Math.cos(angle)];
  const degrees = ([low, high]) => [low, high].map(edge => `${(edge * 360 / TURN).toFixed(1)}°`).join(" to ");

  function ring(inner, outside, start, end) {
    const count = Math.max(2, Math.ceil((end - start) * 180 / TURN) + 1), points = [];
    for (let k = 0; k < count; k++) points.push(onCircle(outside, start + (end - start) * k / (count - 1)));
    for (let k = count - 1; k >= 0; k--) points.push(onCircle(inner, start + (end - start) * k / (count - 1)));
    return points;
  }

  function triangle(middle, above, below, upright) {
    const [tip, base] = upright ? [above, below] : [below, above];
    return [[middle, tip], [middle + 6, base], [middle - 6, base]];
  }

  function shape(points, role, text) {
    const made = document.createElementNS(SVG, text === undefined ? "polyline" : "polygon");
    made.setAttribute("class", role);
    made.setAttribute("points", points.map(point => point.map(each => each.toFixed(2)).join(",")).join(" "));
    if (text) made.appendChild(document.createElementNS(SVG, "title")).textContent = text;
    return made;
  }

  function draw(number) {
    const straight = [], round = [], words = [];
    rows.forEach((row, place) => {
      const low = top + height * place, outside = outer - width * place;
      row.bars.forEach((bar, k) => {
        if (!bars[place][k]) { words.push([row.label, bar.label, "being computed"]); return; }
        const intervals = positive(along(bars[place][k], number));
        words.push([row.label, bar.label, intervals.map(degrees).join(", ") || "never"]);
        for (const [from, to] of intervals) {
          const text = `${row.label} ${bar.label}: ${degrees([from, to])}`, [x0, x1] = [x(from), x(to)];
          const box = [[x0, low + 6], [x1, low + 6], [x1, low + height - 4], [x0, low + height - 4]];
          straight.push(shape(box, bar.role, text));
          round.push(shape(ring(outside - 0.85 * width, outside - 0.15 * width, from, to), bar.role, text));
        }
      });
      if (!curves[place]) return;
      const [angles, values] = along(curves[place], number), every = Math.max(1, Math.floor(angles.length / CURVE_POINTS));
      if (!values.every(Number.isFinite)) return;
      const kept = angles.map((_, k) => k).filter(k => k % every === 0 || k === angles.length - 1);
      const points = kept.map(k => [x(angles[k]), low + 6 + (height - 10) * (1 - values[k])]);
      straight.push(shape(points, "curve"));
    });
    const found = marks(number);
    if (!found.length) straight.push(elsewhere());
    for (const [verdict, at] of found) {
      const low = top + height * rows.length, role = verdict.holds ? "holds" : "fails", text = verdict.holds ? "holds" : "FAILS";
      const [across, down] = onCircle(outer + 9, at);
      straight.push(shape(triangle(x(at), low + 4, low + height - 6, verdict.holds), role, text));
      round.push(shape(triangle(across, down - 6, down + 6, verdict.holds), role, text));
    }
    drawings[0].replaceChildren(...straight);
    drawings[1].replaceChildren(...round);
    tell(words, number);
  }

  function marks(number) {
    return (loomfmu.live.verdicts || []).filter(each => each.place)
      .map(each => [each, each.place.position - (number - 1) * TURN]).filter(([, at]) => at >= 0 && at < TURN);
  }

  /* What the row of the claims says in a revolution that has none of their worst values. */
  function elsewhere() {
    const all = (loomfmu.live.verdicts || []).filter(each => each.place).map(each => loomfmu.revolution(each.place.position));
    const numbers = [...new Set(all)].sort((one, other) => one - other), made = document.createElementNS(SVG, "text");
    const listed = [numbers.slice(0, -1).join(", "), ...numbers.slice(-1)].filter(String).join(" and ");
    made.setAttribute("class", "faint elsewhere");
    made.setAttribute("x", left + 8);
    made.setAttribute("y", top + height * (rows.length + 0.65));
    made.textContent = listed && `worst values in revolution${numbers.length > 1 ? "s" : ""} ${listed}`;
    return made;
  }

  function tell(words, number) {
    const body = details.querySelector("tbody");
    details.querySelector("h3").textContent = `Revolution ${number}`;
    body.replaceChildren(...words.map(cells => {
      const line = document.createElement("tr");
      for (const text of cells) line.appendChild(document.createElement("td")).textContent = text;
      return line;
    }));
  }

  /* Keeps what does not move: the grid and the names of the rows. */
  function begin() {
    for (const picture of pictures) {
      const groups = picture.querySelectorAll("g[data-drawing]"), kept = groups[0], live = document.createElementNS(SVG, "g");
      for (const group of groups) if (group !== kept) group.remove();
      for (const old of kept.querySelectorAll("polygon, polyline.curve, .elsewhere")) old.remove();
      kept.removeAttribute("data-drawing");
      kept.removeAttribute("hidden");
      picture.insertBefore(live, kept.querySelector("text.text") && picture.id === "diagram-round" ? kept : kept.nextSibling);
      drawings.push(live);
    }
    for (const old of details.querySelectorAll("h3:not(:first-of-type), table:not(:first-of-type)")) old.remove();
    begun = true;
  }

  function update(position) {
    if (!run || drawn === loomfmu.revolution(position)) return;
    drawn = loomfmu.revolution(position);
    draw(drawn);
  }

  loomfmu.live.follow("diagram", found => {
    if (!begun) begin();
    [run, drawn] = [found, null];
    if (!run) { for (const drawing of drawings) drawing.replaceChildren(); return; }
    const rules = loomfmu.rules(run), rule = each => loomfmu.waits(run, each) ? null : rules(each);
    bars = rows.map(row => row.bars.map(bar => rule(bar.rule)));
    curves = rows.map(row => rule(row.curve === null ? NaN : row.curve));
  });
  loomfmu.follow(update);
  loomfmu.live.intervals = turn => rows.map((row, place) => row.bars.map((_, k) => positive(along(bars[place][k], turn))));
})();
