"""Bearings of a machine file: with a film, or by their coefficients."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from whirlmap.cases.machine_speed_table import speed_table
from whirlmap.cases.machine_stations import Stations
from whirlmap.cases.machine_tables import PartTable, defaults
from whirlmap.equations.quantities import Parameter
from whirlmap.errors import nearest
from whirlmap.machines.assembly import AnyBearing
from whirlmap.machines.parts import coefficients, journal
from whirlmap.machines.shafts import JOURNAL


@dataclass(frozen=True)
class Bearings:
    """What bearings refer to: stations of shafts, lubricants by name as viscosity and density, names of supports."""

    stations: Stations
    oils: Mapping[str, tuple[Parameter, Parameter]]
    supports: Sequence[str]

    def bearing(self, table: PartTable) -> AnyBearing:
        """Read one bearing.

        Raises
        ------
        CaseError
            Whatever is wrong with it, naming file, table and key.
        """
        if table.texts.get("kind") == "coefficients":
            return self._coefficients(table)
        shaft, texts = self.stations.shaft(table), defaults(journal.FIELDS)
        texts |= table.texts
        if texts["film"] == "porous":
            table.needs(("Phi", "H"), "film = porous", journal.FIELDS)
        if texts["contact"] == "rub":
            table.needs(("K_r", "h_r", "mu_r"), "contact = rub", journal.FIELDS)
        if texts["contact"] == "ignore" and texts["film"] != "printed":
            raise table.fault(
                "contact", "found 'ignore' with a film that has a wall, expected stop or rub, or film = printed"
            )
        if texts["kind"] == "damper" and texts["arc"] == "fixed" and texts["film"] != "printed":
            raise table.fault("arc", "found 'fixed' for a damper, expected positive: the half film 0..pi follows the"
                                     " spin of a journal, and a damper has none")  # fmt: skip
        if texts["kind"] == "damper" and texts["contact"] == "rub":
            raise table.fault(
                "contact", "found 'rub' for a damper, expected stop: its friction follows the spin of a journal"
            )
        held = self.support(table)
        oil = texts.get("lubricant", next(iter(self.oils)) if len(self.oils) == 1 else None)
        if oil is None or oil not in self.oils:
            found = f"the lubricant {oil!r}" if oil else "no lubricant"
            raise table.fault(
                "lubricant" if oil else "", f"found {found}, expected one of {', '.join(self.oils) or 'a [lubricant]'}"
            )
        mu, rho = self.oils[oil]
        alike = self._alike(table)
        return journal.JournalBearing(
            name=table.name, shaft=shaft,
            station=self.stations.station(table, shaft, table.values.get("at"), lumped=JOURNAL),
            kind=texts["kind"], film=texts["film"], arc=texts["arc"], contact=texts["contact"],
            given=frozenset(table.numbers), lubricant=mu, density=rho, support=held, alike=alike,
        )  # fmt: skip

    def support(self, table: PartTable) -> str:
        """Name of the support of a part; empty for ground."""
        held, known = table.texts.get("support", ""), self.supports
        if held and held not in known:
            raise table.fault("support", f"found the support {held!r}, expected one of"
                                         f" {', '.join(known) or 'none there is'}.{nearest(held, known)}")  # fmt: skip
        return held

    @staticmethod
    def _alike(table: PartTable) -> int:
        alike = table.whole("two_alike", 1, 1)
        if alike > 2:
            raise table.fault("two_alike", f"found {alike}, expected 1 or 2")
        return alike

    def _coefficients(self, table: PartTable) -> coefficients.CoefficientBearing:
        shaft = self.stations.shaft(table)
        speeds, rows = speed_table(table)
        if not self.stations.elements[shaft]:
            raise table.fault("shaft", f"found the lumped rotor {shaft}, whose end without mass cannot carry a bearing by"
                                       " coefficients; expected a shaft with elements")  # fmt: skip
        return coefficients.CoefficientBearing(
            table.name, shaft, self.stations.station(table, shaft, table.values.get("at")), frozenset(table.numbers),
            speeds, rows, self.support(table), self._alike(table),
        )  # fmt: skip
