"""
A gear pair with backlash: jumps, folds and grazing
===================================================

The gear pair of Kahraman and Singh with constant stiffness (:cite:t:`kahraman1990`). Near resonance the teeth
part once a period, the spring softens, and the branch folds back.

**What to look at:** between the two folds a motion with contact and a motion that loses it coexist; the
branch grazes the edge of the backlash where the teeth part for the first time.
"""

import whirlmap

system = whirlmap.load("gear_backlash", F_ah=0.05)
branch = whirlmap.continue_orbit(system, "Omega", "0.5:1.6")
figure = whirlmap.plot.branches_figure(branch, ["x"])

# %%
# Times at which the flanks meet and part, on the upper motion:

series = whirlmap.simulate(whirlmap.load("gear_backlash", F_ah=0.05, Omega=0.9), transient=200, periods=4)
found = whirlmap.surface_crossings(system, series)
print("share of the time with contact:", found["share"].sel(surface="drive_side").item())
axes = whirlmap.plot.draw_time_series(series, ["x"])
