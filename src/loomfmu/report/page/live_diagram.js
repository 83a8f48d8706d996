/* The timing diagram of the run: rows and rules are those of report/occasions.py, places those of diagram.py. */
(() => {
  const { rows, left, right, centre, top, row: height, outer, width } = loomfmu.data("diagram"), TURN = 2 * Math.PI;
  const SVG = "http://www.w3.org/2000/svg", EDGE = 1e-9, CURVE_POINTS = 180;
  const pictures = ["straight", "round"].map(name => document.getElementById(`diagram-${name}`));
  const details = document.querySelector("#diagram details"), drawings = [];
  let run = null, bars = [], curves = [], drawn = null, begun = false;

  // ---- rules

  const each = change => (...operands) => {
    const lists = operands.filter(operand => typeof operand === "object");
    if (!lists.length) return change(...operands);
    return lists[0].map((_, k) => change(...operands.map(operand => typeof operand === "object" ? operand[k] : operand)));
  };
  const over = (choose, begin) => (...operands) => operands.reduce(
    (found, operand) => typeof operand === "object" ? operand.reduce(choose, found) : choose(found, operand), begin);
  const [less, more] = [(one, other) => Math.min(one, other), (one, other) => Math.max(one, other)];
  const operations = {
    "-": each((one, other) => one - other), "*": each((one, other) => one * other), "/": each((one, other) => one / other),
    abs: each(Math.abs), min: each(Math.min), lowest: over(less, Infinity), highest: over(more, -Infinity),
  };

  function value(rule) {
    if (typeof rule === "string") return run.has(rule) ? run.signal(rule) : run.parameter(rule);
    return Array.isArray(rule) ? operations[rule[0]](...rule.slice(1).map(value)) : rule;
  }

  // ---- one revolution

  /* A signal along one revolution, with its values at both ends: angles within the revolution, and values. */
  function along(values, number) {
    const { positions } = run, start = (number - 1) * TURN;
    const first = Math.max(start, positions[0]), last = Math.min(start + TURN, positions[positions.length - 1]);
    const angles = [first - start], found = [loomfmu.interpolate(positions, values, first)];
    for (let k = loomfmu.locate(positions, first)[0]; k < positions.length && positions[k] < last; k++)
      if (positions[k] > first) { angles.push(positions[k] - start); found.push(values[k]); }
    angles.push(last - start);
    found.push(loomfmu.interpolate(positions, values, last));
    return [angles, found];
  }

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
        const intervals = positive(along(bars[place][k], number));
        words.push([row.label, bar.label, intervals.map(degrees).join(", ") || "never"]);
        for (const [from, to] of intervals) {
          const text = `${row.label} ${bar.label}: ${degrees([from, to])}`, [x0, x1] = [x(from), x(to)];
          const box = [[x0, low + 6], [x1, low + 6], [x1, low + height - 4], [x0, low + height - 4]];
          straight.push(shape(box, bar.role, text));
          round.push(shape(ring(outside - 0.85 * width, outside - 0.15 * width, from, to), bar.role, text));
        }
      });
      if (curves[place]) {
        const [angles, values] = along(curves[place], number), every = Math.max(1, Math.floor(angles.length / CURVE_POINTS));
        const points = angles.flatMap((angle, k) => k % every ? [] : [[x(angle), low + 6 + (height - 10) * (1 - values[k])]]);
        straight.push(shape(points, "curve"));
      }
    });
    for (const [verdict, at] of marks(number)) {
      const low = top + height * rows.length, role = verdict.holds ? "holds" : "fails", text = verdict.holds ? "holds" : "FAILS";
      straight.push(shape([[x(at), low + 4], [x(at) + 6, low + height - 6], [x(at) - 6, low + height - 6]], role, text));
      round.push(shape([onCircle(outer + 2, at), onCircle(outer + 14, at - 0.02), onCircle(outer + 14, at + 0.02)], role, text));
    }
    drawings[0].replaceChildren(...straight);
    drawings[1].replaceChildren(...round);
    tell(words, number);
  }

  function marks(number) {
    return (loomfmu.live.verdicts || []).filter(each => each.place)
      .map(each => [each, each.place.position - (number - 1) * TURN]).filter(([, at]) => at >= 0 && at < TURN);
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
      for (const old of kept.querySelectorAll("polygon, polyline.curve")) old.remove();
      kept.removeAttribute("data-drawing");
      kept.removeAttribute("hidden");
      picture.insertBefore(live, kept.querySelector("text.text") && picture.id === "diagram-round" ? kept : kept.nextSibling);
      drawings.push(live);
    }
    for (const old of details.querySelectorAll("h3:not(:first-of-type), table:not(:first-of-type)")) old.remove();
    begun = true;
  }

  const number = position => {
    const last = Math.ceil(loomfmu.last / TURN - EDGE), first = Math.floor(loomfmu.first / TURN) + 1;
    return Math.min(Math.max(Math.floor(position / TURN + EDGE) + 1, first), last);
  };

  function update(position) {
    if (!run || drawn === number(position)) return;
    drawn = number(position);
    draw(drawn);
  }

  loomfmu.live.follow(found => {
    if (!begun) begin();
    [run, drawn] = [found, null];
    if (!run) { for (const drawing of drawings) drawing.replaceChildren(); return; }
    bars = rows.map(row => row.bars.map(bar => value(bar.rule)));
    curves = rows.map(row => row.curve === null ? null : value(row.curve)).map(curve => curve && curve.every(Number.isFinite) ? curve : null);
  });
  loomfmu.follow(update);
  loomfmu.live.intervals = turn => rows.map((row, place) => row.bars.map((_, k) => positive(along(bars[place][k], turn))));
})();
