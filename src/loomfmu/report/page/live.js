/* The page whose FMUs run: its sliders, and what follows them. `loomfmu.live.follow(part, run => ...)` is called after
 * every run, and once more when FMUs that take long have followed. Of a run there are `time`, `positions`,
 * `signal(name)` and `parameter(name)`, all in SI; `waits(name)` while its FMU is still
 * being stepped, so that its samples are of other values; `count(name)`, another number for other samples. It is null
 * where the values cannot be run. */
loomfmu.live = (() => {
  const plan = loomfmu.data("live"), listeners = new Map();
  const form = document.getElementById("live-knobs"), problem = document.getElementById("live-problem");
  const ignored = document.getElementById("live-ignored");
  const pace = document.getElementById("live-pace");
  const values = plan.knobs.map(knob => knob.start);
  const SLICE = 12, slices = new MessageChannel(); // ms between which the page draws; timers would wait 4 ms more
  let steps = null, current = null, waiting = false, last = null, asked = false;

  // ---- the run

  const since = begun => performance.now() - begun;

  /* Step what is quick, and show it; the rest follows in slices. */
  function run() {
    const begun = performance.now(), took = {}; // in ms, by parts
    let wrong = steps.start(plan.knobs.flatMap((knob, number) => knob.targets.map(target => [target, values[number]])));
    const wanted = steps.behind.size;
    wrong ||= steps.quick();
    took.run = since(begun);
    last = { begun, took, wrong, wanted, late: wrong ? [] : [...steps.behind] };
    show(last, "all", took);
  }

  function slice() {
    if (!asked) slices.port2.postMessage(null);
    asked = true;
  }

  slices.port1.onmessage = () => {
    asked = false;
    if (waiting || !steps.behind.size || last.wrong) return; // other values come, or nothing is left to do
    last.wrong = steps.advance(performance.now() + SLICE);
    if (last.wrong || !steps.behind.size) show(last, "late"); else slice();
  };

  /* Show a run, and say how long it took until then; `took` gets the times of the parts of the page. */
  function show(shown, until, took = {}) {
    const { wrong, late, begun } = shown;
    let before = performance.now();
    const mark = part => { const now = performance.now(); took[part] = now - before; before = now; };
    current = wrong ? null : steps.found();
    problem.hidden = !wrong;
    problem.textContent = wrong && `These values cannot be run: ${wrong}`;
    for (const [part, listener] of listeners) { listener(current); mark(part); }
    if (current && !current.waits("shaft")) loomfmu.lay(current.positions, current.time); else loomfmu.seek(loomfmu.position);
    mark("cursor");
    setTimeout(() => { // plots are painted in microtasks
      mark("paint");
      shown.took[until] = since(begun);
      if (shown !== last) return;
      pace.textContent = wrong ? "" : paceOf(shown);
      if (current && steps.behind.size) slice(); else loomfmu.live.pace = shown.took;
    });
  }

  function paceOf({ wanted, late, took }) {
    const ms = time => `${time.toFixed(0)} ms`, rest = took.late ? `${ms(took.late)} after the change` : "will follow";
    return `${plan.steps} steps of ${wanted - late.length} FMUs in ${ms(took.run)}, judged and drawn in`
      + ` ${ms(took.all - took.run)}${late.length ? `; ${late.join(", ")} ${rest}` : ""}`;
  }

  // ---- values in the address, and as text to use elsewhere

  const unitOf = ({ unit }) => unit && ` ${unit}`;
  const nameOf = (knob, value) => knob.choices.length ? knob.choices.find(([number]) => number === value)[1] : String(short(value / knob.factor));
  const chosen = wanted => plan.knobs.map((knob, number) => [knob, values[number]]).filter(wanted);
  const differing = () => chosen(([knob, value]) => value !== knob.start);
  const told = () => chosen(([knob, value]) => value !== knob.start || plan.set.includes(knob.key)); // beside plan.command

  /* Values that differ from the scene's stand in the address, so that a link carries them. */
  function address() {
    const words = differing().map(([knob, value]) => `${encodeURIComponent(knob.key)}=${encodeURIComponent(nameOf(knob, value))}`);
    if (words.length || location.hash.includes("=")) history.replaceState(null, "", `#${words.join("&")}`);
  }

  /* The value that a text of the address gives a knob; a number may have a unit. */
  function valueOf(knob, text) {
    const choice = knob.choices.find(([, name]) => name === text);
    if (choice || knob.choices.length) return choice && choice[0];
    const [, number, unit] = /^\s*([-+]?[\d.]+(?:e[-+]?\d+)?)\s*(\S*)\s*$/i.exec(text) || [], room = 1e-9 * (knob.high - knob.low);
    const value = Number(number) * (unit ? knob.units[unit] : knob.factor), whole = !knob.whole || Number.isInteger(value);
    return whole && value >= knob.low - room && value <= knob.high + room ? value : undefined;
  }

  const wantedOf = knob => knob.choices.length ? `Write ${knob.choices.map(([, name]) => name).join(" or ")}`
    : `Write a ${knob.whole ? "whole number" : "number"} from ${short(knob.low / knob.factor)} to ${short(knob.high / knob.factor)}${unitOf(knob)}`;

  /* Take the values of the address; say which are ignored. */
  function arrive() {
    if (!location.hash.includes("=")) return; // a section of the page
    const wrong = [];
    for (const [key, text] of new URLSearchParams(location.hash.slice(1))) {
      const number = plan.knobs.findIndex(knob => knob.key === key), knob = plan.knobs[number], value = knob && valueOf(knob, text);
      if (value !== undefined) values[number] = value;
      else wrong.push(`${key}=${text} in the address is ignored. `
        + (knob ? `${wantedOf(knob)}.` : `This page varies ${plan.knobs.map(each => each.key).join(", ")}.`));
    }
    for (const show of shows) show();
    if (differing().length || current) soon();
    ignored.textContent = wrong.join(" ");
    ignored.hidden = !wrong.length;
  }

  const quoted = text => /^[\w.=/+-]+$/.test(text) ? text : `"${text}"`;
  const copies = {
    command: () => [plan.command, ...told().map(([knob, value]) => `--set ${quoted(`${knob.key}=${nameOf(knob, value)}${unitOf(knob)}`)}`)].join(" "),
    scene: () => told().map(([knob, value]) => {
      const [, instance, variable] = /^(.*)\.([^.]*)$/.exec(knob.key), name = nameOf(knob, value);
      const plain = knob.choices.length ? { yes: "true", no: "false" }[name] : !knob.unit && name;
      return `[${instance}]\n${variable} = ${plain || `"${name}${unitOf(knob)}"`}`;
    }).join("\n\n") || "# the scene's own values",
  };
  form.addEventListener("click", async event => {
    const kind = event.target.dataset.copy, copied = document.getElementById("live-copied");
    if (!kind) return;
    const text = copies[kind]();
    try {
      await navigator.clipboard.writeText(text);
      copied.textContent = `copied:\n${text}`;
    } catch {
      copied.textContent = text; // to be copied by hand where the browser does not let a page do so
    }
  });

  /* Limits are those of a knob while the others have the scene's values. */
  function mark() {
    form.querySelectorAll(".knob").forEach((box, number) => {
      const limits = box.querySelector(".limits");
      if (limits) limits.hidden = plan.knobs.some((knob, other) => other !== number && values[other] !== knob.start);
    });
  }

  function soon() {
    ignored.hidden = true;
    address();
    mark();
    document.getElementById("live-copied").textContent = "";
    loomfmu.live.pace = null; // until the page shows the values
    if (waiting || !steps) return;
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
      refused.textContent = taken ? "" : `${wantedOf(knob)};`
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

  // ---- the modules: the FMUs, and the rules of claims

  async function module(text) {
    const bytes = Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
    const { exports } = (await WebAssembly.instantiate(bytes)).instance;
    exports._initialize();
    return exports;
  }

  addEventListener("load", async () => {
    let wasm, rules;
    try {
      [wasm, rules] = await Promise.all([plan.wasm, plan.judging.wasm].map(module));
    } catch (error) {
      problem.hidden = false;
      problem.textContent = `The FMUs cannot run here: ${error.message}. The page shows the run of the scene’s own values, without plots.`;
      return;
    }
    steps = loomfmu.steps(plan, wasm);
    loomfmu.live.judge = loomfmu.judge(plan.judging, plan.steps + 1, rules);
    for (const input of form.elements) input.disabled = false;
    run(); // with the scene's own values: claims and plots compare with them
    arrive();
    addEventListener("hashchange", arrive);
  });
  const changed = () => plan.knobs.flatMap((knob, number) => values[number] === knob.start ? [] : knob.targets);
  /* Whether all values are those of the scene, or within ranges by their keys. */
  const within = ranges => differing().every(([{ key }, value]) => key in ranges && ranges[key][0] <= value && value <= ranges[key][1]);
  return { plan, changed, within, follow: (part, listener) => { listeners.set(part, listener); }, get current() { return current; } };
})();
