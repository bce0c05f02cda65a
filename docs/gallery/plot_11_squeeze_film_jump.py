"""
The jump of a squeeze-film damper
=================================

A squeeze-film damper is a soft element only while its orbit is small. With an unbalance of half a clearance,
as after the loss of a part of a blade, the film stiffens, and two motions coexist above the critical speed.

**What to look at:** the run-up stays on the large motion longer than the run-down; the branch between them is
unstable.
"""

import whirlmap

system = whirlmap.load("machines/aero-damper", **{"unbalance.of_rotor.G": "100 mm/s"})
print("unbalance over clearance:", system.values["b_of_rotor"])
sweeps = whirlmap.bifurcation_diagram(system, "s", "0.745:1.145:57", follow="both", steps=64)
figure = whirlmap.plot.diagram_figure(sweeps, ["uy_ring"])
