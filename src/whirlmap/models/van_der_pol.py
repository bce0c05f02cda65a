"""Van der Pol's oscillator with forcing, x'' - mu (1 - x^2) x' + x = A cos(omega t)."""

from whirlmap.equations import Family, Model, Parameter, State, cos, t

x = State("x", "1", "displacement", start=1.0)
v = State("v", "1", "velocity")

mu = Parameter("mu", "1", "negative damping at the origin", latex=r"\mu")
A = Parameter("A", "1", "forcing amplitude")
omega = Parameter("omega", "1", "forcing frequency", latex=r"\omega", above=0)


def declare() -> Model:
    """Declare the oscillator."""
    return Model(
        name="van_der_pol",
        states=(x, v),
        parameters=(mu, A, omega),
        equations={x: v, v: mu * (1 - x**2) * v - x + A * cos(omega * t)},
        harmonics=(omega,),
        clocks={"forcing": omega},
        swing=(x,),
        angular_acceleration={},  # the force has the same size at every speed
        sources=("vanderpol1927",),
    )


VAN_DER_POL = Family("van_der_pol", declare)
