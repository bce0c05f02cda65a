"""The language that models are written in: SymPy expressions of declared quantities."""

from sympy import cbrt as cbrt
from sympy import cos as cos
from sympy import pi as pi
from sympy import sign as sign
from sympy import sin as sin
from sympy import sqrt as sqrt

from whirlmap.equations.model import Family as Family
from whirlmap.equations.model import Film as Film
from whirlmap.equations.model import Model as Model
from whirlmap.equations.model import Output as Output
from whirlmap.equations.model import Section as Section
from whirlmap.equations.model import Stop as Stop
from whirlmap.equations.model import Switching as Switching
from whirlmap.equations.pieces import Table as Table
from whirlmap.equations.pieces import magnitude as magnitude
from whirlmap.equations.pieces import tabulated as tabulated
from whirlmap.equations.pieces import when as when
from whirlmap.equations.quantities import Parameter as Parameter
from whirlmap.equations.quantities import State as State
from whirlmap.equations.quantities import states as states
from whirlmap.equations.quantities import t as t
