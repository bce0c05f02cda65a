"""
Campbell diagram of a gearbox from parts
========================================

The stock machine of two shafts, four bearings and one mesh, from beam elements to critical speeds in rpm.

**What to look at:** crossings of the order lines of both shafts with the damped frequencies; those with a
damping ratio near 1 are no resonances.
"""

import numpy as np

import whirlmap

system = whirlmap.load("machines/two-shaft-gearbox")
found = whirlmap.campbell(system, "s", np.linspace(0.3, 1.1, 41) * system.values["s"])
found = whirlmap.in_units(system, found)
figure = whirlmap.plot.campbell_figure(found)

# %%
# Critical speeds with little damping:

for n in np.flatnonzero(found["critical_damping_ratio"].values < 0.2):
    speed, name, damping = (found[key].values[n] for key in ("critical", "critical_name", "critical_damping_ratio"))
    print(f"{speed:7.0f} rpm  {name:32}  damping ratio {damping:.3f}")
