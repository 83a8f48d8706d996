/* The claims on a run, judged by the rules that judge every run, compiled from C: see cosim/claims/native. A verdict has the
 * worst value with its bound, time, error and note, and `holds`, which is null where the claim is undecided. Of the numerical
 * error the page knows at the scene's own values alone what other steps would change: elsewhere it takes more for it. */
loomfmu.judge = ({ fields, signals, coarseness, proven }, length, wasm) => {
  const FAR_ABOVE = 10, NEAR = 1e-4; // times the error at the scene's own values; of the bound
  const NEAR_COUNT = 0.5; // of the bound: one event more may bring others with it
  const NOT_HERE = "loomfmu run judges it";
  const reals = (place, count) => new Float64Array(wasm.memory.buffer, place, count);
  const room = count => wasm.allocate(8 * count);

  function text(words) {
    const bytes = new TextEncoder().encode(`${words}\0`), place = wasm.allocate(bytes.length);
    new Uint8Array(wasm.memory.buffer, place, bytes.length).set(bytes);
    return place;
  }

  function read(place) {
    const bytes = new Uint8Array(wasm.memory.buffer, place);
    return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
  }

  const none = text(""), time = room(length), verdict = room(fields.length);
  const places = signals.map(({ name, about }) => ({ name: text(name), about: text(about), values: room(length) }));
  let judged = 0; // the run in the module

  /* Hand a run over: its signals by their numbers, with those that stand beside them. */
  function take(run) {
    if (judged) wasm.run_free(judged);
    reals(time, length).set(run.time);
    judged = wasm.run_new(length, time, 8, none);
    signals.forEach((signal, number) => {
      reals(places[number].values, length).set(run.signal(signal.name));
      wasm.run_add(judged, places[number].name, places[number].values, 8);
    });
    signals.forEach(({ beside }, number) => wasm.run_beside(judged, number, ...beside, places[number].about));
  }

  function asked(run, { question }) {
    const numbers = question.map(each => typeof each === "string" ? run.parameter(each) : each), place = room(numbers.length);
    reals(place, numbers.length).set(numbers);
    return place;
  }

  const found = () => Object.fromEntries(Array.from(reals(verdict, fields.length), (value, k) => [fields[k], value]));

  /* Take a numerical error into a verdict: `spread` is what other steps change, and bounds are no nearer than `near`. */
  function settle(place, { noise, share, scatter }, unsettled, spread, near) {
    reals(verdict, fields.length).set(fields.map(field => unsettled[field]));
    wasm.settle(judged, place, verdict, spread, Math.max(noise, near), share, scatter);
    return found();
  }

  /* Take in what the error may be at other values than the scene's own. */
  function elsewhere(place, claim, first, spread) {
    const { counts, unshown } = claim, near = Math.max(NEAR * coarseness, counts ? NEAR_COUNT : 0);
    const far = unshown ? Infinity : spread && FAR_ABOVE * coarseness * spread;
    return settle(place, claim, first, far, near * Math.abs(first.bound));
  }

  function judge(run, claim, own) {
    const place = asked(run, claim), { native, unshown } = claim, spread = native.spread ?? Infinity;
    wasm.judge(judged, place, claim.said ??= text(claim.words), verdict);
    const first = found(), known = Number.isFinite(first.worst);
    const unsettled = native.unsettled && (own ? native.unsettled : `with the scene's own values ${native.unsettled}`);
    const proof = loomfmu.live.within(proven) && claim.proven;
    const notes = [read(wasm.run_note(judged)), native.remark, unsettled, proof];
    const settled = known && native.estimated ? settle(place, claim, first, spread, 0) : first;
    let far = settled;
    if (known && settled.decided && !own) {
      far = elsewhere(place, claim, first, spread);
      if (!far.decided) notes.push(unshown || `it is nearer to its bound than the page can tell; ${NOT_HERE}`);
    }
    wasm.release(place);
    const form = claim.forms[first.form], note = notes.filter(Boolean).join("; ");
    return { ...far, form, holds: far.decided ? far.holds > 0 : null, note };
  }

  const left = ({ native: { holds, decided } }, why) => {
    const word = decided ? (holds ? "holds" : "fails") : "is undecided";
    return { holds: null, left: true, note: `${why}; ${NOT_HERE}: it ${word} with the scene's own values` };
  };

  /* A function from a claim to its verdict; `own` says that the values are those of the scene. */
  return (run, own) => {
    take(run);
    return claim => {
      const why = claim.not_live || (claim.unlike && "the page would judge it unlike the native run");
      return why ? left(claim, why) : judge(run, claim, own);
    };
  };
};
