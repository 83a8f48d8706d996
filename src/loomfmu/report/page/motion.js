// Moves the parts of the drawings to where the keyframes have them at the cursor's position, or the run of the page.
(() => {
  const { first, span, tracks, bows, modes, fixed } = loomfmu.data(document.getElementById("motion") ? "motion" : "loom"), { live } = loomfmu;
  const roots = [...document.querySelectorAll(".motion")], missing = document.getElementById("motion-missing");
  for (const track of Object.values(tracks))
    if (track.frames) track.frames = track.frames.map(steps => { let sum = 0; return steps.map(step => sum += step); });
  const windows = live ? Infinity : Math.max(...Object.values(tracks).map(track => track.shown.length));
  let ran = false, known = false, window_ = 0, share = 0, sample = null, waiting = new Set(); // share of the window that is past; place and share among the samples

  const between = (values, place, part) => {
    const next = values[Math.min(place + 1, values.length - 1)];
    return values[place] + part * (next - values[place]);
  };
  const value = name => {
    const track = tracks[name];
    if (track.rule) return track.value(...sample);
    const frame = track.frames[track.shown[live ? 0 : window_]];
    const place = share * (frame.length - 1), index = Math.floor(place);
    return track.step * between(frame, index, place - index);
  };
  const follower = word => Number.isNaN(Number(word)) ? () => value(word) : () => Number(word);
  const followers = (how, move) => roots.flatMap(root => [...root.querySelectorAll(`[data-${how}]`)]).map(element => {
    const names = element.getAttribute(`data-${how}`).split(" "), words = names.map(follower);
    return { figure: element.closest("figure"), names, move: () => move(element, words.map(word => word())) };
  });

  /* Points of an elastica by half the slope of its ends, between the two computed ones that are next to it. */
  function bow(slope, length, x, y) {
    const place = Math.min(slope / bows.largest, 1) * (bows.x.length - 1), row = Math.floor(place);
    const part = place - row, size = Math.max(length, 0);
    const along = bows.x[0].map((_, point) => [bows.x, bows.y].map(rows => between(rows.map(each => each[point]), row, part)));
    return along.map(([across, up]) => `${(x + size * across).toFixed(3)} ${(y + size * up).toFixed(3)}`).join(" ");
  }

  /* Points along a length: a number of times the sum of the shapes of `modes`, each with its amplitude. */
  function curve(length, times, ...amplitudes) {
    const last = modes[0].length - 1, height = point => amplitudes.reduce((sum, each, row) => sum + each * modes[row][point], 0);
    return modes[0].map((_, point) => `${(length * point / last).toFixed(3)} ${(times * height(point)).toFixed(3)}`).join(" ");
  }

  const moves = [
    ...followers("points", (element, at) => element.setAttribute("points", at.map(each => each.toFixed(3)).join(" "))),
    ...followers("at", (element, [x, y]) => { element.setAttribute("cx", x); element.setAttribute("cy", y); }),
    ...followers("shift", (element, [x, y]) => element.setAttribute("transform", `translate(${x} ${y})`)),
    ...followers("stretch", (element, [x, y, wide, high]) => element.setAttribute("transform", `translate(${x} ${y}) scale(${wide} ${high})`)),
    ...followers("turn", (element, [angle, x, y]) => element.setAttribute("transform", `rotate(${angle} ${x} ${y})`)),
    ...followers("shown", (element, [amount]) => element.toggleAttribute("hidden", !(amount > 0))),
    ...followers("bow", (element, at) => element.setAttribute("points", bow(...at))),
    ...followers("curve", (element, at) => element.setAttribute("points", curve(...at))),
    ...followers("value", (element, [amount]) => { element.textContent = amount.toFixed(1).replace("steps" in element.dataset ? /\.0$/ : "", ""); }),
  ];
  function draw(position) {
    const turns = (position - first) / span;
    window_ = Math.min(Math.max(Math.floor(turns + 1e-9), 0), windows - 1);
    share = Math.min(Math.max(turns - window_, 0), 1);
    if (live && live.current) sample = loomfmu.locate(live.current.positions, position);
    known = live ? live.current && !varied().length
      : turns < windows + 1e-9 && Object.values(tracks).every(track => track.shown[window_] !== null);
    if (live && !ran) return; // the drawings show the run that the page was written with
    missing.hidden = known || Boolean(live && !live.current);
    if (live) missing.textContent = `The drawings have the scene’s own ${varied().join(", ")}, so they do not show this run.`;
    for (const root of roots) root.classList.toggle("stale", !known);
    if (!known) return; // drawings and caption stay as they were, together
    for (const { figure, move } of moves) if (!waiting.has(figure)) move();
    document.getElementById("motion-place").textContent = loomfmu.label(position);
  }

  /* Parameters of shapes that no track moves, and that differ from the scene's. */
  const varied = () => live.changed().filter(target => fixed.includes(target));

  if (live)
    live.follow("motion", run => {
      ran = true;
      const rule = run && loomfmu.rules(run, tracks);
      for (const track of Object.values(tracks)) if (run && track.rule) track.value = rule(track.rule);
      const waits = ({ names }) => names.some(name => tracks[name] && loomfmu.waits(run, name, tracks));
      waiting = new Set(run ? moves.filter(waits).map(({ figure }) => figure) : []);
      for (const figure of document.querySelectorAll(".motion figure")) { // those that wait fade and say so
        figure.classList.toggle("stale", waiting.has(figure));
        figure.querySelector(".waits").hidden = !waiting.has(figure);
      }
    });
  loomfmu.follow(draw);
})();
