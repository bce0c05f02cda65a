"""
Van der Pol's oscillator: tongues of entrainment
================================================

An oscillator with a rhythm of its own is driven at another one (:cite:t:`vanderpol1927`). Inside of a tongue
it takes over the rhythm of the drive, or a simple ratio of it; outside it keeps both, and its motion is
quasi-periodic.

**What to look at:** the tongue of 1T widens with the amplitude of the drive, from the oscillator's own
frequency 0.943 on.
"""

import whirlmap

system = whirlmap.load("van_der_pol")
tongues = whirlmap.regime_map(system, {"omega": "0.6:1.4:48", "A": "0.05:1.2:24"})
figure = whirlmap.plot.regime_map_figure(tongues)

# %%
# One line through the map: labels along the frequency for a weak drive.

line = whirlmap.bifurcation_diagram(whirlmap.load("van_der_pol", A=0.3), "omega", "0.8:1.1:61")
strip = whirlmap.plot.diagram_figure(line, ["x"])
