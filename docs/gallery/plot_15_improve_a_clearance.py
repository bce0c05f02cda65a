"""
Which clearance is best?
========================

The rig again, with clearances from 60 to 140 micrometres: one design after the other is run over all speeds.

**What to look at:** a wider window of safe speeds can cost amplitude elsewhere; designs that no other one
beats in both are on the Pareto front.
"""

from functools import partial

import numpy as np

import whirlmap

rig = partial(whirlmap.load, "machines/jeffcott-rig")
speeds = np.linspace(600, 6000, 19) / 1800 * rig().values["s"]
found = whirlmap.improve(rig, {"c": "60um:140um:5"}, speeds, "60 um", refine=False, follow=False)
figure = whirlmap.plot.improve_figure(found)
