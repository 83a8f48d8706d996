"""How long the page in which the FMUs run takes to follow a slider."""

import json
import shutil
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from typing import Any

from own import DEMO
from records import ROOT, Notes, Table, say
from texts import Find, parts, whole

from loomfmu import live_page

NAME = "page"
WHOLE = ROOT / "sims" / "full_loom.toml"
SLIDERS = {  # one that reaches all, one that reaches the dampers, one that reaches a belt in motion alone
    DEMO: ("shaft.speed", "damper.damping_ratio"),
    WHOLE: ("shaft.speed", "damper.damping_ratio", "belt_motion.damping=0 1/s..20 1/s"),
}
COLUMNS = (
    "scene",
    "slider",
    "FMUs stepped",
    "stepped [ms]",
    "page follows [ms]",
    "all is there [ms]",
    "repeats",
)
REPEATS = {"full": 21, "quick": 7, "tiny": 1}
BROWSER = "chromium"
SECONDS = 60.0  # that the page may take
COUNTS = "Object.keys(loomfmu.live.plan.reaches).map(part => loomfmu.live.current.count(part))"


def measure(effort: str, notes: Notes) -> list[Table]:
    """Each slider of each scene, in a process of its own: medians of the times that the page takes itself."""
    rows = Table(NAME, COLUMNS)
    for needed in (shutil.which(BROWSER), find_spec("playwright")):
        if needed is None:
            notes("the page in a browser", f"{BROWSER} or playwright is not installed")
            return [rows]
    for scene, sliders in list(SLIDERS.items())[: 1 if effort == "tiny" else None]:
        say(f"{NAME}: {scene.stem}")
        with tempfile.TemporaryDirectory() as folder:
            path = live_page.write(scene, sliders, Path(folder) / "page.html")
            called = [sys.executable, __file__, str(path), str(REPEATS[effort])]
            found = json.loads(subprocess.run(called, check=True, capture_output=True, text=True).stdout)
        for slider, (stepped, times) in zip(sliders, found, strict=True):
            run, page, late = (median(each) for each in zip(*times, strict=True))
            rows.add(scene.stem, slider.partition("=")[0], stepped, run, page, late, len(times))
    return [rows]


def _followed(path: Path, repeats: int) -> list[Any]:
    """Of each slider: how many FMUs it steps, and times until they are stepped and until the page follows."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as started:
        browser = started.chromium.launch(executable_path=shutil.which(BROWSER), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1200, "height": 900})
        page.goto(path.as_uri())
        _paced(page)
        found = []
        for number, knob in enumerate(page.evaluate("loomfmu.live.plan.knobs")):
            low, high = (knob[end] / knob["factor"] for end in ("low", "high"))
            times: list[tuple[float, ...]] = []
            for turn in range(repeats + 1):  # the first one warms up
                before = page.evaluate(COUNTS)
                value = low + (high - low) * (0.3 + 0.4 * turn / (repeats + 1))
                page.locator(".knob").nth(number).locator("input[type=number]").fill(f"{value:.6g}")
                pace = _paced(page)
                times.append((pace["run"], pace["all"], pace.get("late", pace["all"])))
            after = page.evaluate(COUNTS)
            stepped = sum(new > old for new, old in zip(after, before, strict=True))
            found.append((stepped, times[1:]))
        browser.close()
    return found


def _paced(page: Any) -> dict[str, float]:
    """What the page says of its pace, once it shows all of its values."""
    for _ in range(int(SECONDS / 0.02)):
        found: dict[str, float] | None = page.evaluate("loomfmu.live.pace")
        if found:
            return found
        page.wait_for_timeout(20)
    raise TimeoutError(f"the page does not follow within {SECONDS:.0f} s")


# ---- what is said of it


def section(find: Find) -> str:
    """A row for each slider."""
    return parts(
        "`loomfmu page` in headless Chromium: what a slider takes, by the page's own clock. Only the FMUs"
        " that it reaches are stepped. The belts in motion come last: first the others are stepped, then"
        " claims, diagram, drawings and plots in sight follow, then the belts are there, too.",
        whole(find(NAME)),
    )


if __name__ == "__main__":
    print(json.dumps(_followed(Path(sys.argv[1]), int(sys.argv[2]))))
