# %% [markdown]
# # A measured trace against the model
#
# `measured.csv` has the displacement of a frame's carrier over the shaft's angle. Does the scene explain
# it, and with which spring and damping? [Values from measured curves](../fitting.md) says how far the
# answer can be trusted.

# %%
import pandas

import loomfmu

measured = pandas.read_csv("measured.csv", comment="#")
measured.head()

# %% [markdown]
# The run as the scene is, folded onto one revolution: the last one is compared.

# %%
from matplotlib import pyplot

TRAVEL = {"damper_1.free_travel": "300 mm"}
SIGNAL = "damper_1.displacement"


def compared(settings, label, axes):
    run = loomfmu.evaluate("wl680_3600.toml", set=settings, values=[SIGNAL], errors="none")
    last = run.to_xarray(SIGNAL, fold=True)[SIGNAL].isel(revolution=-1)
    axes.plot(last["degrees"], 1e3 * last, label=label)


axes = pyplot.subplots(figsize=(8, 3.5))[1]
axes.plot(*measured.to_numpy().T, ".", markersize=3, label="measured")
compared(TRAVEL, "the scene as it is", axes)
axes.set(xlabel="shaft angle [deg]", ylabel="displacement [mm]")
axes.legend()

# %% [markdown]
# Find the spring and the damping with which the model comes closest:

# %%
fitted = loomfmu.fit(
    "wl680_3600.toml",
    "measured.csv",
    vary=["damper_1.spring_stiffness=1N/mm..20N/mm", "damper_1.damping_ratio=0..0.5"],
    set=TRAVEL,
)
rows = []
for each in fitted.parameters:
    shown = each.span.show
    rows.append([each.span.key, shown(each.value), shown(each.low), shown(each.high)])
pandas.DataFrame(rows, columns=["parameter", "value", "from", "to (95 %)"])

# %% [markdown]
# The data were computed with 7.1 N/mm and 0.12, with noise of 0.1 mm. Nothing speaks against the intervals:

# %%
fitted.trusted

# %%
axes = pyplot.subplots(figsize=(8, 3.5))[1]
axes.plot(*measured.to_numpy().T, ".", markersize=3, label="measured")
compared(TRAVEL | dict(fitted.values), "fitted", axes)
axes.set(xlabel="shaft angle [deg]", ylabel="displacement [mm]")
axes.legend()
