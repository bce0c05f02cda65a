"""A journal that rubs its bearing: surfaces touch below the height of their roughness, before the film is gone.

From the eccentricity ``eps_r`` on the wall pushes back with a linear stiffness, and dry friction acts on the journal's
surface against its slip. The surface slides with the spin: its speed is R/c, some hundred times, that of the journal's
centre, so slip has the sign of the spin and does not reverse. The force therefore has a kink where contact begins but no
jump, it is zero at the centre, and it turns with the frame: no direction in the bearing is special.
Source: the normal and friction force of rub-impact models, Chu and Zhang 1998, for a journal in place of a rotor disc.
"""

from collections.abc import Mapping

from sympy import Expr

from whirlmap.equations import Parameter, sqrt, when
from whirlmap.films.law import CENTRE

eps_r = Parameter("eps_r", "1", "eccentricity at which the surfaces touch", latex=r"\varepsilon_r", above=0, below=1)
kappa_r = Parameter("kappa_r", "1", "stiffness of one bearing's wall, K_r/K_p", latex=r"\kappa_r", at_least=0)
mu_r = Parameter("mu_r", "1", "dry friction coefficient of journal on bearing", latex=r"\mu_r", at_least=0)

PARAMETERS = (eps_r, kappa_r, mu_r)


def wall_force(ux: Expr, uy: Expr, sense: Expr) -> tuple[Expr, Expr]:
    """Force of one bearing's wall on its journal, over K_p c; ``sense`` is the sign of the journal's spin."""
    eps = sqrt(ux**2 + uy**2 + CENTRE)
    pressed = when(eps > eps_r, kappa_r * (eps - eps_r) / eps)  # N/eps
    return pressed * (-ux + mu_r * sense * uy), pressed * (-uy - mu_r * sense * ux)


def slides(values: Mapping[str, float]) -> str:
    """Refuse friction on a journal that does not spin."""
    still = [name for name in ("j_p", "j_g") if values.get(name, 1.0) == 0.0]
    if still and values["mu_r"] > 0.0:
        return (
            f"{' and '.join(still)} = 0 with mu_r = {values['mu_r']:g}: the friction of contact = rub follows the"
            " journal's spin; expected mu_r = 0 for a journal that does not spin"
        )
    return ""
