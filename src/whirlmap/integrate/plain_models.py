"""A model's closed form where a parameter is zero."""

from functools import lru_cache

from whirlmap.equations.model import Model
from whirlmap.equations.quantities import Parameter


@lru_cache(maxsize=64)
def plain_model(model: Model, parameter: Parameter) -> Model:
    """The closed form of a model where this parameter is zero; equal ones are the same object, whose kernels are found."""
    return model.plain[parameter]()
