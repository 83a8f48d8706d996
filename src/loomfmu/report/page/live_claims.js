/* The claims after each run, in the table of the report. */
/* A number as Python's format g writes it. */
loomfmu.general = (value, digits = 7) => {
  const power = Number(value.toExponential(digits - 1).split("e")[1]), long = power < -4 || power >= digits;
  const text = long ? value.toExponential(digits - 1) : value.toFixed(digits - 1 - power);
  const short = text.includes(".") ? text.replace(/\.?0+(?=e|$)/, "") : text;
  return short.replace(/e([+-])(\d)$/, "e$10$2");
};
/* The digits of a value that its error allows, as display/printed.py counts them. */
loomfmu.digits = (value, error) => {
  const known = error > 0 && error < Infinity && value, power = number => Math.floor(Math.log10(number));
  return known ? Math.min(Math.max(power(Math.abs(value)) - power(2 * error) + 1, 1), 7) : 7;
};
/* A value of a verdict with its unit, and the digits that its error allows. */
loomfmu.shownIn = ({ factor, unit }, value, error = 0) =>
  Number.isFinite(value) ? `${loomfmu.general(Number((value * factor).toPrecision(loomfmu.digits(value * factor, error * factor))))}${unit && ` ${unit}`}` : "no value";
(() => {
  const { claims } = loomfmu.live.plan.judging, DEGREE = Math.PI / 180;

  const rows = document.querySelectorAll("#claims tbody tr"), outcome = document.querySelector(".outcome");
  document.getElementById("live-knobs").before(outcome); // in sight with the sliders
  const kept = [], bases = []; // verdicts, and the samples that they are of
  let checked = false;

  /* A claim that is judged otherwise than loomfmu did at the scene's own values is left out from then on. */
  function check(claim, { holds, worst }) {
    const { native, noise } = claim, scale = Math.max(Math.abs(native.worst), Math.abs(worst));
    const same = native.worst === null ? Number.isNaN(worst) : Math.abs(worst - native.worst) <= 1e-6 * scale + noise;
    claim.unlike = !(holds === (native.decided ? native.holds : null) && same);
  }

  function placeOf({ time, angle, revolution }) {
    const text = `${loomfmu.general(time, 6)} s`;
    return Number.isNaN(angle) ? text : `${text}, ${(angle / DEGREE).toFixed(3)} deg, rev. ${revolution}`;
  }

  const wordOf = ({ holds, waits, left }) =>
    waits ? "computing" : left ? "not judged" : holds === null ? "undecided" : holds ? "holds" : "FAILS";

  function line(tag, text) {
    const made = document.createElement(tag);
    made.textContent = text;
    return [document.createElement("br"), made];
  }

  function show(row, claim, verdict) {
    const [word, name, worst, bound, distance, where] = row.cells, { form = claim.forms[0], place: at } = verdict;
    const shown = value => loomfmu.shownIn(form, value, verdict.error), code = name.querySelector("code"), known = verdict.form;
    word.className = { holds: "holds", FAILS: "fails", undecided: "undecided" }[wordOf(verdict)] || "";
    word.replaceChildren();
    const mark = document.createElement("span");
    mark.className = "mark";
    mark.setAttribute("aria-hidden", "true");
    word.append(...(word.className ? [mark] : []), wordOf(verdict));
    code.textContent = form.signal;
    for (const old of name.querySelectorAll("small, code + br")) old.remove();
    if (verdict.note) name.append(...line("small", verdict.note));
    const { distance: gap } = verdict, share = 100 * gap / Math.abs(verdict.bound);
    worst.textContent = known ? shown(verdict.worst) : "–";
    bound.textContent = known ? loomfmu.shownIn(form, verdict.bound) : "–";
    distance.textContent = !known ? "–" : shown(gap)
      + (verdict.bound && Number.isFinite(gap) ? ` (${share < 0 ? "" : "+"}${share.toFixed(1)} %)` : "");
    if (Number.isFinite(verdict.error)) distance.append(...line("small", `error ${loomfmu.shownIn(form, verdict.error, verdict.error)}`));
    where.textContent = "–";
    if (at) {
      const button = document.createElement("button");
      button.type = "button";
      button.className = "place";
      button.dataset.position = at.position;
      button.title = "Move the cursor there";
      button.textContent = at.text;
      where.replaceChildren(button);
    }
  }

  function conclude(verdicts, failed) {
    const count = word => verdicts.filter(each => wordOf(each) === word).length, all = verdicts.length;
    const failing = count("FAILS"), undecided = count("undecided"), left = count("not judged"), waiting = count("computing");
    const open = undecided + left + waiting, of = ` of ${all} claims`, is = undecided === 1 ? "is" : "are";
    const text = failed ? ["Not judged: these values cannot be run"] : !all ? ["No claims"]
      : !failing && !open ? [all === 1 ? "The claim holds" : `All ${all} claims hold`]
      : [failing ? `${failing}${of} fail${failing === 1 ? "s" : ""}` : !undecided && `${all - open}${of} hold`,
         undecided && `${undecided}${failing ? "" : of} ${is} undecided`, left && `${left} not judged here`, waiting && `${waiting} being computed`];
    outcome.replaceChildren(outcome.querySelector(".mark"), text.filter(Boolean).join(", "));
    outcome.className = `outcome ${failed || !all ? "unknown" : failing ? "fails" : open ? "unknown" : "holds"}`;
  }

  /* Bounds of the claims on a signal, as the plots draw them: a line for each, empty where it is undecided. */
  loomfmu.live.bounds = name => (loomfmu.live.verdicts || []).flatMap(({ bound, worst, holds, form, place }, number) => {
    const its = form || claims[number].forms[0];
    if ((its.signal !== name && its.curve !== name) || !its.drawn) return [];
    if (holds === null) return [{ value: null, text: "", holds }];
    const text = `bound ${loomfmu.shownIn(its, bound)}`, at = place ? place.position : null;
    return [{ value: bound * its.factor, text, holds, sense: its.sense, worst: worst * its.factor, at }];
  });

  function verdictOf(run, judge, claim) {
    const waiting = run ? claim.parts.filter(run.waits) : [];
    if (!run) return { holds: null, left: true, note: "these values cannot be run" };
    if (waiting.length) return { holds: null, waits: true, note: `${waiting.join(", ")} still being stepped` };
    const verdict = judge(claim), { time } = verdict;
    if (!Number.isFinite(time)) return verdict;
    return { ...verdict, place: { text: placeOf(verdict), position: loomfmu.interpolate(run.time, run.positions, time) } };
  }

  outcome.setAttribute("aria-live", "polite");
  loomfmu.live.follow("claims", run => {
    const judge = run && loomfmu.live.judge(run, !loomfmu.live.changed().length);
    if (run && !checked) {
      for (const claim of claims) check(claim, judge(claim));
      checked = true;
    }
    const verdicts = claims.map((claim, number) => {
      const basis = run ? claim.parts.map(part => run.waits(part) ? "waits" : run.count(part)).join() : "none";
      if (basis === bases[number]) return kept[number]; // of the same samples
      bases[number] = basis;
      kept[number] = verdictOf(run, judge, claim);
      show(rows[number], claim, kept[number]);
      return kept[number];
    });
    conclude(verdicts, !run);
    for (const output of document.querySelectorAll("output[data-claim]")) { // captions of drawings
      const { form, worst, error } = verdicts[output.dataset.claim];
      output.textContent = form ? loomfmu.shownIn(form, worst, error) : "–";
    }
    loomfmu.live.verdicts = verdicts;
  });
})();
