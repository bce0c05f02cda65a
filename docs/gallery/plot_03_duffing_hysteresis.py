"""
Hysteresis, and the branch behind it
====================================

A hardening spring: on the way up the amplitude follows the resonance beyond the point at which, on the way
down, it jumps up. The branch of periodic orbits joins both motions by a part that is unstable, between two
folds.

**What to look at:** points are what a sweep up and a sweep down find; the dashed part of the branch is what
neither can find.
"""

import whirlmap

system = whirlmap.load("duffing", alpha=1, beta=0.5, delta=0.1, gamma=0.5)
sweeps = whirlmap.bifurcation_diagram(system, "omega", "0.8:2.2:71", follow="both")
branch = whirlmap.continue_orbit(system, "omega", "0.8:2.2")
figure = whirlmap.plot.diagram_figure(sweeps, ["x"], branches=branch)

# %%
# The folds of the branch are located as roots of its equations, not read from the figure:

for kind, omega in zip(whirlmap.labels(branch, "event_kind").values, branch["event_omega"].values, strict=True):
    print(f"{kind} at omega = {omega:.9f}")
