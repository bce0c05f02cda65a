"""
Duffing's oscillator: a ladder of period doublings
==================================================

A mass in a double well is driven harder and harder (:cite:t:`holmes1979`). Its period doubles from T to 2T,
4T, ..., and ends in chaos, in which windows of other periods open.

**What to look at:** the strip under the diagram has the label of every point, with the period in T; the
largest exponent below it is positive just where the label says *chaotic*, and falls to zero at each doubling.
"""

import numpy as np

import whirlmap

system = whirlmap.load("duffing")  # delta = 0.3, alpha = -1, beta = 1, omega = 1.2
diagram = whirlmap.bifurcation_diagram(system, "gamma", np.linspace(0.24, 0.4, 161))
figure = whirlmap.plot.diagram_figure(diagram, ["x"], title="Duffing, double well")

# %%
# The textbook ladder: 1T at gamma = 0.20, 2T at 0.28, 4T at 0.29, 5T at 0.37, chaos at 0.50, 2T at 0.65.

ladder = whirlmap.label_points(system, {"gamma": np.array([0.20, 0.28, 0.29, 0.37, 0.50, 0.65])})
for gamma, regime, period in zip(
    ladder["gamma"].values, whirlmap.labels(ladder).values, ladder["period_T"].values, strict=True
):
    print(f"gamma = {gamma:.2f}: {regime}" + (f", {period:.0f}T" if period else ""))
