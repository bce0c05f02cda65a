"""The Lorenz system."""

from whirlmap.equations import Family, Model, Parameter, Section, State

x = State("x", "1", "convective overturning", start=1.0)
y = State("y", "1", "horizontal temperature difference", start=1.0)
z = State("z", "1", "departure of the vertical temperature profile", start=1.0)

sigma = Parameter("sigma", "1", "Prandtl number", latex=r"\sigma")
rho = Parameter("rho", "1", "Rayleigh number over its critical value", latex=r"\rho")
beta = Parameter("beta", "1", "geometric factor", latex=r"\beta")


def declare() -> Model:
    """Declare the system; cut where z falls through rho - 1, the height of the two foci."""
    return Model(
        name="lorenz",
        states=(x, y, z),
        parameters=(sigma, rho, beta),
        equations={x: sigma * (y - x), y: x * (rho - z) - y, z: x * y - beta * z},
        section=Section(z - (rho - 1), "falling"),
        typical_time=0.75,  # mean time of one turn about a focus at 10, 28, 8/3
        swing=(x,),
        sources=("lorenz1963",),
    )


LORENZ = Family("lorenz", declare)
