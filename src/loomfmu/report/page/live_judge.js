/* The claims on a run, judged as cosim/claims judges them: `loomfmu.judge(run)(claim)` is a verdict with worst value,
 * bound, time and note. A verdict is given where the outputs hold it exactly or the curve between the samples decides it;
 * of everything else `holds` is null, and the note says why. tests/test_live_claims.py holds both to one another. */
loomfmu.judge = run => {
  const TURN = 2 * Math.PI, DEGREE = Math.PI / 180, SAME = 1e-11, FARTHEST = TURN / 20 * (1 + SAME), EMPTY = 1e-12;
  const STANDS = 1e-9; // of a revolution
  const NOT_HERE = "loomfmu run judges it", COARSE = "the samples are too far apart to be sure";
  const UNPASSED = "the run never passes through the whole window";
  const CUT_OFF = "one is cut off by an end of the run and may be shorter; run longer or start elsewhere";
  const NEVER = "the head never enters the shed in this run";
  const NOT_FINAL = ["dwell", "clear_shed", "nip_holds"]; // of which the rest of a revolution may mend a failure
  const FAR_ABOVE = 10, NEAR = 1e-4; // of the error at the scene's own values, and of the bound
  const { time } = run, last = values => values[values.length - 1], end = last(time);

  // ---- what claims have in common

  const motion = (name, rates) => loomfmu.motionOf(run, name, rates);
  const { reached, latched, offBy } = loomfmu.latches(run, motion);
  const unknown = note => ({ holds: null, note });
  const joined = notes => [...new Set(notes)].filter(Boolean).join("; ");
  const never = (...notes) => unknown(joined(notes)); // a claim without a value is not decided
  const shown = (value, factor, unit) => `${loomfmu.general(value * factor)} ${unit}`;
  const degrees = angle => shown(angle, 1 / DEGREE, "deg"), mm = length => shown(length, 1e3, "mm");
  const byTime = (one, other) => one.time - other.time;

  /* The lowest of a few values, and the first time of those that are equal to it. */
  function firstLowest(found) {
    const value = Math.min(...found.map(each => each.value));
    return { ...found.filter(each => each.value <= value + SAME).sort(byTime)[0], value };
  }

  /* All times at which the shaft stands at an angle of its revolution. */
  function timesAt(wanted) {
    const turning = motion("shaft.angle"), { values } = turning, found = new Set();
    const low = Math.min(values[0], last(values)), high = Math.max(values[0], last(values));
    for (let turn = Math.floor((low - wanted) / TURN) - 1; wanted + turn * TURN <= high + 1e-8; turn++) {
      const level = wanted + turn * TURN;
      const ends = [0, values.length - 1].filter(place => Math.abs(values[place] - level) < 1e-9 * TURN);
      if (ends.length) ends.forEach(place => found.add(time[place]));
      else if (level > low) turning.passages(level).forEach(when => found.add(when));
    }
    return [...found].sort((one, other) => one - other);
  }

  function timesWithin([start, stop]) {
    const between = stop > start ? stop - start : (stop - start + TURN) % TURN, turning = motion("shaft.angle");
    const width = between < TURN - EMPTY ? between : TURN; // in spite of rounding
    const edges = [...timesAt(start), ...(width < TURN ? timesAt(start + width) : [])];
    const marks = [...new Set([time[0], ...edges, end])].sort((one, other) => one - other);
    const inside = marks.slice(1).map((mark, k) => ({ start: marks[k], end: mark })).filter(stretch => {
      const away = turning.at(0.5 * (stretch.start + stretch.end)) - start;
      return away - TURN * Math.floor(away / TURN) <= width;
    });
    return [...inside, ...edges.map(edge => ({ start: edge, end: edge }))];
  }

  const angleAt = when => { const at = motion("shaft.angle").at(when); return at - TURN * Math.floor(at / TURN); };
  const turned = ({ start, end: stop }) => Math.abs(motion("shaft.angle").at(stop) - motion("shaft.angle").at(start));

  /* The passes of the shaft through a window, without those that the run cuts off. */
  function passes(window) {
    const within = timesWithin(window), edges = new Set(within.filter(each => each.start === each.end).map(each => each.start));
    return within.filter(each => each.start < each.end && edges.has(each.start) && edges.has(each.end));
  }

  /* Whether a signal is not known somewhere, or in some stretches of time: a signal of its own says so. */
  function gaps(signal, stretches = [{ start: time[0], end }]) {
    const flag = run.beside(signal, "valid_if");
    return Boolean(flag) && run.signal(flag).some((known, k) => !known
      && stretches.some(each => (time[k - 1] ?? time[0]) < each.end && each.start < (time[k + 1] ?? end)));
  }
  const gap = signal => unknown(`${signal} is not known: ${run.beside(signal, "valid_if")} is false; ${NOT_HERE}`);

  function extreme(signal, bound, sense, stretches) {
    if (gaps(signal, stretches)) return gap(signal);
    const found = latched(signal, sense, motion(signal).lowest(sense, stretches), stretches);
    const over = each => sense * each >= sense * bound, doubt = motion(signal).doubt;
    const between = over(found.sample) && !(over(found.value - sense * doubt) && over(found.possible));
    if (found.coarse || between) return unknown(`it is decided between the samples; ${NOT_HERE}`);
    return { worst: found.value, bound, time: found.time, notes: [found.note] };
  }

  // ---- frames at the ends of their strokes

  /* What both have in common of some stretches of time and others. */
  function common(some, others) {
    return some.flatMap(one => others.map(two => ({ start: Math.max(one.start, two.start), end: Math.min(one.end, two.end) })))
      .filter(each => each.start < each.end).map(each => ({ ...each, whole: each.start > time[0] && each.end < end }));
  }

  /* Times within a distance from the lower end of a stroke, and from the upper one. */
  function ends(lift, distance, stroke, bothWays) {
    const lower = lift.beyond(distance, -1), upper = lift.beyond(stroke - distance, 1);
    if (!bothWays) return [lower, upper];
    return [common(lower, lift.beyond(-distance, 1)), common(upper, lift.beyond(stroke + distance, -1))];
  }

  /* The first time that a frame is at an end of its stroke without its carrier, between the spans around it. */
  function missed(lift, stroke, own, frames) {
    const every = frames.flat(), nowhere = !own.flat().length;
    const [found] = frames.flatMap((spans, place) => spans.map(span => {
      const before = Math.max(time[0], ...every.filter(each => each.end <= span.start).map(each => each.end));
      const after = Math.min(end, ...every.filter(each => each.start >= span.end).map(each => each.start));
      const there = own[place].some(each => each.end > before && each.start < after);
      return !there && (span.whole || nowhere) && { time: span.start, place, before, after };
    })).filter(Boolean).sort(byTime);
    if (!found) return null;
    const away = lift.values.reduce((least, each, k) => time[k] < found.before || time[k] > found.after ? least
      : Math.min(least, Math.abs(each - found.place * stroke)), Infinity);
    const off = `${loomfmu.general(1e3 * away, 3)} mm or more from the ${["lower", "upper"][found.place]} end of its frame's stroke`;
    return { value: 0, time: found.time, off };
  }

  /* What can be judged of spans that the ends of the run cut off, and a note. */
  function cutOff(spans, limit) {
    if (!spans.length) return [[], "the frame never gets there in this run"];
    if (spans.length === 1 && spans[0].start === time[0] && spans[0].end === end)
      return spans[0].value < limit ? [[], "the frame stays there all the time, but the run is too short to tell"]
        : [spans, "the frame stays there throughout the run"];
    const enough = spans.filter(each => each.value >= limit);
    if (enough.length === spans.length) return [enough, "cut off by an end of the run: it lasts at least this long"];
    if (enough.length) return [enough, CUT_OFF];
    return [[], "none begins and ends within the run"];
  }

  /* The least turn of the shaft during one of the spans of a motion, and a note. */
  function shortest(lift, [lower, upper], limit) {
    const spans = [...lower, ...upper].map(each => ({ ...each, time: each.start, value: turned(each) })).sort(byTime);
    let [judged, note] = [spans.filter(each => each.whole), ""];
    if (spans.some(each => !each.whole && each.value < limit)) note = CUT_OFF;
    if (!judged.length) [judged, note] = cutOff(spans, limit);
    return { ...(judged.length ? firstLowest(judged) : { value: NaN, time: NaN }), notes: [note, lift.note] };
  }

  /* Spans of a frame within a distance from an end of its stroke. */
  function span(claim, distance, instead, bothWays = false) {
    const stroke = run.parameter(`${claim.heald}.stroke`), own = claim.lifts[claim.heald], frame = `${claim.heald}.lift`;
    const lifts = [...new Set([own, frame])].map(name => motion(name));
    const places = lifts.map(lift => ends(lift, distance, stroke, bothWays));
    const [found, its] = lifts.map((lift, k) => shortest(lift, places[k], claim.at_least));
    const gone = its && Number.isFinite(its.value) ? missed(lifts[0], stroke, ...places) : null;
    const notes = gone ? [`springs and warp keep the carrier ${gone.off}; ${instead}`, lifts[0].note] : found.notes;
    if (its && Number.isFinite(its.value)) notes.push(`its frame: ${degrees(its.value)}`);
    const { value, time: when } = gone || found;
    return Number.isNaN(value) ? never(...notes) : { worst: value, bound: claim.at_least, time: when, notes };
  }

  // ---- the head in the shed, and the transfer

  const inShed = claim => {
    const travel = motion(`${claim.weft}.travel`);
    return [travel, travel.beyond(run.parameter(`${claim.belt}.idle_travel`), 1)];
  };

  /* The least opening by the lifts of the frames' warps. */
  function opening(lifts, stretches) {
    const found = Object.entries(lifts).map(([heald, lift]) => {
      const near = motion(lift).nearest(0.5 * run.parameter(`${heald}.stroke`), stretches);
      const signal = lift === `${heald}.lift` ? `2 |${heald}.warp_height|` : `2 |warp height by ${lift}|`;
      return { ...near, value: 2 * run.parameter(`${heald}.warp_ratio`) * near.value, signal };
    });
    return { ...firstLowest(found), coarse: found.some(each => each.coarse), notes: Object.values(lifts).map(lift => motion(lift).note) };
  }

  const overlapping = claim => [motion(`${claim.transfer}.overlap`), run.parameter(`${claim.transfer}.needed_overlap`)];

  // ---- each kind of claim

  const bounded = claim => {
    if (claim.at_samples) return unknown(`it is judged at the samples of a run; ${NOT_HERE}`);
    const bound = typeof claim.bound === "string" ? run.parameter(claim.bound) : claim.bound;
    const stretches = claim.window ? timesWithin(claim.window) : undefined;
    if (stretches && !stretches.length) return never(UNPASSED);
    return extreme(claim.signal, bound, claim.sense, stretches);
  };
  const judges = {
    above: bounded,
    below: bounded,
    lowest_margin: claim => {
      const latch = run.signal(`${claim.belt}.lowest_margin`);
      return { worst: last(latch), bound: claim.bound, time: reached(latch, run.signal(`${claim.belt}.margin`)),
               notes: [last(latch) >= 1 ? "the belt is never at risk in this run" : ""] };
    },
    belt_deflection: claim => {
      const [latch, pushed, folded, long] = ["largest_deflection", "largest_at_risk", "folded", "too_long"]
        .map(name => run.signal(`${claim.belt}.${name}`)), worst = last(latch);
      const notes = [`while the head was pushed: ${mm(last(pushed))}`, last(folded) ? "the belt folded" : "",
                     last(long) ? "free lengths above 5 times bow_length do not count" : ""];
      return { worst, bound: claim.at_most, time: reached(latch, run.signal(`${claim.belt}.deflection`).map(each => -each)), notes };
    },
    peak_load: claim => {
      const latch = run.signal(`${claim.damper}.peak_load`);
      const force = run.signal(`${claim.damper}.transmitted_force`).map(each => -Math.abs(each));
      return { worst: last(latch), bound: claim.at_most, time: reached(latch, force) };
    },
    stop_contacts: claim => {
      const counted = run.signal(`${claim.damper}.stop_contacts`), worst = last(counted);
      return { worst, bound: claim.at_most, time: worst > 0 ? time[counted.indexOf(worst)] : NaN };
    },
    heald_blows: claim => {
      const latch = run.signal(`${claim.play}.hardest_blow`), blows = last(run.signal(`${claim.play}.blows`)), worst = last(latch);
      return { worst, bound: claim.at_most, time: blows ? time[latch.indexOf(worst)] : NaN, notes: [`${blows} blow${blows === 1 ? "" : "s"}`] };
    },
    motor_power: claim => extreme(`${claim.motor}.motor_power`, claim.at_most, -1),
    speed_fluctuation: claim => {
      const velocity = motion("shaft.velocity"), times = timesAt(motion("shaft.angle").values[0]).slice(Math.ceil(claim.skip));
      const found = times.slice(1).map((stop, k) => {
        const [low, high] = [1, -1].map(sign => velocity.lowest(sign, [{ start: times[k], end: stop }]));
        const value = (high.value - low.value) * (stop - times[k]) / TURN;
        return { value, time: low.time, coarse: low.coarse || high.coarse };
      });
      if (!found.length) return never(velocity.note, "the run has no whole revolution to judge");
      if (found.some(each => each.coarse)) return unknown(COARSE);
      const most = found.reduce((one, other) => other.value > one.value ? other : one);
      return { worst: most.value, bound: claim.at_most, time: most.time, notes: [velocity.note] };
    },
    dwell: claim => span(claim, claim.tolerance * run.parameter(`${claim.heald}.stroke`),
      'clear_shed judges the shed that it leaves, lifted_by = "frame" the dwell of the drive', true),
    clear_shed: claim => {
      const stroke = run.parameter(`${claim.heald}.stroke`), ratio = run.parameter(`${claim.heald}.warp_ratio`);
      if (!(claim.clearance < 0.5 * stroke * ratio)) return unknown("the warp never gets that far");
      return span(claim, 0.5 * stroke - claim.clearance / ratio, 'lifted_by = "frame" judges the drive alone');
    },
    dwell_contains: claim => {
      const times = claim.angles.flatMap(timesAt), stroke = run.parameter(`${claim.heald}.stroke`);
      const missing = claim.angles.filter(angle => !timesAt(angle).length);
      if (missing.length) return never(`the run never reaches ${missing.map(degrees).join(", ")}`);
      const lifts = [...new Set([claim.lifts[claim.heald], `${claim.heald}.lift`])].map(name => motion(name));
      const [own, ...others] = lifts.map(lift => firstLowest(times.map(when => {
        const value = lift.at(when);
        return { time: when, value: -Math.min(Math.abs(value), Math.abs(stroke - value)) / stroke };
      })));
      const notes = [lifts[0].note, ...others.map(each => `its frame: ${shown(-each.value, 100, "%")}`)];
      return { worst: -own.value, bound: claim.tolerance, time: own.time, notes };
    },
    rapier_in_open_shed: claim => {
      const [travel, stretches] = inShed(claim), frames = Object.keys(claim.lifts);
      if (!stretches.length) return never(NEVER, travel.note);
      const found = opening(claim.lifts, stretches), own = Object.fromEntries(frames.map(frame => [frame, `${frame}.lift`]));
      const carried = frames.some(frame => claim.lifts[frame] !== own[frame]);
      const alone = carried ? [`the frames: ${mm(opening(own, stretches).value)}`] : [];
      if (found.coarse) return unknown(COARSE);
      const { value, time: when, signal, notes } = found;
      return { worst: value, bound: claim.head_height, time: when, signal, notes: [travel.note, ...notes, ...alone] };
    },
    reed_clear_of_rapier: claim => {
      const [travel, stretches] = inShed(claim), position = motion(`${claim.reed}.position`);
      if (!stretches.length) return never(NEVER, travel.note);
      const foremost = position.lowest(-1, stretches);
      if (foremost.coarse) return unknown(COARSE);
      return { worst: last(run.signal(`${claim.reed}.front_limit`)) - foremost.value, bound: claim.clearance,
               time: foremost.time, notes: [travel.note, position.note] };
    },
    transfer_in_time: claim => {
      const [overlap, bound] = overlapping(claim), found = passes(claim.window).map(each => overlap.lowest(-1, [each]));
      if (!found.length) return never(overlap.note, UNPASSED);
      if (found.some(each => each.coarse)) return unknown(COARSE);
      const { value, time: when } = firstLowest(found);
      const during = overlap.beyond(bound, 1).filter(each => each.whole && each.start <= when && when <= each.end)
        .map(each => `hand-over from ${degrees(angleAt(each.start))} to ${degrees(angleAt(each.end))}`);
      return { worst: value, bound, time: when, notes: [overlap.note, ...during] };
    },
    transfer_speed: claim => {
      const [overlap, needed] = overlapping(claim), closing = motion(`${claim.transfer}.closing_velocity`);
      const during = overlap.beyond(needed, 1);
      if (!during.length) return never(overlap.note, "the heads never overlap by what the hooks need in this run");
      const [low, high] = [1, -1].map(sign => closing.lowest(sign, during));
      if (low.coarse || high.coarse) return unknown(COARSE);
      const found = Math.abs(high.value) > Math.abs(low.value) ? high : low;
      return { worst: Math.abs(found.value), bound: claim.at_most, time: found.time, notes: [overlap.note, closing.note] };
    },
    nip_holds: claim => {
      if (!claim.at_samples) return unknown(`the forces of the nip are known only at the samples; ${NOT_HERE}`);
      const [drafting, holding] = ["drafting_force", "holding_force"].map(name => motion(`${claim.roller}.${name}`));
      const most = drafting.lowest(-1);
      if (!(most.value > 0)) return never("no fibres are drafted in this run");
      const held = holding.lowest(-1, drafting.beyond(0, 1)), worst = held.value / most.value;
      if (most.coarse || held.coarse) return unknown(COARSE);
      const high = worst - claim.at_least > claim.at_most - worst;
      return { worst, bound: high ? claim.at_most : claim.at_least, sense: high ? -1 : 1, time: most.time,
               notes: [] };
    },
    locks_in_time: claim => {
      const limit = last(run.signal(`${claim.lock}.speed_limit`)), inTime = run.signal(`${claim.lock}.in_time`);
      const follows = claim.signal === "shaft.velocity"
        && run.signal("shaft.velocity").every((speed, k) => (Math.abs(speed) <= limit) === (inTime[k] > 0));
      if (!follows) return unknown(`the lock does not follow shaft.velocity; ${NOT_HERE}`);
      const velocity = motion("shaft.velocity", 1), [low, high] = [1, -1].map(sign => velocity.lowest(sign));
      const found = Math.abs(high.value) > Math.abs(low.value) ? high : low;
      if (found.coarse) return unknown(COARSE);
      return { worst: Math.abs(found.value), bound: limit, time: found.time, notes: [velocity.note] };
    },
  };

  /* Whether the numerical error may decide a verdict: what runs on other steps show of it, the page knows at the scene's
   * own values only. */
  function tooNear(claim, verdict) {
    const { kind, native } = claim, { worst, bound } = verdict, distance = Math.abs(worst - bound);
    if (distance === 0 && (native.met || kind === "stop_contacts")) return false;
    return distance <= Math.max(FAR_ABOVE * native.error, NEAR * Math.abs(bound), unresolved(claim, verdict));
  }

  /* How far the signal may be off whatever the steps. */
  function unresolved({ window, signal: its, drawn }, verdict) {
    const signal = verdict.signal || its, stretches = window ? timesWithin(window) : undefined;
    return drawn && signal === its ? offBy(signal, verdict, stretches) : 0;
  }

  /* What the run does not show of all that a claim takes: a whole revolution, or a pass through its window, and the
   * repeat of the weave that it depends on. */
  function unseen({ kind, window, repeat }) {
    const shown = kind === "dwell_contains" || window && passes(window).length;
    if (window && !shown && revolutions < 1 - STANDS) return UNPASSED;
    return !shown && turnsLess(1, "and the claim takes a whole one")
      || repeat > 1 && turnsLess(repeat, `and the weave repeats after ${repeat}; set revolutions = ${repeat} or more`);
  }

  function turnsLess(wanted, why) {
    const some = `${loomfmu.general(revolutions, 3)} revolution${revolutions === 1 ? "" : "s"}`;
    return revolutions < wanted - STANDS && `the shaft turns by only ${some}, ${why}`;
  }

  const turns = run.has("shaft.angle") ? run.signal("shaft.angle") : [];
  const revolutions = turns.length ? (Math.max(...turns) - Math.min(...turns)) / TURN : Infinity;
  const tooCoarse = turns.some((angle, k) => k && Math.abs(angle - turns[k - 1]) > FARTHEST);

  return claim => {
    const judge = judges[claim.kind];
    if (!judge) return unknown(`the page does not judge ${claim.kind}; ${NOT_HERE}`);
    if (claim.left) return unknown(`the page would judge it unlike the native run; ${NOT_HERE}`);
    if (tooCoarse || claim.native.coarse) return unknown(COARSE);
    const found = judge(claim);
    if (found.holds === null) return never(unseen(claim), found.note);
    const at = run.has("shaft.angle") && Number.isFinite(found.time) ? motion("shaft.angle").at(found.time) : NaN;
    const verdict = { sense: claim.sense, at, ...found, note: joined(found.notes || []) };
    if (!Number.isFinite(verdict.worst)) return unknown(`there is no value to judge; ${NOT_HERE}`);
    const holds = verdict.sense * verdict.worst >= verdict.sense * verdict.bound, signal = verdict.signal || claim.signal;
    const short = (holds || NOT_FINAL.includes(claim.kind)) && unseen(claim);
    if (short) return never(short, verdict.note);
    // a part of a run that is not known cannot bring a claim back that fails
    if (holds && !claim.window && gaps(signal)) return gap(signal);
    const doubts = (found.notes || []).filter(each => each === CUT_OFF || each?.endsWith(loomfmu.ONLY_SAMPLES));
    if (holds && doubts.length) return unknown(`${doubts[0]}; ${NOT_HERE}`);
    if (tooNear(claim, verdict)) return unknown(`it is nearer to its bound, ${loomfmu.shownIn(claim, verdict.bound)}, than the page can tell; ${NOT_HERE}`);
    return { ...verdict, holds };
  };
};
