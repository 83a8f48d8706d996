/* Signals between their samples, as the claims of loomfmu take them: on each interval the polynomial that a
 * signal and its recorded rates give, by its Bernstein points. See cosim/claims/curves.py and bernstein.py. */
loomfmu.ONLY_SAMPLES = "is known only at the samples";
loomfmu.motion = (run, name, rates = 2) => {
  const { time } = run, count = time.length, SAME = 1e-11, COARSE = 0.2, NOISE = 4 * 2 ** -52, HALVINGS = 60;
  const values = [];
  for (let each = name; each && values.length <= rates; each = run.rate(each)) values.push(run.signal(each));
  const own = values[0], finite = values.every(each => each.reduce((sum, value) => sum + 0 * value, 0) === 0);
  const single = values.length === 1, known = !single || run.beside(name, "lowest") === name; // its samples are its extremes
  const note = !finite ? `${name} or its rate is not finite everywhere` : known ? "" : `${name} ${loomfmu.ONLY_SAMPLES}`;
  const largest = own.reduce((most, value) => Math.max(most, Math.abs(value)), 0);

  const fewer = [2, 4, 6][values.length - 1], [second, third] = values.slice(1);
  function points(i, all = new Array(fewer)) {
    const h = time[i + 1] - time[i], y0 = own[i], y1 = own[i + 1];
    all[0] = y0;
    all[fewer - 1] = y1;
    if (fewer === 2) return all;
    const v0 = second[i] * h, v1 = second[i + 1] * h;
    if (fewer === 4) {
      all[1] = y0 + v0 / 3;
      all[2] = y1 - v1 / 3;
      return all;
    }
    const a0 = third[i] * (h * h), a1 = third[i + 1] * (h * h);
    all[1] = y0 + 0.2 * v0;
    all[2] = y0 + 0.4 * v0 + 0.05 * a0;
    all[3] = y1 - 0.4 * v1 + 0.05 * a1;
    all[4] = y1 - 0.2 * v1;
    return all;
  }

  /* Lowest and highest of the points of each interval: the motion stays between them. */
  const lows = new Float64Array(count - 1), highs = new Float64Array(count - 1), some = points(0);
  for (let i = 0; i < count - 1; i++) {
    const all = points(i, some); // no array for each
    let low = all[0], high = all[0];
    for (const each of all) { if (each < low) low = each; else if (each > high) high = each; }
    lows[i] = low;
    highs[i] = high;
  }

  function split(all, share) {
    const left = [], right = [];
    for (let some = all; some.length; some = some.slice(1).map((value, k) => some[k] + share * (value - some[k]))) {
      left.push(some[0]);
      right.unshift(some[some.length - 1]);
    }
    return [left, right];
  }
  const value = (all, share) => split(all, share)[1][0];

  /* Lowest value of a piece, and the share of the way at which it is. */
  function lowestOf(all) {
    const end = all[all.length - 1], noise = NOISE * Math.max(...all.map(Math.abs));
    let best = Math.min(all[0], end), share = end < all[0] ? 1 : 0;
    const search = (some, begin, width, left) => {
      if (!left || !(Math.min(...some) < best - noise)) return;
      const [one, other] = split(some, 0.5), middle = begin + 0.5 * width;
      if (other[0] < best) [best, share] = [other[0], middle];
      search(one, begin, 0.5 * width, left - 1);
      search(other, middle, 0.5 * width, left - 1);
    };
    search(all, 0, 1, HALVINGS);
    return [best, share];
  }

  /* Shares of the way at which a piece changes its sign; 0 counts as positive. */
  function changes(all, begin = 0, width = 1) {
    const count = all.slice(1).filter((each, k) => (all[k] < 0) !== (each < 0)).length;
    if (count === 0) return [];
    if (count > 1 && width < 2 ** -HALVINGS) return (all[0] < 0) !== (all[all.length - 1] < 0) ? [begin] : [];
    if (count > 1) {
      const [left, right] = split(all, 0.5);
      return [...changes(left, begin, 0.5 * width), ...changes(right, begin + 0.5 * width, 0.5 * width)];
    }
    let low = 0, high = 1;
    for (let middle = 0.5; low < middle && middle < high; middle = 0.5 * (low + high))
      if ((value(all, middle) < 0) === (all[0] < 0)) low = middle; else high = middle;
    return [begin + width * high];
  }

  const intervalOf = moment => Math.min(loomfmu.locate(time, moment)[0], count - 2);
  const moment = (i, share) => share < 1 ? time[i] + share * (time[i + 1] - time[i]) : time[i + 1];

  function at(when) {
    const i = intervalOf(when);
    return value(points(i), (when - time[i]) / (time[i + 1] - time[i]));
  }

  function passages(level) {
    const found = [];
    for (let i = 0; i < count - 1; i++)
      if (lows[i] - level < 0 && highs[i] - level >= 0)
        for (const share of changes(points(i).map(each => each - level))) found.push(moment(i, share));
    return found;
  }

  /* Stretches of time above a level, or with a negative sign below it: start, end, whether both are in the run. */
  function beyond(level, sign) {
    const found = [];
    if (!finite) return found;
    let inside = (own[0] >= level) === (sign > 0), begin = time[0], whole = false;
    for (const when of passages(level)) {
      if (inside) found.push({ start: begin, end: when, whole });
      [inside, begin, whole] = [!inside, when, true];
    }
    if (inside) found.push({ start: begin, end: time[count - 1], whole: false });
    return found;
  }

  /* The intervals in some stretches of time: index, and the shares at which the stretch begins and ends. */
  function* pieces(within) {
    if (!within) { for (let i = 0; i < count - 1; i++) yield [i, 0, 1]; return; }
    for (const { start, end } of within)
      for (let i = intervalOf(start); i < count - 1 && (time[i] < end || start === end); i++) {
        const h = time[i + 1] - time[i];
        yield [i, Math.max((start - time[i]) / h, 0), Math.min((end - time[i]) / h, 1)];
        if (start === end) break;
      }
  }

  function cut(i, low, high) {
    let all = points(i);
    if (high < 1) all = split(all, high)[0];
    return low > 0 ? (high > 0 ? split(all, Math.min(low / high, 1))[1] : all) : all;
  }

  /* Where `sign` times the motion is lowest: value, the first time of equal ones, whether samples are too coarse. */
  function lowest(sign, within) {
    const found = [];
    let best = Infinity, sample = Infinity;
    for (const [i, low, high] of pieces(within)) // what lies above all samples is not searched
      if (low === 0 && high === 1) best = Math.min(best, sign * own[i], sign * own[i + 1]);
    for (const [i, low, high] of pieces(within)) {
      if (low === 0 && high === 1) {
        sample = Math.min(sample, sign * own[i], sign * own[i + 1]);
        if ((sign > 0 ? lows[i] : -highs[i]) > best + SAME * largest) continue;
      }
      const all = cut(i, low, high).map(each => sign * each), end = all[all.length - 1];
      sample = Math.min(sample, all[0], end);
      const [extreme, share] = values.length === 1 ? [Math.min(all[0], end), end < all[0] ? 1 : 0] : lowestOf(all);
      if (extreme <= best + SAME * largest) found.push([extreme, moment(i, low + share * (high - low)), i]);
      best = Math.min(best, extreme);
    }
    if (!found.length) return { value: NaN, time: NaN, sample: NaN, coarse: false };
    const [, when, i] = found.find(([extreme]) => extreme <= best + SAME * largest);
    let top = -Infinity;
    for (const each of own) top = Math.max(top, sign * each);
    const off = Math.min(sign * own[i], sign * own[i + 1]) - best;
    const coarse = off > Math.max(COARSE * (top - best), SAME * largest);
    return { value: sign * best, time: when, sample: sign * sample, coarse };
  }

  /* How near the motion comes to a level in some stretches of time: 0 where it passes it. */
  function nearest(level, within) {
    const passed = passages(level).find(when => within.some(({ start, end }) => start <= when && when <= end));
    if (passed !== undefined) return { value: 0, time: passed, coarse: false };
    const found = [1, -1].map(sign => {
      const side = within.filter(({ start, end }) => (at(0.5 * (start + end)) >= level) === (sign > 0));
      const extreme = side.length ? lowest(sign, side) : null;
      return extreme && { ...extreme, value: sign * (extreme.value - level) };
    }).filter(Boolean);
    const nearer = Math.min(...found.map(each => each.value));
    return found.filter(each => each.value <= nearer + SAME).sort((one, other) => one.time - other.time)[0];
  }

  /* How far the curve may be off at most: Motion.doubt of curves.py. */
  const doubt = single ? 0 : time.slice(1).reduce((most, after, i) => {
    const h = after - time[i], rise = own[i + 1] - own[i], v0 = second[i] * h, v1 = second[i + 1] * h;
    const from = (bend(i) * h * h) - (6 * rise - 4 * v0 - 2 * v1), to = (bend(i + 1) * h * h) - (2 * v0 + 4 * v1 - 6 * rise);
    return Math.max(most, 0.25 * Math.abs(from), 0.25 * Math.abs(to));
  }, 0);

  function bend(k) {
    if (third) return third[k];
    const [from, to] = [Math.max(k - 1, 0), Math.min(k + 1, count - 1)];
    return (second[to] - second[from]) / (time[to] - time[from]);
  }

  return { values: own, known, note, doubt, at, passages, beyond, lowest, nearest };
};

/* The same, kept until its samples change. */
loomfmu.motionOf = (() => {
  const kept = new Map();
  return (run, name, rates = 2) => {
    const key = `${name} ${rates}`, count = run.count(name);
    if (kept.get(key)?.count !== count) kept.set(key, { count, motion: loomfmu.motion(run, name, rates) });
    return kept.get(key).motion;
  };
})();
