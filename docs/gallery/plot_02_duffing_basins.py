"""
Duffing's oscillator: two motions at one operating point
========================================================

Weakly driven, the mass stays in the left or in the right well. Which of the two it is depends on the start.
The basins of attraction wind around each other, so that a small change of the start can change the motion.

**What to look at:** each colour is the set of starts that lead to one attractor; the attractors are the
marked points, in the section once per T.
"""

import whirlmap

system = whirlmap.load("duffing", gamma=0.2)
basins = whirlmap.basins(system, {"x": "-2:2:120", "v": "-2:2:120"})
figure = whirlmap.plot.basins_figure(basins)

# %%
# The share of the starts is the basin stability of each attractor, with its error:

for number in basins["attractor"].values:
    one = basins.sel(attractor=number)
    print(f"attractor {number}: {one['share'].item():.3f} +- {one['share_error'].item():.3f} of the starts")
