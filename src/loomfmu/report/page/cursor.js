"use strict";
/* One cursor for the whole page. A position is an angle of the main shaft, not wrapped [rad], or a time [s]
 * where no shaft turns. Sections follow it by `loomfmu.follow(position => ...)` and move it by
 * `loomfmu.seek(position)`; their data are `loomfmu.data(name)`. */
const loomfmu = (() => {
  const DEGREE = Math.PI / 180, TURN = 2 * Math.PI, SECONDS_A_TURN = 6, SECONDS_A_RUN = 20;
  const data = name => JSON.parse(document.getElementById(`data-${name}`).textContent);
  const axis = data("axis");
  let { positions, times } = axis, first = positions[0], last = positions[positions.length - 1];
  const slider = document.getElementById("cursor-slider"), place = document.getElementById("cursor-place");
  const button = document.getElementById("cursor-play"), pace = document.getElementById("cursor-pace");
  const listeners = [];
  let position = axis.start, playing = null;

  /* Index of the last of ascending values that is not above a value, and the share of the way to the next. */
  function locate(ascending, value) {
    let low = 0, high = ascending.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (ascending[middle] <= value) low = middle; else high = middle;
    }
    const span = ascending[high] - ascending[low];
    return [low, span > 0 ? Math.min(Math.max((value - ascending[low]) / span, 0), 1) : 0];
  }

  function interpolate(ascending, values, value) {
    const [index, share] = locate(ascending, value);
    const next = values[Math.min(index + 1, values.length - 1)];
    return values[index] + share * (next - values[index]);
  }

  function label(where) {
    const time = `${interpolate(positions, times, where).toPrecision(6)} s`;
    if (!axis.turns) return time;
    const turn = revolution(where), degrees = (where - (turn - 1) * TURN) / DEGREE;
    return `rev. ${turn}, ${degrees.toFixed(1)}°, ${time}`;
  }

  /* The revolution that a position is in, counted from 1; the run ends at 360° of its last one. */
  function revolution(where) {
    const begun = Math.floor(Math.min(first, last) / TURN) + 1;
    const ended = Math.max(Math.ceil(Math.max(first, last) / TURN - 1e-9), begun);
    return Math.min(Math.max(Math.floor(where / TURN + 1e-9) + 1, begun), ended);
  }

  function seek(where) {
    position = Math.min(Math.max(where, first), last);
    slider.value = position;
    place.textContent = label(position);
    slider.setAttribute("aria-valuetext", place.textContent);
    for (const listener of listeners) listener(position);
  }

  function pause() {
    if (playing !== null) cancelAnimationFrame(playing);
    playing = null;
    button.textContent = "Play";
    button.setAttribute("aria-pressed", "false");
  }

  function play() {
    const usual = axis.turns ? TURN / SECONDS_A_TURN : (last - first) / SECONDS_A_RUN;
    let before = null;
    if (position >= last) seek(first);
    button.textContent = "Pause";
    button.setAttribute("aria-pressed", "true");
    const hold = matchMedia("(prefers-reduced-motion: reduce)").matches ? 1000 : 0; // ms between jumps, then
    const frame = now => {
      if (before === null) before = now;
      if (now - before >= hold) {
        const rate = usual * Number(pace.value); // it may change meanwhile
        seek(position + (hold ? 10 * step : rate * (now - before) / 1000));
        before = now;
      }
      if (position >= last) pause(); else playing = requestAnimationFrame(frame);
    };
    playing = requestAnimationFrame(frame);
  }

  const toggle = () => playing === null ? play() : pause();
  const step = axis.turns ? DEGREE : (last - first) / 1000;
  const moves = {
    ArrowLeft: event => seek(position - step * (event.shiftKey ? 10 : 1)),
    ArrowRight: event => seek(position + step * (event.shiftKey ? 10 : 1)),
    Home: () => seek(first),
    End: () => seek(last),
    " ": toggle,
  };
  document.addEventListener("keydown", event => {
    // Space belongs to what it presses, all keys to what takes text
    const text = event.target.closest("select, textarea, input:not(#cursor-slider):not([type=checkbox])");
    const pressed = event.key === " " && event.target.closest("button, a, summary, input[type=checkbox]");
    if (text || pressed || event.ctrlKey || event.altKey || event.metaKey || !moves[event.key]) return;
    event.preventDefault();
    if (event.key !== " ") pause();
    moves[event.key](event);
  });
  /* Another axis, of another run; the cursor stays where it is if it can. */
  function lay(along, at) {
    [positions, times] = [along, at];
    [first, last] = [positions[0], positions[positions.length - 1]];
    slider.min = first;
    slider.max = last;
    seek(position);
  }

  /* Makes a function that draws an element: at once while it is in sight, else as soon as it is, or the browser has
   * nothing else to do, or on paper. */
  const drawn = new Map(), paper = matchMedia("print");
  const sight = new IntersectionObserver(found => {
    for (const { target, isIntersecting } of found) {
      const each = drawn.get(target);
      each.seen = isIntersecting;
      if (each.seen && each.late) each.draw();
    }
  }, { rootMargin: "25%" });
  function whenSeen(element, draw) {
    const each = { seen: true, late: false, draw: () => { each.late = false; draw(); } };
    drawn.set(element, each);
    sight.observe(element);
    return () => {
      if (each.seen || paper.matches) each.draw();
      else { each.late = true; rest(); }
    };
  }
  const late = () => [...drawn.values()].filter(each => each.late);
  const catchUp = () => { for (const each of late()) each.draw(); };
  const idle = window.requestIdleCallback || (work => setTimeout(work, 50)); // Safari has none
  let resting = false;
  function rest() { // one element at a time, so that a slider does not wait
    if (resting) return;
    resting = true;
    idle(() => {
      resting = false;
      const [each] = late();
      if (each) { each.draw(); rest(); }
    });
  }
  for (const event of ["beforeprint", "resize"]) addEventListener(event, catchUp);
  paper.addEventListener("change", catchUp);

  slider.min = first;
  slider.max = last;
  slider.addEventListener("input", () => { pause(); seek(Number(slider.value)); });
  button.addEventListener("click", toggle);
  addEventListener("load", () => seek(position));

  return { data, locate, interpolate, label, revolution, seek, play, pause, lay, whenSeen, turns: axis.turns, get first() { return first; }, get last() { return last; },
           follow: listener => { listeners.push(listener); }, get position() { return position; } };
})();
window.loomfmu = loomfmu;
