/* The FMUs of the page, compiled to WebAssembly: `loomfmu.live.follow(part, run => ...)` is called after every run.
 * Of a run there are `time`, `positions`, `signal(name)`, `rate(name)`, `validity(name)` and `parameter(name)`, all in
 * SI; it is null where the values cannot be run. */
loomfmu.live = (() => {
  const plan = loomfmu.data("live"), names = Object.keys(plan.signals), listeners = new Map();
  const form = document.getElementById("live-knobs"), problem = document.getElementById("live-problem");
  const pace = document.getElementById("live-pace"), reset = form.querySelector("button");
  const values = plan.knobs.map(knob => knob.start);
  let wasm = null, rows = 0, samples = 0, current = null, waiting = false;

  // ---- the run

  function complaint() {
    const bytes = new Uint8Array(wasm.memory.buffer, wasm.messages());
    return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0))).trim().split("\n").pop();
  }

  /* Set, start and step; returns a run, or what is wrong. */
  function simulate() {
    const { steps } = plan, length = steps + 1;
    wasm.reset();
    for (const [number, knob] of plan.knobs.entries())
      for (const target of knob.targets)
        if (wasm.set(plan.parameters[target], values[number]) !== 0) return complaint();
    if (wasm.start() !== 0 || wasm.run(steps, rows, names.length, samples) < steps) return complaint();
    const size = wasm.step(), time = Float64Array.from({ length }, (_, number) => number * size);
    const table = new Map(names.map((name, place) =>
      [name, new Float64Array(wasm.memory.buffer, samples + 8 * place * length, length)]));
    const parameters = new Map();
    return {
      time, has: name => table.has(name), signal: name => table.get(name), rate: name => plan.signals[name].rate,
      validity: name => plan.signals[name]?.validity,
      positions: plan.turns ? table.get("shaft.angle") : time,
      parameter: name => {
        if (!parameters.has(name))
          parameters.set(name, name in plan.parameters ? wasm.get(plan.parameters[name]) : plan.constants[name]);
        return parameters.get(name);
      },
    };
  }

  function run() {
    const begun = performance.now(), found = simulate(), stepped = performance.now();
    const failed = typeof found === "string";
    current = failed ? null : found;
    problem.hidden = !failed;
    problem.textContent = failed ? `These values cannot be run: ${found}` : "";
    const took = { run: stepped - begun };
    let before = stepped;
    const mark = part => { const now = performance.now(); took[part] = now - before; before = now; };
    for (const [part, listener] of listeners) { listener(current); mark(part); }
    if (current) loomfmu.lay(current.positions, current.time); else loomfmu.seek(loomfmu.position);
    mark("cursor");
    setTimeout(() => { // plots are painted in microtasks
      mark("paint");
      took.all = before - begun;
      pace.textContent = failed ? "" : `${plan.steps} steps of ${plan.fmus} FMUs in ${took.run.toFixed(0)} ms,`
        + ` judged and drawn in ${(took.all - took.run).toFixed(0)} ms`;
      loomfmu.live.pace = took; // in ms, by parts
    });
  }

  function soon() {
    if (waiting || !wasm) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; run(); });
  }

  // ---- the knobs

  const short = value => Number(value.toPrecision(7));

  /* A round step, so that the values between both ends are round, too. */
  function stepOf({ low, high, factor, whole }) {
    const step = 10 ** Math.floor(Math.log10((high - low) / factor / 100));
    return whole ? Math.max(1, step) : step;
  }

  const shows = Array.from(form.querySelectorAll(".knob"), (box, number) => {
    const knob = plan.knobs[number], select = box.querySelector("select");
    if (select) {
      select.addEventListener("change", () => { values[number] = Number(select.value); soon(); });
      return () => { select.value = values[number]; };
    }
    const [slider, field] = box.querySelectorAll("input"), refused = box.querySelector(".refused");
    slider.step = stepOf(knob);
    for (const input of [slider, field]) {
      input.min = short(knob.low / knob.factor);
      input.max = short(knob.high / knob.factor);
    }
    const show = () => {
      slider.value = values[number] / knob.factor;
      refused.textContent = "";
      slider.setAttribute("aria-valuetext", `${short(values[number] / knob.factor)} ${knob.unit}`);
      return slider;
    };
    slider.addEventListener("input", () => {
      values[number] = Number(slider.value) * knob.factor;
      field.value = short(Number(slider.value));
      show();
      soon();
    });
    field.addEventListener("input", () => {
      const value = Number(field.value), unit = knob.unit && ` ${knob.unit}`;
      const taken = field.value && field.checkValidity() && (!knob.whole || Number.isInteger(value));
      refused.textContent = taken ? "" : `Write a ${knob.whole ? "whole number" : "number"} from ${field.min} to ${field.max}${unit};`
        + ` the page shows ${short(values[number] / knob.factor)}${unit}.`;
      if (!taken) return;
      values[number] = value * knob.factor;
      show();
      soon();
    });
    return () => { show(); field.value = short(values[number] / knob.factor); };
  });

  form.addEventListener("submit", event => event.preventDefault());
  form.addEventListener("reset", event => {
    event.preventDefault();
    plan.knobs.forEach((knob, number) => { values[number] = knob.start; });
    for (const show of shows) show();
    soon();
  });
  for (const show of shows) show();

  // ---- the module

  addEventListener("load", async () => {
    try {
      const bytes = Uint8Array.from(atob(plan.wasm), letter => letter.charCodeAt(0));
      wasm = (await WebAssembly.instantiate(bytes)).instance.exports;
    } catch (error) {
      problem.hidden = false;
      problem.textContent = `The FMUs cannot run here: ${error.message}. The page shows the run of the scene’s own values, without plots.`;
      return;
    }
    wasm._initialize();
    rows = wasm.allocate(4 * names.length);
    samples = wasm.allocate(8 * names.length * (plan.steps + 1));
    new Uint32Array(wasm.memory.buffer, rows, names.length).set(names.map(name => plan.signals[name].row));
    for (const input of form.elements) input.disabled = false;
    run();
  });
  const changed = () => plan.knobs.flatMap((knob, number) => values[number] === knob.start ? [] : knob.targets);
  return { plan, changed, follow: (part, listener) => { listeners.set(part, listener); }, get current() { return current; } };
})();
