"""The Roessler system."""

from whirlmap.equations import Family, Model, Parameter, Section, State

x = State("x", "1", "x", start=1.0)
y = State("y", "1", "y", start=1.0)
z = State("z", "1", "z", start=0.0)

a = Parameter("a", "1", "growth of the spiral")
b = Parameter("b", "1", "injection")
c = Parameter("c", "1", "threshold of the fold")


def declare() -> Model:
    """Declare the system; cut where x rises through zero, once per loop."""
    return Model(
        name="roessler",
        states=(x, y, z),
        parameters=(a, b, c),
        equations={x: -y - z, y: x + a * y, z: b + z * (x - c)},
        section=Section(x, "rising"),
        typical_time=5.9,  # period of the one-loop cycle at 0.2, 0.2, 5.7
        swing=(x,),
        sources=("roessler1976",),
    )


ROESSLER = Family("roessler", declare)
