"""
The paper: a gear pair on porous bearings
=========================================

The system of :cite:t:`changjian-psfd`, with the equations as derived (edition *intended*) and parameters that
a search chose by the paper's own statements. The paper draws the motion once per mesh period T against the
speed ratio s.

**What to look at:** three clouds or sets of points that the eye would have to judge, and the labels that the
indicators give them. A closed curve is a torus: quasi-periodic, not chaotic.
"""

from matplotlib.figure import Figure

import whirlmap

system = whirlmap.load("gear-psfd/intended", psi=1e-4)
print("T =", system.period, " common period =", system.common_period / system.period, "T")

speeds = [0.6, 1.5, 3.0]
found = whirlmap.label_points(system, {"s": speeds})
words = whirlmap.labels(found).values

figure = Figure(figsize=(10, 3.6), layout="constrained")
for ax, s, word, n in zip(figure.subplots(1, 3), speeds, words, found["period_T"].values, strict=True):
    points = whirlmap.section(whirlmap.load("gear-psfd/intended", psi=1e-4, s=s), points=1600, transient=200)
    whirlmap.plot.draw_section(points, "yp", "vyp", ax=ax)
    ax.set_title(f"s = {s}: {word}" + (f", {n:.0f}T" if n else ""), loc="left")
