"""Duffing's oscillator, x'' + delta x' + alpha x + beta x^3 = gamma cos(omega t)."""

from whirlmap.equations import Family, Model, Parameter, State, cos, t

x = State("x", "1", "displacement", start=1.0)
v = State("v", "1", "velocity")

delta = Parameter("delta", "1", "damping", latex=r"\delta")
alpha = Parameter("alpha", "1", "linear stiffness", latex=r"\alpha")
beta = Parameter("beta", "1", "cubic stiffness", latex=r"\beta")
gamma = Parameter("gamma", "1", "forcing amplitude", latex=r"\gamma")
omega = Parameter("omega", "1", "forcing frequency", latex=r"\omega", above=0)


def declare() -> Model:
    """Declare the oscillator."""
    return Model(
        name="duffing",
        states=(x, v),
        parameters=(delta, alpha, beta, gamma, omega),
        equations={x: v, v: gamma * cos(omega * t) - delta * v - alpha * x - beta * x**3},
        harmonics=(omega,),
        clocks={"forcing": omega},
        swing=(x,),
        angular_acceleration={},  # the force has the same size at every speed
        sources=("holmes1979",),
    )


DUFFING = Family("duffing", declare)
