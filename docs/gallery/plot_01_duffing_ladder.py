"""
Duffing's oscillator: a ladder of period doublings
==================================================

A mass in a double well, driven harder and harder.
"""

import numpy as np

import whirlmap

system = whirlmap.load("duffing")
diagram = whirlmap.bifurcation_diagram(system, "gamma", np.linspace(0.2, 0.4, 101))
figure = whirlmap.plot.diagram_figure(diagram, ["x"])
