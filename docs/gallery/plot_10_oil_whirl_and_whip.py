"""
Oil whirl and whip
==================

A laboratory rotor on two plain bearings is run up to four times its first critical speed. Above a threshold
the fluid film feeds a forward whirl, which for a plain bearing turns a little slower than half of the shaft.
Here the threshold lies where that is the natural frequency of the rotor, so that the whirl is whip from its
beginning: its frequency stays, whatever the speed.

**What to look at:** in the waterfall the line of the unbalance, whose frequency is the speed, is so small
that it cannot be seen beside the line of the whip, which stands still near the natural frequency, 0.99 in
these units.
"""

import whirlmap

system = whirlmap.load("machines/jeffcott-rig")
run_up = whirlmap.waterfall(system, "s", "1.2:4:57", "y")
axes = whirlmap.plot.draw_waterfall(run_up)

# %%
# The same in labels: periodic with the unbalance below the threshold, quasi-periodic above it.

diagram = whirlmap.bifurcation_diagram(system, "s", "1.2:4:57")
figure = whirlmap.plot.diagram_figure(diagram, ["y"])

# %%
# Linear theory finds the threshold without integrating anything. For the rigid rotor of the stock case:

print("threshold s =", whirlmap.stability_threshold(whirlmap.load("jeffcott"), "s", (2.0, 3.0)))

# %%
# The orbit of the journal in its clearance, in whip:

whip = whirlmap.simulate(whirlmap.load("machines/jeffcott-rig", s=3), transient=300, periods=12)
orbit = whirlmap.plot.draw_orbit(whip, "ux", "uy", clearance=1.0)
