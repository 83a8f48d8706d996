/* The FMUs of the page, compiled to WebAssembly. A run steps those that a changed value reaches, with the samples of the
 * others as their inputs. Those that take long come last, in slices, so that the rest of the page need not wait. */
loomfmu.steps = (plan, wasm) => {
  const AT_ONCE = 100, SHARE = 0.1, PIECE = 64; // ms; of a whole run, for one FMU; steps between looks at the clock
  const [LEFT, STEPPED, SAMPLED] = [0, 1, 2]; // as in page.c
  const { steps, samples: signals } = plan, names = Object.keys(plan.signals), length = steps + 1;
  const parts = Object.keys(plan.reaches), behind = new Set(parts), values = new Map();
  const counts = new Map(parts.map(part => [part, 0])); // how often each was stepped
  const costs = new Map(parts.map(part => [part, 1])); // of each, in ms once it was stepped
  const list = wasm.allocate(12 * signals.length), uses = wasm.allocate(parts.length + 1);
  const samples = wasm.allocate(8 * signals.length * length);
  new Uint32Array(wasm.memory.buffer, list, 3 * signals.length).set(signals.flat());
  wasm.record(list, signals.length, samples, length);
  let size = NaN, group = [], at = 0, spent = 0, first = true;

  const owner = name => name.split(".")[0];
  const cost = some => some.reduce((sum, part) => sum + costs.get(part), 0);
  const follow = part => { for (const each of plan.reaches[part]) behind.add(each); };

  function complaint() {
    const bytes = new Uint8Array(wasm.memory.buffer, wasm.messages());
    return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0))).trim().split("\n").pop();
  }

  /* Set the values of parameters and compute the start. Like the next two, returns what is wrong, or "". */
  function start(wanted) {
    for (const [target, value] of wanted) {
      if (values.get(target) !== value) follow(owner(target));
      values.set(target, value);
    }
    wasm.reset();
    for (const [target, value] of values)
      if (wasm.set(plan.parameters[target], value) !== 0) return complaint();
    if (wasm.start() !== 0) return complaint();
    if (wasm.step() !== size) parts.forEach(follow);
    size = wasm.step();
    return "";
  }

  function take(some) {
    [group, at, spent] = [some, 0, 0];
    const use = part => some.includes(part) ? STEPPED : behind.has(part) ? LEFT : SAMPLED;
    new Uint8Array(wasm.memory.buffer, uses, parts.length + 1).set([STEPPED, ...parts.map(use)]); // first what is driven
    wasm.choose(uses);
  }

  /* Step what was taken until then. */
  function advance(deadline = Infinity) {
    const begun = performance.now();
    while (group.length && at < steps && performance.now() < deadline) {
      const to = Math.min(at + PIECE, steps);
      at = wasm.run(at, to);
      if (at < to) return complaint();
    }
    spent += performance.now() - begun;
    if (at === steps) finish();
    return "";
  }

  function finish() {
    const share = spent / cost(group);
    for (const part of group) {
      behind.delete(part);
      counts.set(part, counts.get(part) + 1);
      costs.set(part, Math.max(share * costs.get(part), 1e-3)); // clocks are coarse
    }
  }

  /* Step all that is quick, and take the rest. The first run takes the time of each FMU. */
  function quick() {
    let problem = "";
    for (const part of first ? parts : []) {
      take([part]);
      problem ||= advance();
    }
    first = false;
    const wanted = [...behind], long = parts.filter(part => costs.get(part) > SHARE * cost(parts));
    const slow = long.flatMap(part => plan.reaches[part]);
    take(cost(wanted) > AT_ONCE ? wanted.filter(part => !slow.includes(part)) : wanted);
    problem ||= advance();
    if (!problem) take([...behind]);
    return problem;
  }

  /* The run, in SI. */
  function found() {
    const time = Float64Array.from({ length }, (_, number) => number * size), parameters = new Map();
    const table = new Map(names.map((name, place) =>
      [name, new Float64Array(wasm.memory.buffer, samples + 8 * place * length, length)]));
    return {
      time, has: name => table.has(name), signal: name => table.get(name),
      positions: plan.turns ? table.get("shaft.angle") : time,
      parameter: name => {
        if (!parameters.has(name))
          parameters.set(name, name in plan.parameters ? wasm.get(plan.parameters[name]) : plan.constants[name]);
        return parameters.get(name);
      },
      waits: name => behind.has(owner(name)),
      count: name => counts.get(owner(name)), // another one: other samples
    };
  }

  return { start, quick, advance, found, behind };
};
