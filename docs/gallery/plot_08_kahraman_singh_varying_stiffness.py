"""
Kahraman and Singh's gear with varying stiffness
================================================

The gear pair with backlash, a mesh stiffness with three harmonics, and three harmonics of the transmission
error, with the numbers of the data set of Antoniadou and others (2015): zeta = 0.05, mean load 0.1, stiffness
1 - 0.2 cos - 0.1 cos 2 - 0.05 cos 3, errors 0.01, 0.004 and 0.002. The equation is that of
:cite:t:`kahraman1990`, with a stiffness that changes with the mesh. It is declared here, in the script.

**What to look at:** T is the period of the fastest harmonic, so that 3T is one mesh period: the motion has
the period of the mesh at all these frequencies. Below the main resonance a sweep up and a sweep down find
different motions; a narrower such range lies near one half of it, where the second harmonic excites the
resonance.
"""

import whirlmap
from whirlmap.equations import Model, Parameter, State, Switching, cos, t, when

x = State("x", "1", "dynamic transmission error over half the backlash", start=1.1)
v = State("v", "1", "its rate")
zeta = Parameter("zeta", "1", "damping ratio", at_least=0)
F_m = Parameter("F_m", "1", "mean load")
Omega = Parameter("Omega", "1", "mesh frequency over the natural frequency", above=0)

stiffness = 1 - 0.2 * cos(Omega * t) - 0.1 * cos(2 * Omega * t) - 0.05 * cos(3 * Omega * t)
errors = sum(a * (n * Omega) ** 2 * cos(n * Omega * t) for n, a in ((1, 0.01), (2, 0.004), (3, 0.002)))
dead_zone = when(x > 1, x - 1) + when(x < -1, x + 1)

GEAR = Model(
    name="varying_mesh",
    states=(x, v),
    parameters=(zeta, F_m, Omega),
    equations={x: v, v: F_m + errors - 2 * zeta * v - stiffness * dead_zone},
    harmonics=(Omega, 2 * Omega, 3 * Omega),
    switchings={"drive_side": Switching(x - 1, "the driving flanks touch")},
    swing=(x,),
)

# %%
# The data set is for Omega = 0.5. There the teeth part for a fifth of the time:

system = whirlmap.load(GEAR, zeta=0.05, F_m=0.1, Omega=0.5)
series = whirlmap.simulate(system, transient=200, periods=4)
print("contact for", whirlmap.surface_crossings(system, series)["share"].item(), "of the time")
axes = whirlmap.plot.draw_time_series(series, ["x"])

# %%
# Up and down through the resonances:

# sphinx_gallery_thumbnail_number = 2
sweeps = whirlmap.bifurcation_diagram(system, "Omega", "0.25:2.2:118", follow="both")
figure = whirlmap.plot.diagram_figure(sweeps, ["x"])
