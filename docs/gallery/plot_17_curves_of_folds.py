"""
Curves of folds over two parameters
===================================

The two folds of the gear pair with backlash, followed in the plane of mesh frequency and transmission error.
Between the curves two motions coexist.

**What to look at:** the curves meet in a cusp: below that error the resonance has no jump.
"""

import whirlmap

system = whirlmap.load("gear_backlash", F_ah=0.05)
curves = whirlmap.event_curve(system, {"Omega": "0.5:1.0", "F_ah": "0.01:0.055"}, "fold")
figure = whirlmap.plot.event_curves_figure(curves)
