/* The plots of the report, of the runs of the page: the present one, and the one with the scene's own values. */
(() => {
  const { traces, signals, show } = loomfmu.plots, { plan } = loomfmu.live, choice = document.getElementById("plots-choice");
  const rows = choice.querySelectorAll("tr[data-name]")
  const drawn = document.getElementById("plots-drawn");
  let run = null, own = null, drawnOf = new Map(); // of each signal, what its plot shows
  drawn.hidden = true; // there is nothing to draw before the first run

  function curve(of, name) {
    const { factor } = plan.signals[name], { free } = signals[name];
    const shown = free === null ? value => value / factor
      : value => Math.abs(value / factor - free) < 1e-9 * free ? NaN : value / factor;
    return of && !of.waits(name) && [of.positions, of.signal(name).map(shown)];
  }

  /* A run that stays as it is while others are made. */
  function kept({ time, positions, signal }) {
    const values = new Map(Object.keys(signals).map(name => [name, signal(name).slice()]));
    return { time, positions: positions.slice(), signal: name => values.get(name), waits: () => false };
  }

  function summarize() {
    if (!choice.open) return;
    for (const row of rows) {
      const { factor } = plan.signals[row.dataset.name], known = run && !run.waits(row.dataset.name);
      const values = known ? run.signal(row.dataset.name) : [];
      let low = Infinity, high = -Infinity;
      const { free } = signals[row.dataset.name];
      for (const value of values) {
        if (free !== null && Math.abs(value / factor - free) < 1e-9 * free) continue;
        [low, high] = [Math.min(low, value), Math.max(high, value)];
      }
      const shown = [low, high, values[values.length - 1]];
      shown.forEach((value, k) => { row.cells[k + 1].textContent = known && Number.isFinite(value) ? String(Number((value / factor).toPrecision(6))) : "–"; });
    }
  }

  choice.addEventListener("toggle", summarize);
  loomfmu.live.follow("plots", found => {
    run = found;
    if (run && !own) own = kept(run);
    drawn.hidden = !own;
    [run || own, own].forEach((each, number) => {
      if (each) [traces[number].positions, traces[number].times] = [each.positions, each.time];
    });
    const before = drawnOf;
    drawnOf = new Map();
    for (const [name, signal] of Object.entries(signals)) {
      signal.bounds = loomfmu.live.bounds(name);
      signal.note = run && run.waits(name) ? "being computed" : "";
      drawnOf.set(name, run ? [signal.note || run.count(name), run.count("shaft"), JSON.stringify(signal.bounds)].join() : "none");
    }
    summarize();
    show(name => [curve(run, name), curve(own, name)], name => drawnOf.get(name) !== before.get(name));
  });
})();
