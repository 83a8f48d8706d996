/* The claims after each run. A verdict is given where the outputs hold it exactly or the curve between the samples
 * decides it; everything else is left to `loomfmu run`, and said so. */
(() => {
  const { claims } = loomfmu.live.plan, TURN = 2 * Math.PI, DEGREE = Math.PI / 180, ALIKE = 1e-8;
  const rows = document.querySelectorAll("#claims tbody tr"), outcome = document.querySelector("#claims .outcome");
  const last = values => values[values.length - 1], NOT_HERE = "loomfmu run judges it";
  const NEVER = "the head never enters the shed in this run";
  const COARSE = "the samples are too far apart to be sure", FARTHEST = TURN / 20 * (1 + 1e-11);

  const FAR_ABOVE = 10, NEAR = 1e-4; // of the error at the scene's own values, and of the bound

  // ---- what claims have in common

  let kept = new Map(), checked = false;
  const motion = (run, name) => {
    if (!kept.has(name)) kept.set(name, loomfmu.motion(run, name));
    return kept.get(name);
  };
  const unknown = note => ({ holds: null, note });
  const never = (bound, note) => ({ holds: false, worst: NaN, bound, note }); // a claim without a value fails
  const short = value => String(Number(value.toPrecision(7)));
  const shownIn = ({ shown: { factor, unit } }, value) =>
    Number.isNaN(value) ? "no value" : `${short(value * factor)}${unit && ` ${unit}`}`;

  /* All times at which the shaft stands at an angle of its revolution. */
  function timesAt(run, wanted) {
    const turning = motion(run, "shaft.angle"), { values, time } = turning, found = new Set();
    const low = Math.min(values[0], last(values)), high = Math.max(values[0], last(values));
    for (let turn = Math.floor((low - wanted) / TURN) - 1; wanted + turn * TURN <= high + 1e-8; turn++) {
      const level = wanted + turn * TURN;
      const ends = [0, values.length - 1].filter(end => Math.abs(values[end] - level) < 1e-9 * TURN);
      if (ends.length) ends.forEach(end => found.add(time[end]));
      else if (level > low) turning.passages(level).forEach(when => found.add(when));
    }
    return [...found].sort((one, other) => one - other);
  }

  function timesWithin(run, [start, end]) {
    const width = Math.min(end > start ? end - start : (end - start + TURN) % TURN, TURN), turning = motion(run, "shaft.angle");
    const edges = [...timesAt(run, start), ...timesAt(run, start + width)];
    const marks = [...new Set([run.time[0], ...edges, last(run.time)])].sort((one, other) => one - other);
    const inside = marks.slice(1).map((mark, k) => ({ start: marks[k], end: mark })).filter(stretch => {
      const away = turning.at(0.5 * (stretch.start + stretch.end)) - start;
      return away - TURN * Math.floor(away / TURN) <= width;
    });
    return [...inside, ...edges.map(edge => ({ start: edge, end: edge }))];
  }

  /* When a latched extreme was reached: the vertex of the parabola through the lowest samples of what it follows. */
  function reached(run, latch, followed) {
    const { time } = run, end = last(latch), scale = ALIKE * followed.reduce((most, each) => Math.max(most, Math.abs(each)), 0);
    const step = latch.findIndex(each => Math.abs(each - end) <= scale);
    if (step === 0) return time[0];
    const k = followed[step] <= followed[step - 1] ? step : step - 1;
    if (k <= 0 || k >= time.length - 1) return time[k];
    const before = (followed[k] - followed[k - 1]) / (time[k] - time[k - 1]);
    const after = (followed[k + 1] - followed[k]) / (time[k + 1] - time[k]);
    if (after <= before) return time[k];
    const turn = 0.5 * (time[k - 1] + time[k]) - 0.5 * before * (time[k + 1] - time[k - 1]) / (after - before);
    return Math.min(Math.max(turn, time[step - 1]), time[step]);
  }

  /* What both have in common of some stretches of time and others. */
  function common({ time }, some, others) {
    return some.flatMap(one => others.map(two => ({ start: Math.max(one.start, two.start), end: Math.min(one.end, two.end) })))
      .filter(({ start, end }) => start < end)
      .map(({ start, end }) => ({ start, end, whole: start > time[0] && end < last(time) }));
  }

  /* Times within a distance from the lower end of a stroke, and from the upper one. */
  function ends(run, lift, distance, stroke, bothWays) {
    const lower = lift.beyond(distance, -1), upper = lift.beyond(stroke - distance, 1);
    if (!bothWays) return [lower, upper];
    return [common(run, lower, lift.beyond(-distance, 1)), common(run, upper, lift.beyond(stroke + distance, -1))];
  }

  /* When a frame is first at an end of its stroke without its carrier, between the spans around it. */
  function missed(run, own, frames) {
    const every = frames.flat(), nowhere = !own.flat().length;
    return frames.flatMap((spans, end) => spans.filter(span => {
      const before = Math.max(run.time[0], ...every.filter(each => each.end <= span.start).map(each => each.end));
      const after = Math.min(last(run.time), ...every.filter(each => each.start >= span.end).map(each => each.start));
      return (span.whole || nowhere) && !own[end].some(each => each.end > before && each.start < after);
    })).map(span => span.start).sort((one, other) => one - other)[0];
  }

  /* Spans of a frame within a distance from an end of its stroke: those that begin and end in the run are judged. */
  function span(run, claim, distance, bothWays = false) {
    const turning = motion(run, "shaft.angle"), stroke = run.parameter(`${claim.heald}.stroke`);
    const [own, frames] = [claim.lifts[claim.heald], `${claim.heald}.lift`]
      .map(signal => ends(run, motion(run, signal), distance, stroke, bothWays));
    const spans = own.flat().filter(each => each.whole)
      .map(each => ({ turned: Math.abs(turning.at(each.end) - turning.at(each.start)), time: each.start }))
      .sort((one, other) => one.time - other.time);
    const late = missed(run, own, frames);
    if (late !== undefined) return { worst: 0, bound: claim.at_least, time: late };
    if (!own.flat().length) return never(claim.at_least, "the frame never gets there in this run");
    if (!spans.length) return unknown(`no such span begins and ends within the run; ${NOT_HERE}`);
    const worst = Math.min(...spans.map(each => each.turned));
    return { worst, bound: claim.at_least, time: spans.find(each => each.turned <= worst + 1e-11).time };
  }

  /* Whether a signal is not known somewhere, or in some stretches of time: a signal of its own says so. */
  function gaps(run, signal, within) {
    const flag = run.validity(signal), { time } = run;
    return Boolean(flag) && run.signal(flag).some((known, k) => !known && (within || [{ start: time[0], end: last(time) }])
      .some(({ start, end }) => (time[k - 1] ?? time[0]) < end && start < (time[k + 1] ?? last(time))));
  }
  const gap = (run, signal) => unknown(`${signal} is not known: ${run.validity(signal)} is no; ${NOT_HERE}`);

  function extreme(run, signal, bound, sense, within) {
    if (gaps(run, signal, within)) return gap(run, signal);
    const found = motion(run, signal).lowest(sense, within);
    const between = sense * found.value < sense * bound && sense * found.sample >= sense * bound;
    if (found.coarse || between) return unknown(`it is decided between the samples; ${NOT_HERE}`);
    return { worst: found.value, bound, time: found.time };
  }

  const inShed = (run, claim) =>
    motion(run, `${claim.weft}.travel`).beyond(run.parameter(`${claim.belt}.idle_travel`), 1);

  // ---- each kind of claim

  const bounded = (run, claim) => {
    const bound = typeof claim.bound === "string" ? run.parameter(claim.bound) : claim.bound;
    return extreme(run, claim.signal, bound, claim.sense, claim.window ? timesWithin(run, claim.window) : undefined);
  };
  const judges = {
    above: bounded,
    below: bounded,
    lowest_margin: (run, claim) => {
      const latch = run.signal(`${claim.belt}.lowest_margin`);
      return { worst: last(latch), bound: claim.bound, time: reached(run, latch, run.signal(`${claim.belt}.margin`)),
               note: last(latch) >= 1 ? "the belt is never at risk in this run" : "" };
    },
    belt_deflection: (run, claim) => {
      const latch = run.signal(`${claim.belt}.largest_deflection`);
      const deflection = run.signal(`${claim.belt}.deflection`).map(each => -each);
      return { worst: last(latch), bound: claim.at_most, time: reached(run, latch, deflection),
               note: [last(run.signal(`${claim.belt}.folded`)) ? "the belt folded" : "",
                      last(run.signal(`${claim.belt}.too_long`)) ? "free lengths above 5 times bow_length do not count" : ""]
                 .filter(Boolean).join("; ") };
    },
    peak_load: (run, claim) => {
      const latch = run.signal(`${claim.damper}.peak_load`);
      const force = run.signal(`${claim.damper}.transmitted_force`).map(each => -Math.abs(each));
      return { worst: last(latch), bound: claim.at_most, time: reached(run, latch, force) };
    },
    stop_contacts: (run, claim) => {
      const counted = run.signal(`${claim.damper}.stop_contacts`), worst = last(counted);
      return { worst, bound: claim.at_most, time: worst > 0 ? run.time[counted.indexOf(worst)] : NaN };
    },
    heald_blows: (run, claim) => {
      const latch = run.signal(`${claim.play}.hardest_blow`), blows = last(run.signal(`${claim.play}.blows`)), worst = last(latch);
      return { worst, bound: claim.at_most, time: blows ? run.time[latch.indexOf(worst)] : NaN, note: `${blows} blows` };
    },
    motor_power: (run, claim) => extreme(run, `${claim.motor}.motor_power`, claim.at_most, -1),
    dwell: (run, claim) => span(run, claim, claim.tolerance * run.parameter(`${claim.heald}.stroke`), true),
    clear_shed: (run, claim) => {
      const stroke = run.parameter(`${claim.heald}.stroke`), ratio = run.parameter(`${claim.heald}.warp_ratio`);
      if (!(claim.clearance < 0.5 * stroke * ratio)) return unknown("the warp never gets that far");
      return span(run, claim, 0.5 * stroke - claim.clearance / ratio);
    },
    dwell_contains: (run, claim) => {
      const lift = motion(run, claim.lifts[claim.heald]), stroke = run.parameter(`${claim.heald}.stroke`);
      const found = claim.angles.flatMap(angle => timesAt(run, angle)).map(time => {
        const value = lift.at(time);
        return { time, away: Math.min(Math.abs(value), Math.abs(stroke - value)) / stroke };
      }).sort((one, other) => one.time - other.time);
      if (!found.length) return never(claim.tolerance, "the run never reaches these angles");
      const worst = Math.max(...found.map(each => each.away));
      return { worst, bound: claim.tolerance, time: found.find(each => each.away >= worst - 1e-11).time };
    },
    rapier_in_open_shed: (run, claim) => {
      const within = inShed(run, claim);
      if (!within.length) return never(claim.head_height, NEVER);
      const found = Object.entries(claim.lifts).map(([heald, lift]) => {
        const near = motion(run, lift).nearest(0.5 * run.parameter(`${heald}.stroke`), within);
        const signal = lift === `${heald}.lift` ? `2 |${heald}.warp_height|` : `2 |warp height by ${lift}|`;
        return { ...near, value: 2 * run.parameter(`${heald}.warp_ratio`) * near.value, signal };
      });
      if (found.some(each => each.coarse)) return unknown(COARSE);
      const worst = Math.min(...found.map(each => each.value));
      const [{ time, signal }] = found.filter(each => each.value <= worst + 1e-11).sort((one, other) => one.time - other.time);
      return { worst, bound: claim.head_height, time, signal };
    },
    reed_clear_of_rapier: (run, claim) => {
      const within = inShed(run, claim);
      if (!within.length) return never(claim.clearance, NEVER);
      const foremost = motion(run, `${claim.reed}.position`).lowest(-1, within);
      if (foremost.coarse) return unknown(COARSE);
      return { worst: last(run.signal(`${claim.reed}.front_limit`)) - foremost.value, bound: claim.clearance, time: foremost.time };
    },
    transfer_in_time: (run, claim) => {
      const within = timesWithin(run, claim.window), overlap = motion(run, `${claim.transfer}.overlap`);
      const edges = new Set(within.filter(({ start, end }) => start === end).map(each => each.start));
      const found = within.filter(({ start, end }) => start < end && edges.has(start) && edges.has(end))
        .map(each => overlap.lowest(-1, [each]));
      const bound = run.parameter(`${claim.transfer}.needed_overlap`);
      if (!found.length) return never(bound, "the run never passes through the whole window");
      if (found.some(each => each.coarse)) return unknown(COARSE);
      const worst = Math.min(...found.map(each => each.value));
      const time = Math.min(...found.filter(each => each.value <= worst + 1e-11).map(each => each.time));
      return { worst, bound, time };
    },
    transfer_speed: (run, claim) => {
      const needed = run.parameter(`${claim.transfer}.needed_overlap`);
      const during = motion(run, `${claim.transfer}.overlap`).beyond(needed, 1);
      if (!during.length) return never(claim.at_most, "the heads never overlap by what the hooks need in this run");
      const [low, high] = [1, -1].map(sign => motion(run, `${claim.transfer}.closing_velocity`).lowest(sign, during));
      const found = Math.abs(high.value) > Math.abs(low.value) ? high : low;
      return low.coarse || high.coarse ? unknown(COARSE) : { worst: Math.abs(found.value), bound: claim.at_most, time: found.time };
    },
    locks_in_time: (run, claim) => {
      if (claim.signal !== "shaft.velocity") return unknown(`the lock does not follow shaft.velocity; ${NOT_HERE}`);
      const limit = last(run.signal(`${claim.lock}.speed_limit`)), inTime = run.signal(`${claim.lock}.in_time`);
      const speed = run.signal("shaft.velocity");
      if (inTime.some((each, k) => (Math.abs(speed[k]) <= limit) !== (each > 0))) return unknown(`the lock does not follow shaft.velocity; ${NOT_HERE}`);
      const [low, high] = [1, -1].map(sign => motion(run, "shaft.velocity").lowest(sign));
      const found = Math.abs(low.value) > Math.abs(high.value) ? low : high;
      return found.coarse ? unknown(COARSE) : { worst: Math.abs(found.value), bound: limit, time: found.time };
    },
  };

  function judged(run, claim) {
    const judge = judges[claim.kind], angle = run.has("shaft.angle") ? run.signal("shaft.angle") : [];
    if (!judge) return unknown(`the page does not judge ${claim.kind}; ${NOT_HERE}`);
    if (claim.left) return unknown(`the page would judge it unlike the native run; ${NOT_HERE}`);
    for (let k = 1; k < angle.length; k++)
      if (Math.abs(angle[k] - angle[k - 1]) > FARTHEST) return unknown(COARSE);
    const found = judge(run, claim);
    if (found.holds !== undefined) return found;
    if (!Number.isFinite(found.worst)) return unknown(`there is no value to judge; ${NOT_HERE}`);
    const holds = claim.sense * found.worst >= claim.sense * found.bound, signal = found.signal || claim.signal;
    // a part of a run that is not known cannot bring a claim back that fails
    if (holds && !claim.window && gaps(run, signal)) return gap(run, signal);
    if (tooNear(claim, found)) return unknown(`it is nearer to its bound, ${shownIn(claim, found.bound)}, than the page can tell; ${NOT_HERE}`);
    return { ...found, holds };
  }

  /* Whether the numerical error may decide a verdict: the page knows it at the scene's own values only. */
  function tooNear({ kind, native }, { worst, bound }) {
    const distance = Math.abs(worst - bound), met = native.met || kind === "stop_contacts";
    return !(met && distance === 0) && distance <= Math.max(FAR_ABOVE * native.error, NEAR * Math.abs(bound));
  }

  /* A claim that is judged otherwise than loomfmu did at the scene's own values is left out from then on. */
  function check(claim, { holds, worst }) {
    const { native } = claim, scale = Math.max(Math.abs(native.worst), Math.abs(worst));
    const same = native.worst === null ? Number.isNaN(worst) : Math.abs(worst - native.worst) <= 1e-6 * scale;
    claim.left = holds !== null && !(holds === native.holds && same);
  }

  // ---- the table

  function place(run, time) {
    if (!Number.isFinite(time)) return null;
    const text = `${Number(time.toPrecision(6))} s`;
    if (!loomfmu.turns) return { text, position: time };
    const at = motion(run, "shaft.angle").at(time), turn = Math.floor(at / TURN);
    const first = Math.floor(run.signal("shaft.angle")[0] / TURN), degrees = ((at - turn * TURN) / DEGREE).toFixed(3);
    return { text: `${text}, ${degrees} deg, rev. ${turn - first + 1}`, position: at };
  }

  function show(row, claim, verdict) {
    const [word, name, worst, bound, distance, where] = row.cells;
    const shown = value => shownIn(claim, value), code = name.querySelector("code");
    const known = verdict.holds !== null;
    word.className = known ? (verdict.holds ? "holds" : "fails") : "";
    word.replaceChildren();
    const mark = document.createElement("span");
    mark.className = "mark";
    mark.setAttribute("aria-hidden", "true");
    word.append(...(known ? [mark, verdict.holds ? "holds" : "FAILS"] : ["not judged"]));
    code.textContent = verdict.signal || claim.signal;
    for (const old of name.querySelectorAll("small, code + br")) old.remove();
    if (verdict.note) {
      const note = document.createElement("small");
      note.textContent = verdict.note;
      name.append(document.createElement("br"), note);
    }
    const gap = claim.sense * (verdict.worst - verdict.bound), share = 100 * gap / Math.abs(verdict.bound);
    worst.textContent = known ? shown(verdict.worst) : "–";
    bound.textContent = known ? shown(verdict.bound) : "–";
    distance.textContent = !known ? "–" : shown(gap)
      + (verdict.bound && !Number.isNaN(gap) ? ` (${share < 0 ? "" : "+"}${share.toFixed(1)}%)` : "");
    where.textContent = "–";
    if (verdict.place) {
      const button = document.createElement("button");
      button.type = "button";
      button.className = "place";
      button.dataset.position = verdict.place.position;
      button.title = "Move the cursor there";
      button.textContent = verdict.place.text;
      where.replaceChildren(button);
    }
  }

  function conclude(verdicts, failed) {
    const failing = verdicts.filter(each => each.holds === false).length, all = verdicts.length;
    const open = verdicts.filter(each => each.holds === null).length;
    const text = failed ? "Not judged: these values cannot be run" : !all ? "No claims"
      : failing ? `${failing} of ${all} claims fail${failing === 1 ? "s" : ""}`
      : open ? `${all - open} of ${all} claims hold` : all === 1 ? "The claim holds" : `All ${all} claims hold`;
    const mark = outcome.querySelector(".mark");
    outcome.replaceChildren(mark, text + (open && !failed ? `, ${open} not judged here` : ""));
    outcome.className = `outcome ${failed || !all ? "unknown" : failing ? "fails" : open ? "unknown" : "holds"}`;
  }

  /* Bounds of the claims on a signal, as the plots draw them: a line for each, empty where it is not judged. */
  loomfmu.live.bounds = name => (loomfmu.live.verdicts || []).flatMap(({ bound, holds }, number) => {
    const { signal, drawn, shown: { factor, unit } } = claims[number];
    if (signal !== name || !drawn) return [];
    if (holds === null) return [{ value: null, text: "", holds }];
    return [{ value: bound * factor, text: `bound ${short(bound * factor)}${unit && ` ${unit}`}`, holds }];
  });

  /* Where the claim is that is nearest to its bound, or farthest beyond it; null where none is judged. */
  loomfmu.live.worst = () => {
    const away = (verdict, number) =>
      claims[number].sense * (verdict.worst - verdict.bound) / (Math.abs(verdict.bound) || 1);
    const [nearest] = (loomfmu.live.verdicts || [])
      .map((verdict, number) => ({ verdict, away: away(verdict, number) }))
      .filter(({ verdict }) => verdict.holds !== null && verdict.place)
      .sort((one, other) => one.verdict.holds - other.verdict.holds || one.away - other.away);
    return nearest ? nearest.verdict.place.position : null;
  };

  outcome.setAttribute("aria-live", "polite");
  loomfmu.live.follow("claims", run => {
    kept = new Map();
    if (run && !checked) {
      for (const claim of claims) check(claim, judged(run, claim));
      checked = true;
    }
    const verdicts = claims.map(claim => run ? judged(run, claim) : unknown("these values cannot be run"));
    verdicts.forEach((verdict, number) => {
      if (verdict.holds !== null) verdict.place = place(run, verdict.time);
      show(rows[number], claims[number], verdict);
    });
    conclude(verdicts, !run);
    loomfmu.live.verdicts = verdicts;
  });
})();
