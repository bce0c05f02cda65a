"""
The driven pendulum: a strange attractor
========================================

At the damping and the frequency of Baker and Gollub (:cite:t:`baker1996`) the pendulum turns over
irregularly. Its angle is a cyclic state: sections and distances take it modulo 2 pi.

**What to look at:** the section once per T is a set of thin layers, and not a cloud; the running mean of the
largest exponent settles on a positive number.
"""

import whirlmap

system = whirlmap.load("pendulum")
section = whirlmap.section(system, points=6000, transient=200)
axes = whirlmap.plot.draw_section(section, "x", "v")

# %%
# Both exponents; their sum is the divergence of the flow, -q.

exponents = whirlmap.lyapunov_spectrum(system, common_periods=400)
convergence = whirlmap.plot.draw_convergence(exponents)
print(exponents["lyapunov"].values, "sum", exponents["lyapunov"].values.sum(), "divergence", -0.5)
