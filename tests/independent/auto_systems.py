"""Four systems for AUTO-07p: equations in Fortran, and the commands that follow their branches.

Forced systems are written with an oscillator that is added to the states, p' = p + Omega q - p (p^2 + q^2) and
q' = q - Omega p - q (p^2 + q^2), whose cycle is p = cos(Omega t), q = -sin(Omega t): AUTO follows autonomous systems.
"""

from typing import NamedTuple

ROUTINES = """
SUBROUTINE FUNC(NDIM,U,ICP,PAR,IJAC,F,DFDU,DFDP)
  IMPLICIT NONE
  INTEGER, INTENT(IN) :: NDIM, ICP(*), IJAC
  DOUBLE PRECISION, INTENT(IN) :: U(NDIM), PAR(*)
  DOUBLE PRECISION, INTENT(OUT) :: F(NDIM)
  DOUBLE PRECISION, INTENT(INOUT) :: DFDU(NDIM,NDIM), DFDP(NDIM,*)
  DOUBLE PRECISION :: R
{rates}
END SUBROUTINE FUNC
SUBROUTINE STPNT(NDIM,U,PAR,T)
  IMPLICIT NONE
  INTEGER, INTENT(IN) :: NDIM
  DOUBLE PRECISION, INTENT(INOUT) :: U(NDIM), PAR(*)
  DOUBLE PRECISION, INTENT(IN) :: T
  DOUBLE PRECISION :: TPI
  TPI = 8*ATAN(1D0)
{first}
END SUBROUTINE STPNT
SUBROUTINE BCND
END SUBROUTINE BCND
SUBROUTINE ICND
END SUBROUTINE ICND
SUBROUTINE FOPT
END SUBROUTINE FOPT
SUBROUTINE PVLS
END SUBROUTINE PVLS
"""

#: Constants of all runs.
COMMON = (
    "common = dict(e='equations', ILP=1, ISP=2, ISW=1, IAD=3, EPSL=1e-11, EPSU=1e-11, EPSS=1e-9, DSMIN=1e-6,"
    " NMX=3000, NPR=100000, ITMX=30, ITNW=9, NWTN=5, JAC=0, IID=0, UZSTOP={}, UZR={})\n"
)


class AutoSystem(NamedTuple):
    """Equations and commands.

    Attributes
    ----------
    states : tuple of str
        Without those of the added oscillator.
    forced : bool
        Whether the last two of AUTO's states are the added oscillator.
    rates, first : str
        Bodies of FUNC and STPNT. PAR(1) is the varied parameter.
    commands : str
        Each branch is saved under a name of its own.
    branches : tuple of str
        These names.
    """

    states: tuple[str, ...]
    forced: bool
    rates: str
    first: str
    commands: str
    branches: tuple[str, ...]


DUFFING = AutoSystem(
    ("x", "v"), True,
    """
  R = U(3)**2 + U(4)**2
  F(1) = U(2)
  F(2) = PAR(2)*U(3) - 0.05D0*U(2) - U(1) - 0.1D0*U(1)**3
  F(3) = U(3) + PAR(1)*U(4) - U(3)*R
  F(4) = U(4) - PAR(1)*U(3) - U(4)*R""",
    """
  PAR(1) = 0.5D0
  PAR(2) = 0D0
  PAR(11) = TPI/PAR(1)
  U(1:2) = 0D0
  U(3) = COS(TPI*T)
  U(4) = -SIN(TPI*T)""",
    """
common.update(NDIM=4, IPS=2, NTST=60, NCOL=7, DS=0.02, DSMAX=0.1)
begin = run(ICP=[2, 11], **dict(common, UZSTOP={2: 0.18}))
at = [0.6, 0.8, 1.0, 1.1, 1.15, 1.2, 1.25, 1.7]
save(run(begin('UZ1'), ICP=[1, 11], **dict(common, UZSTOP={1: 2.0}, UZR={1: at})), 'orbit')
""",
    ("orbit",),
)  # fmt: skip

HOPF = AutoSystem(
    ("x", "y"), True,
    """
  R = U(1)**2 + U(2)**2
  F(1) = U(1) - 2*U(2) - R*U(1) + PAR(2)*U(3)
  F(2) = U(2) + 2*U(1) - R*U(2) - PAR(2)*U(4)
  R = U(3)**2 + U(4)**2
  F(3) = U(3) + PAR(1)*U(4) - U(3)*R
  F(4) = U(4) - PAR(1)*U(3) - U(4)*R""",
    """
  PAR(1) = 2D0
  PAR(2) = 0D0
  PAR(11) = TPI/PAR(1)
  U(1) = COS(TPI*T)
  U(2) = SIN(TPI*T)
  U(3) = COS(TPI*T)
  U(4) = -SIN(TPI*T)""",
    """
common.update(NDIM=4, IPS=2, NTST=30, NCOL=6, DS=0.02, DSMAX=0.1)
begin = run(ICP=[2, 11], **dict(common, ISP=0, UZSTOP={2: 0.6}))
at = [2.1, 2.3, 2.5, 2.8, 3.0, 3.4, 3.8]
save(run(begin('UZ1'), ICP=[1, 11], **dict(common, UZSTOP={1: 4.0}, UZR={1: at})), 'orbit')
""",
    ("orbit",),
)  # fmt: skip

ROESSLER = AutoSystem(
    ("x", "y", "z"), False,
    """
  F(1) = -U(2) - U(3)
  F(2) = U(1) + 0.2D0*U(2)
  F(3) = 0.2D0 + U(3)*(U(1) - PAR(1))""",
    """
  PAR(1) = 2.6D0""",
    """
common.update(IPS=2, NTST=100, NCOL=6, DS=0.02, DSMAX=0.3)
at = [2.7, 2.9, 3.2, 3.7, 4.2]
one = run(dat='cycle', ICP=[1, 11], NDIM=3, **dict(common, UZSTOP={1: 4.4}, UZR={1: at}))
save(one, 'cycle')
doubled = dict(common, ISW=-1, NTST=150, UZSTOP={1: 4.4}, UZR={1: [2.9, 3.1, 3.4, 3.8, 4.2]})
save(run(one('PD1'), ICP=[1, 11], **doubled), 'doubled')
""",
    ("cycle", "doubled"),
)  # fmt: skip

LORENZ = AutoSystem(
    ("x", "y", "z"), False,
    """
  F(1) = 10*(U(2) - U(1))
  F(2) = U(1)*(PAR(1) - U(3)) - U(2)
  F(3) = U(1)*U(2) - 8*U(3)/3D0""",
    """
  PAR(1) = 30D0
  U(1) = SQRT(8*(PAR(1) - 1)/3D0)
  U(2) = U(1)
  U(3) = PAR(1) - 1""",
    """
at = [2.0, 5.0, 10.0, 14.0, 20.0, 28.0]
rest = run(ICP=[1], NDIM=3, IPS=1, DS=-0.02, DSMAX=0.2, **dict(common, UZSTOP={1: 30.5}, UZR={1: at}))
save(rest, 'equilibrium')
common.update(IPS=2, NTST=200, NCOL=5, DS=-0.02, DSMAX=0.5)
save(run(rest('HB1'), ICP=[1, 11], **dict(common, UZSTOP={1: 14.0}, UZR={1: [24, 22, 20, 18, 16, 15]})), 'cycle')
""",
    ("equilibrium", "cycle"),
)  # fmt: skip

SYSTEMS = {"duffing": DUFFING, "forced_hopf": HOPF, "roessler": ROESSLER, "lorenz": LORENZ}
