/* Extremes that a component finds on its continuous curve, and holds: what they say between the samples, and how far a
 * signal may be off, as cosim/claims/latches.py and validity.py have it. `motion(name)` is a signal between its samples. */
loomfmu.latches = (run, motion) => {
  const ALIKE = 1e-8, SAME = 1e-11, { time } = run, final = time.length - 1, whole = [{ start: time[0], end: time[final] }];

  /* When the extreme that is held at a place was reached: the vertex of the parabola through the lowest samples of what
   * the latch follows. */
  function reached(latch, followed, place = final) {
    const scale = ALIKE * followed.reduce((most, each) => Math.max(most, Math.abs(each)), 0);
    const step = latch.findIndex(each => Math.abs(each - latch[place]) <= scale);
    if (step === 0) return time[0];
    const k = followed[step] <= followed[step - 1] ? step : step - 1;
    if (k <= 0 || k >= final) return time[k];
    const before = (followed[k] - followed[k - 1]) / (time[k] - time[k - 1]);
    const after = (followed[k + 1] - followed[k]) / (time[k + 1] - time[k]);
    if (after <= before) return time[k];
    const turn = 0.5 * (time[k - 1] + time[k]) - 0.5 * before * (time[k + 1] - time[k - 1]) / (after - before);
    return Math.min(Math.max(turn, time[step - 1]), time[step]);
  }

  const counted = test => { const place = time.findIndex(test); return place < 0 ? final + 1 : place; };

  /* Extremes so far, times `sense`, about each stretch of time: at its first and last samples, and after it. */
  function held(latch, sense, stretches = whole) {
    const values = run.signal(latch), near = SAME * (time[final] - time[0]);
    const at = place => sense * values[Math.min(Math.max(place, 0), final)];
    return stretches.filter(({ start, end }) => start < end || stretches === whole).map(({ start, end }) => {
      const last = counted(each => each > end + near) - 1;
      return { last, first: at(counted(each => each >= start - near)), inside: at(last), after: at(counted(each => each >= end - near)) };
    });
  }

  /* The lowest value of `sense` times a signal, how low it may be, and a note: as its component holds it, or as found. */
  function latched(signal, sense, found, stretches) {
    const { known, note } = motion(signal), latch = known ? null : run.beside(signal, sense > 0 ? "lowest" : "highest");
    if (!latch) return { ...found, possible: known ? found.value : -sense * Infinity, note };
    const about = held(latch, sense, stretches), possible = sense * Math.min(...about.map(each => each.after));
    const [best] = about.filter(each => each.inside < each.first).sort((one, other) => one.inside - other.inside);
    if (!best || best.inside > sense * found.value) return { ...found, possible, note: "" };
    const value = sense * best.inside, followed = Array.from(run.signal(signal), each => sense * each);
    return { value, possible, sample: value, time: reached(run.signal(latch), followed, best.last), note: `between the samples by ${latch}` };
  }

  /* How far the signal of a verdict may be off whatever the steps, wherever it is that near to the worst value. */
  function offBy(signal, { worst, time: when }, stretches = whole) {
    const name = run.beside(signal, "error");
    if (!name) return 0;
    const values = run.signal(signal), errors = run.signal(name), here = Math.min(counted(each => each >= when), final);
    return errors.reduce((most, error, k) => {
      const near = Math.abs(values[k] - worst) <= Math.abs(error) && stretches.some(each => each.start <= time[k] && time[k] <= each.end);
      return near || k === here || k === Math.max(here - 1, 0) ? Math.max(most, Math.abs(error)) : most;
    }, 0);
  }

  return { reached, latched, offBy };
};
