/* The claims after each run, in the table of the report. */
/* A number as Python's format g writes it. */
loomfmu.general = (value, digits = 7) => {
  const power = Number(value.toExponential(digits - 1).split("e")[1]), long = power < -4 || power >= digits;
  const text = long ? value.toExponential(digits - 1) : value.toFixed(digits - 1 - power);
  const short = text.includes(".") ? text.replace(/\.?0+(?=e|$)/, "") : text;
  return short.replace(/e([+-])(\d)$/, "e$10$2");
};
/* A value of a claim with its unit. */
loomfmu.shownIn = ({ shown: { factor, unit } }, value) =>
  Number.isNaN(value) ? "no value" : `${loomfmu.general(value * factor)}${unit && ` ${unit}`}`;
(() => {
  const { claims } = loomfmu.live.plan, TURN = 2 * Math.PI, DEGREE = Math.PI / 180;

  const rows = document.querySelectorAll("#claims tbody tr"), outcome = document.querySelector("#claims .outcome");
  const kept = [], bases = []; // verdicts, and the samples that they are of
  let checked = false;

  /* A claim that is judged otherwise than loomfmu did at the scene's own values is left out from then on. */
  function check(claim, { holds, worst }) {
    const { native } = claim, scale = Math.max(Math.abs(native.worst), Math.abs(worst));
    const same = native.worst === null ? Number.isNaN(worst) : Math.abs(worst - native.worst) <= 1e-6 * scale;
    claim.left = holds !== null && !(holds === native.holds && same);
  }

  function place(run, { time, at }) {
    if (!Number.isFinite(time)) return null;
    const text = `${loomfmu.general(time, 6)} s`;
    if (!loomfmu.turns) return { text, position: time };
    const turn = Math.floor(at / TURN), first = Math.floor(run.signal("shaft.angle")[0] / TURN);
    return { text: `${text}, ${((at - turn * TURN) / DEGREE).toFixed(3)} deg, rev. ${turn - first + 1}`, position: at };
  }

  function show(row, claim, verdict) {
    const [word, name, worst, bound, distance, where] = row.cells;
    const shown = value => loomfmu.shownIn(claim, value), code = name.querySelector("code");
    const known = verdict.holds !== null, unknown = verdict.waits ? "computing" : "not judged";
    word.className = known ? (verdict.holds ? "holds" : "fails") : "";
    word.replaceChildren();
    const mark = document.createElement("span");
    mark.className = "mark";
    mark.setAttribute("aria-hidden", "true");
    word.append(...(known ? [mark, verdict.holds ? "holds" : "FAILS"] : [unknown]));
    code.textContent = verdict.signal || claim.signal;
    for (const old of name.querySelectorAll("small, code + br")) old.remove();
    if (verdict.note) {
      const note = document.createElement("small");
      note.textContent = verdict.note;
      name.append(document.createElement("br"), note);
    }
    const gap = verdict.sense * (verdict.worst - verdict.bound), share = 100 * gap / Math.abs(verdict.bound);
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
    const open = verdicts.filter(each => each.holds === null).length, waiting = verdicts.filter(each => each.waits).length;
    const text = failed ? "Not judged: these values cannot be run" : !all ? "No claims"
      : failing ? `${failing} of ${all} claims fail${failing === 1 ? "s" : ""}`
      : open ? `${all - open} of ${all} claims hold` : all === 1 ? "The claim holds" : `All ${all} claims hold`;
    const mark = outcome.querySelector(".mark");
    const rest = [open > waiting && `${open - waiting} not judged here`, waiting && `${waiting} being computed`];
    outcome.replaceChildren(mark, [text, ...rest.filter(each => each && !failed)].join(", "));
    outcome.className = `outcome ${failed || !all ? "unknown" : failing ? "fails" : open ? "unknown" : "holds"}`;
  }

  /* Bounds of the claims on a signal, as the plots draw them: a line for each, empty where it is not judged. */
  loomfmu.live.bounds = name => (loomfmu.live.verdicts || []).flatMap(({ bound, holds }, number) => {
    const { signal, drawn, shown: { factor } } = claims[number];
    if (signal !== name || !drawn) return [];
    if (holds === null) return [{ value: null, text: "", holds }];
    return [{ value: bound * factor, text: `bound ${loomfmu.shownIn(claims[number], bound)}`, holds }];
  });

  /* Where the claim is that is nearest to its bound, or farthest beyond it; null where none is judged. */
  loomfmu.live.worst = () => {
    const [nearest] = (loomfmu.live.verdicts || [])
      .filter(verdict => verdict.holds !== null && verdict.place)
      .map(verdict => ({ verdict, away: verdict.sense * (verdict.worst - verdict.bound) / (Math.abs(verdict.bound) || 1) }))
      .sort((one, other) => one.verdict.holds - other.verdict.holds || one.away - other.away);
    return nearest ? nearest.verdict.place.position : null;
  };

  function verdictOf(run, judge, claim) {
    const waiting = run ? claim.parts.filter(run.waits) : [];
    if (!run) return { holds: null, note: "these values cannot be run" };
    if (waiting.length) return { holds: null, waits: true, note: `${waiting.join(", ")} still being stepped` };
    const verdict = judge(claim);
    return verdict.holds === null ? verdict : { ...verdict, place: place(run, verdict) };
  }

  outcome.setAttribute("aria-live", "polite");
  loomfmu.live.follow("claims", run => {
    const judge = run && loomfmu.judge(run);
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
    loomfmu.live.verdicts = verdicts;
  });
})();
