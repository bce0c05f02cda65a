"""What a page may send: names that are known, and numbers that are finite and not oversized; all else is refused."""

from collections.abc import Collection, Mapping
from http import HTTPStatus
from typing import Any

from whirlmap.errors import nearest

#: Bytes of a request's body at most, values in it, letters of a name, and the largest size of a number.
BODY, VALUES, NAME, LARGEST = 65536, 256, 64, 1e30


class Refused(Exception):  # noqa: N818 (an answer, not a defect)
    """A request that is not answered, with the status that says why."""

    def __init__(self, status: HTTPStatus, reason: str) -> None:
        super().__init__(reason)
        self.status, self.reason = status, reason


def number(value: Any, what: str) -> float:
    """A finite number of ordinary size."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise Refused(HTTPStatus.UNPROCESSABLE_ENTITY, f"{what}: expected a number")
    if not abs(value) <= LARGEST:  # of whole numbers too, which may be too long for a float
        raise Refused(HTTPStatus.UNPROCESSABLE_ENTITY, f"{what}: expected a number of size {LARGEST:g} at most")
    return float(value)


def whole(value: Any, what: str, least: int, most: int) -> int:
    """A whole number within limits."""
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise Refused(HTTPStatus.UNPROCESSABLE_ENTITY, f"{what}: expected a whole number from {least} to {most}")
    return value


def known(value: Any, names: Collection[str], what: str) -> str:
    """A name that is one of some."""
    if not isinstance(value, str) or len(value) > NAME or value not in names:
        near = nearest(value, names) if isinstance(value, str) and len(value) <= NAME else ""
        raise Refused(HTTPStatus.UNPROCESSABLE_ENTITY, f"{what}: found a name that is not known.{near}")
    return value


def numbers_of(value: Any, names: Collection[str], what: str) -> dict[str, float]:
    """Numbers by name."""
    if not isinstance(value, Mapping) or len(value) > VALUES:
        raise Refused(HTTPStatus.UNPROCESSABLE_ENTITY, f"{what}: expected at most {VALUES} numbers by name")
    return {known(name, names, what): number(one, f"{what} {name}") for name, one in value.items()}


def values_of(value: Any, names: Collection[str], words: Mapping[str, Collection[str]], what: str) -> dict[str, float | str]:
    """Numbers by name, and of the names in ``words`` one of their words."""
    given = value if isinstance(value, Mapping) else {}
    chosen = {name: known(word, words[name], f"{what} {name}") for name, word in given.items() if name in words}
    rest = {name: one for name, one in given.items() if name not in words} if chosen else value
    return {**numbers_of(rest, names, what), **chosen}


def range_of(value: Any, what: str) -> tuple[float, float]:
    """Two numbers that ascend."""
    if not isinstance(value, list) or len(value) != 2:
        raise Refused(HTTPStatus.UNPROCESSABLE_ENTITY, f"{what}: expected two numbers")
    low, high = number(value[0], what), number(value[1], what)
    if not low < high:
        raise Refused(HTTPStatus.UNPROCESSABLE_ENTITY, f"{what}: expected the lower number first")
    return low, high
