# %% [markdown]
# # Which dobby?
#
# The same loom, driven by different [laws of the dobby](../../fmus/dobby_drive/README.md): how long do the
# frames dwell, and how hard do they accelerate?

# %%
import pandas

import loomfmu

LAWS = ["uniform", "harmonic_ends", "sloped_line", "sloped_sine", "slotted_levers", "plateau"]
SIGNALS = ["heald_1.lift", "heald_1.velocity", "heald_1.acceleration"]
runs = {}
with loomfmu.prepare("wl680_3600.toml", set={"revolutions": 2}, values=SIGNALS) as loom:
    for law in LAWS:
        runs[law] = loom.evaluate({"dobby.law": law})

# %% [markdown]
# A verdict has the worst value of a claim, with its bound and numerical error, and writes it in the unit of
# people.

# %%
rows = []
for law, run in runs.items():
    dwell = next(claim for claim in run.claims if claim.claim.startswith("the frames dwell"))
    rows.append(
        {
            "law": law,
            "dwell": dwell.shown(dwell.worst, 4),
            "verdict": dwell.word,
            "highest velocity [m/s]": abs(run.trace["heald_1.velocity"]).max().round(3),
            "highest acceleration [m/s2]": abs(run.trace["heald_1.acceleration"]).max().round(1),
        }
    )
pandas.DataFrame(rows).set_index("law")

# %% [markdown]
# A longer dwell leaves less time to move. How hard the frame accelerates then depends on the law:

# %%
from matplotlib import pyplot

lift, acceleration = pyplot.subplots(2, 1, sharex=True, figsize=(8, 6))[1]
for law, run in runs.items():
    table = run.to_pandas("heald_1.lift", "heald_1.acceleration")
    first = table[table["degrees"] <= 360.0]
    lift.plot(first["degrees"], 1e3 * first["heald_1.lift"], label=law)
    acceleration.plot(first["degrees"], first["heald_1.acceleration"])
lift.set(ylabel="lift of frame 1 [mm]")
lift.legend()
acceleration.set(xlabel="shaft angle [deg]", ylabel="acceleration [m/s²]")
