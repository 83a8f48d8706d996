/* The rules of report/rules.py on a run: `loomfmu.rules(run)(rule)` is a function of a sample's place and of the share
 * of the way to the next sample. Names are those of tracks of drawings, signals and parameters. */
loomfmu.rules = (run, tracks = {}) => {
  const end = run.time.length - 1;
  const operations = {
    "-": (one, other) => (k, share) => one(k, share) - other(k, share),
    "*": (one, other) => (k, share) => one(k, share) * other(k, share),
    "/": (one, other) => (k, share) => one(k, share) / other(k, share),
    abs: one => (k, share) => Math.abs(one(k, share)),
    min: (...all) => (k, share) => all.reduce((found, each) => Math.min(found, each(k, share)), Infinity),
    max: (...all) => (k, share) => all.reduce((found, each) => Math.max(found, each(k, share)), -Infinity),
    "if positive": (value, one, other) => (k, share) => (value(k, share) > 0 ? one : other)(k, share),
    lowest: (...all) => overall(all, Math.min, Infinity),
    highest: (...all) => overall(all, Math.max, -Infinity),
  };
  const constant = value => () => value;

  function overall(all, choose, found) {
    for (const each of all) for (let k = 0; k <= end; k++) found = choose(found, each(k, 0));
    return constant(found);
  }

  function named(name) {
    if (tracks[name]) return follow(tracks[name].rule);
    if (!run.has(name)) return constant(run.parameter(name));
    const values = run.signal(name);
    return (k, share) => share ? values[k] + share * (values[k + 1] - values[k]) : values[k];
  }

  function follow(rule) {
    if (typeof rule === "string") return named(rule);
    if (!Array.isArray(rule)) return constant(rule);
    const [operation, ...operands] = rule;
    if (operation !== "table") return operations[operation](...operands.map(follow));
    const [value, along, values] = [follow(operands[0]), operands[1], operands[2]];
    return (k, share) => loomfmu.interpolate(along, values, value(k, share));
  }
  return follow;
};

/* Whether a rule needs an FMU that is still being stepped. */
loomfmu.waits = (run, rule, tracks = {}) => {
  if (typeof rule === "string") return tracks[rule] ? loomfmu.waits(run, tracks[rule].rule, tracks) : run.has(rule) && run.waits(rule);
  if (!Array.isArray(rule)) return false;
  const [operation, ...operands] = rule;
  return (operation === "table" ? operands.slice(0, 1) : operands).some(each => loomfmu.waits(run, each, tracks));
};
