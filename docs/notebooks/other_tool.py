# %% [markdown]
# # The FMUs in another tool
#
# Every mechanism is an FMU that any tool for [FMI](https://fmi-standard.org) runs;
# [fmpy](https://github.com/CATIA-Systems/FMPy) is one. At constant speed each FMU computes the shaft's
# angle itself: set the speed, and run.

# %%
import fmpy

from loomfmu.cli import main

main(["build", "WeftInsertion", "--output", "fmus"])
path = "fmus/WeftInsertion.fmu"
description = fmpy.read_model_description(path)
print(description.modelName, description.fmiVersion, len(description.modelVariables), "variables")

# %% [markdown]
# fmpy's own master runs it for a revolution at 600 rev/min, and records the head's travel.
# `output_interval` sets the communication step.

# %%
import math

SPEED, REVOLUTION, STEPS = 600.0 * math.pi / 30.0, 0.1, 720
alone = fmpy.simulate_fmu(
    path,
    stop_time=REVOLUTION,
    output_interval=REVOLUTION / STEPS,
    start_values={"speed": SPEED},
    output=["travel", "velocity"],
)
print(f"longest travel of the head: {alone['travel'].max():.4f} m")

# %% [markdown]
# The same mechanism in a scene, by loomfmu's master:

# %%
from pathlib import Path

import loomfmu

scene = """
revolutions = 1
steps_per_revolution = 720
record = ["weft.*"]

[weft]
component = "WeftInsertion"

[shaft]
speed = "600 rpm"
"""
Path("weft_alone.toml").write_text(scene)
ours = loomfmu.run("weft_alone.toml")
difference = abs(ours.trace["weft.travel"] - alone["travel"]).max()
print(f"largest difference of the travel: {difference:.1e} m")

# %%
from matplotlib import pyplot

axes = pyplot.subplots(figsize=(8, 3.5))[1]
axes.plot(360.0 * alone["time"] / REVOLUTION, 1e3 * alone["travel"], label="fmpy")
axes.plot(ours.to_pandas("weft.travel")["degrees"], 1e3 * ours.trace["weft.travel"], "--", label="loomfmu")
axes.set(xlabel="shaft angle [deg]", ylabel="travel of the rapier head [mm]")
axes.legend()
