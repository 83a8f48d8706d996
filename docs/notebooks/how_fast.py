# %% [markdown]
# # How fast may it run?
#
# A scene states what must hold, and [`loomfmu.limit`](../limits.md) finds the speed at which the first
# claim fails. This needs `pip install "loomfmu[plot,xarray]"`, and the example scenes that `loomfmu init`
# writes.

# %%
import loomfmu

found = loomfmu.limit("wl680_3600.toml", vary="shaft.speed", from_="300 rpm", to="900 rpm")
print(found)

# %% [markdown]
# Each claim has its own limit. The belt's margin comes first; the frames' dwell does not depend on the
# speed at all. `span.show` writes a value in the unit of people.

# %%
for claim in found.claims:
    limits = [found.span.show(limit.value) for limit in claim.limits]
    print(f"{claim.claim}: {', '.join(limits) or 'no limit'}")

# %% [markdown]
# Look at the margin at that speed and 5 % above it, over one revolution. At 0 the belt buckles.

# %%
from matplotlib import pyplot

highest = found.ranges[0].high
axes = pyplot.subplots(figsize=(8, 3.5))[1]
with loomfmu.prepare("wl680_3600.toml", values=["belt.margin"]) as loom:
    for share in (1.0, 1.05):
        margin = loom.evaluate({"shaft.speed": share * highest}, errors="none").to_pandas("belt.margin")
        first = margin[margin["degrees"] <= 360.0]
        axes.plot(first["degrees"], first["belt.margin"], label=f"{share:.0%} of the limit")
axes.set(xlabel="shaft angle [deg]", ylabel="margin of the belt", ylim=(-0.1, 1.05))
axes.axhline(0.1, color="grey", linestyle=":")
axes.legend()

# %% [markdown]
# As the belt wears, its clearance in the guide grows, and the limit falls:

# %%
import pandas

rows = []
for clearance in (0.3, 0.5, 0.7, 0.9):
    worn = loomfmu.limit(
        "wl680_3600.toml", vary="shaft.speed=300rpm..900rpm", set={"belt.guide_clearance": f"{clearance} mm"}
    )
    best = worn.ranges[0]
    rows.append(
        {"clearance [mm]": clearance, "highest speed": worn.span.show(best.high), "then fails": best.above}
    )
pandas.DataFrame(rows)
