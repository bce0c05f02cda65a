"""
A rotor that rubs its stator
============================

A Jeffcott rotor with unbalance, and a stator of finite stiffness around it, with dry friction. Lengths are
over the clearance, time is counted in radians of the natural frequency. All numbers are assumed; the contact
law is that of the textbooks.

**What to look at:** as soon as the orbit of the unbalance would be larger than the clearance, the rotor
bounces, and its motion is quasi-periodic; well above the critical speed it is free again. Contact begins and
ends inside integration steps; every such crossing is located.
"""

import whirlmap
from whirlmap.equations import Model, Output, Parameter, Switching, cos, sin, sqrt, states, t, when

x, y = states("x y", "1", "centre of the disc over the clearance")
vx, vy = states("vx vy", "1", "its velocity")
zeta = Parameter("zeta", "1", "damping ratio", at_least=0)
kappa = Parameter("kappa", "1", "stiffness of the stator over that of the shaft", above=0)
mu = Parameter("mu", "1", "friction coefficient", at_least=0)
b = Parameter("b", "1", "unbalance eccentricity over the clearance", at_least=0)
Omega = Parameter("Omega", "1", "speed over the natural frequency", above=0)

r = sqrt(x**2 + y**2)
push = when(r > 1, kappa * (1 - 1 / r), 0)  # force of the wall over r, towards the centre

RUB = Model(
    name="rub_impact",
    states=(x, y, vx, vy),
    parameters=(zeta, kappa, mu, b, Omega),
    equations={
        x: vx,
        y: vy,
        vx: b * Omega**2 * cos(Omega * t) - 2 * zeta * vx - x - push * (x - mu * y),
        vy: b * Omega**2 * sin(Omega * t) - 2 * zeta * vy - y - push * (y + mu * x),
    },
    harmonics=(Omega,),
    outputs={"radius": Output(r, "1", "distance from the centre")},
    switchings={"wall": Switching(r - 1, "the disc touches the stator")},
    clocks={"shaft": Omega},
    swing=(x, y),
)

system = whirlmap.load(RUB, zeta=0.05, kappa=30, mu=0.1, b=0.3, Omega=1.0)
diagram = whirlmap.bifurcation_diagram(system, "Omega", "0.6:1.8:73")
figure = whirlmap.plot.diagram_figure(diagram, ["x"])

# %%
# One of these speeds: the orbit, with a mark once per turn.

series = whirlmap.simulate(whirlmap.load(RUB, zeta=0.05, kappa=30, mu=0.1, b=0.3, Omega=1.3), transient=300, periods=20)
orbit = whirlmap.plot.draw_orbit(series, "x", "y")
print("contact:", whirlmap.surface_crossings(system, series)["share"].item(), "of the time")
