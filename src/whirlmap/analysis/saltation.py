"""Where tangent dynamics would be wrong: rates that jump.

At a kink of the rates (a dead zone, a wall) the tangent vectors go on as they are. At a jump (dry friction that changes
its sign, an impact) they have to be multiplied by a saltation matrix, and without it exponents and multipliers are wrong
by an amount of order one. whirlmap applies none, so it refuses.
"""

from whirlmap.equations.model import Model
from whirlmap.errors import RangeError


def refuse_jumps(model: Model, what: str) -> None:
    """Refuse a quantity that rests on tangent vectors for a model whose rates jump.

    Raises
    ------
    RangeError
        Naming where the rates jump, and what can be done instead.
    """
    if model.jumps:
        raise RangeError(
            f"{model.name}: {what} cannot be had, for its rates jump at {', '.join(model.jumps)}, and tangent vectors are"
            " not corrected there (saltation); make the jump continuous, such as v/sqrt(v^2 + v_0^2) for sign(v), or use"
            " simulate, section and bifurcation without exponents"
        )
