// The drawing of the revolution that the cursor is in, with a line at its angle; a click moves the cursor there.
(() => {
  const { shown, left, right, centre } = loomfmu.data("diagram"), TURN = 2 * Math.PI;
  const straight = document.getElementById("diagram-straight"), round = document.getElementById("diagram-round");
  const number = loomfmu.revolution;

  const name = document.getElementById("diagram-revolution"), missing = document.getElementById("diagram-missing");

  loomfmu.follow(position => {
    const turn = number(position), angle = position - (turn - 1) * TURN;
    for (const picture of [straight, round])
      for (const group of picture.querySelectorAll("g[data-drawing]"))
        group.toggleAttribute("hidden", Number(group.dataset.drawing) !== shown[turn]);
    name.textContent = turn;
    missing.hidden = shown[turn] !== null;
    const x = left + (right - left) * angle / TURN, line = straight.querySelector(".cursor");
    line.setAttribute("x1", x);
    line.setAttribute("x2", x);
    round.querySelector(".cursor").setAttribute("transform", `rotate(${angle * 360 / TURN} ${centre[0]} ${centre[1]})`);
  });

  function point(picture, event) {
    const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(picture.getScreenCTM().inverse());
    return [place.x, place.y];
  }
  const go = angle => loomfmu.seek((number(loomfmu.position) - 1) * TURN + angle);
  straight.addEventListener("click", event => {
    const [x] = point(straight, event);
    if (x >= left) go(Math.min((x - left) / (right - left), 1) * TURN);
  });
  round.addEventListener("click", event => {
    const [x, y] = point(round, event);
    go((Math.atan2(x - centre[0], centre[1] - y) + TURN) % TURN);
  });
})();
