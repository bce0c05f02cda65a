"""Cases: named, readable files of parameters, each number with its unit and its source."""

from whirlmap.cases.case import Case as Case
from whirlmap.cases.case import Given as Given
from whirlmap.cases.case import names as names
from whirlmap.cases.case import read as read
from whirlmap.cases.settle import Settled as Settled
from whirlmap.cases.settle import settle as settle
