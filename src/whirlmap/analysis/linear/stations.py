"""Places of a model whose motion can be probed."""

from whirlmap.equations.model import Model


def stations_of(model: Model) -> dict[str, tuple[str, str]]:
    """States or outputs along x and y at each place that can be probed: those declared, else the centres of bodies."""
    centres = {name: (q[0].name, q[1].name) for name, q in model.bodies.items() if len(q) == 2}
    return dict(model.stations) or centres
