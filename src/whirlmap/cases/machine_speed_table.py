"""Tables of coefficients against speed in a machine file, as vendors of bearings give them."""

from collections.abc import Mapping
from itertools import pairwise

from whirlmap.cases.machine_tables import PartTable
from whirlmap.machines.parts.coefficients import COEFFICIENTS, ROW

Rows = tuple[tuple[str, tuple[float, ...]], ...]


def speed_table(table: PartTable) -> tuple[tuple[float, ...], Rows]:
    """Read the table of a bearing by coefficients.

    Parameters
    ----------
    table : PartTable
        Of the bearing; its key ``table`` is a list of rows.

    Returns
    -------
    speeds : tuple of float
        [rad/s], ascending; empty where the coefficients are constant.
    rows : tuple of (str, tuple of float)
        Coefficients by their keys, one value for each speed [N/m, N s/m].

    Raises
    ------
    CaseError
        No coefficient, coefficients beside a table, fewer than two rows, speeds that do not ascend, or a coefficient that
        only some rows have.
    """
    keys, listed = [one.key for one in COEFFICIENTS], table.values.get("table")
    constant = [key for key in keys if table.has(key)]
    if listed is None:
        if not constant:
            raise table.fault("", 'found no coefficient, expected k_xx = "8e7 N/m" and the others, or a table against speed')
        return (), ()
    if constant:
        raise table.fault(constant[0], f"found {constant[0]} beside a table, expected it in the rows of the table")
    if not isinstance(listed, list) or len(listed) < 2 or not all(isinstance(one, Mapping) for one in listed):
        raise table.fault("table", "found no list of two rows or more, expected"
                                   ' table = [ { speed = "3000 rpm", k_xx = "8e7 N/m" }, ... ]')  # fmt: skip
    rows = []
    for values in listed:
        row = PartTable("bearing", table.name, values, table.sources)
        row.take(ROW)
        rows.append(row.fixed)
    speeds = tuple(row["speed"] for row in rows)
    for number, (slower, faster) in enumerate(pairwise(speeds), start=2):
        if faster <= slower:
            raise table.fault("table", f"found a speed in row {number} that is not above that of the row before, expected"
                                       " ascending speeds")  # fmt: skip
    used = [key for key in keys if any(key in row for row in rows)]
    if not used:
        raise table.fault("table", 'found no coefficient in its rows, expected k_xx = "8e7 N/m" and the others')
    for key in used:
        lacking = next((n for n, row in enumerate(rows, start=1) if key not in row), None)
        if lacking is not None:
            raise table.fault("table", f"found no {key} in row {lacking}, expected it in every row or in none")
    return speeds, tuple((key, tuple(row[key] for row in rows)) for key in used)
