"""The driven, damped pendulum, x'' + q x' + sin x = g cos(omega t); its angle is cyclic."""

from whirlmap.equations import Family, Model, Parameter, State, cos, pi, sin, t

x = State("x", "rad", "angle", cyclic=float(2 * pi))
v = State("v", "1", "angular velocity")

q = Parameter("q", "1", "damping")
g = Parameter("g", "1", "driving torque")
omega = Parameter("omega", "1", "driving frequency", latex=r"\omega", above=0)


def declare() -> Model:
    """Declare the pendulum."""
    return Model(
        name="pendulum",
        states=(x, v),
        parameters=(q, g, omega),
        equations={x: v, v: g * cos(omega * t) - q * v - sin(x)},
        harmonics=(omega,),
        clocks={"forcing": omega},
        swing=(x,),
        angular_acceleration={},  # the force has the same size at every speed
        sources=("baker1996",),
    )


PENDULUM = Family("pendulum", declare)
