"""A gear pair with backlash as one degree of freedom, x'' + 2 zeta x' + f(x) = F_m + F_ah Omega^2 cos(Omega t).

``f`` is a dead zone of half-width 1 with unit slope outside; ``x`` is the dynamic transmission error over half the backlash.
"""

from whirlmap.equations import Family, Model, Parameter, State, Switching, cos, sin, t, when

x = State("x", "1", "dynamic transmission error over half the backlash", start=1.1)
v = State("v", "1", "its rate")

zeta = Parameter("zeta", "1", "damping ratio", latex=r"\zeta", at_least=0)
F_m = Parameter("F_m", "1", "mean load")
F_ah = Parameter("F_ah", "1", "amplitude of the transmission error")
Omega = Parameter("Omega", "1", "mesh frequency over the natural frequency", latex=r"\Omega", above=0)

dead_zone = when(x > 1, x - 1) + when(x < -1, x + 1)


def declare() -> Model:
    """Declare the oscillator."""
    return Model(
        name="gear_backlash",
        states=(x, v),
        parameters=(zeta, F_m, F_ah, Omega),
        equations={x: v, v: F_m + F_ah * Omega**2 * cos(Omega * t) - 2 * zeta * v - dead_zone},
        harmonics=(Omega,),
        switchings={
            "drive_side": Switching(x - 1, "the driving flanks touch"),
            "back_side": Switching(-x - 1, "the back flanks touch"),
        },
        teeth=x - 1,
        clocks={"mesh": Omega},
        swing=(x,),
        # The force is -m e'' of the transmission error e = -F_ah cos(phase)/m: its phase accelerates too.
        angular_acceleration={v: F_ah * Omega**2 * sin(Omega * t)},
        sources=("kahraman1990",),
    )


GEAR_BACKLASH = Family("gear_backlash", declare)
