"""Figures of the reproduction, drawn by other processes."""

import os
import signal

import pytest
from matplotlib.figure import Figure

from whirlmap.errors import RangeError
from whirlmap.studies.gear_psfd.reproduction.figures import Plan, Studio


def sheet(title):
    figure = Figure(figsize=(2, 1))
    figure.text(0.5, 0.5, title)
    return figure


def own_process(title):
    return sheet(str(os.getpid()))


def interrupted(title):
    os.kill(os.getpid(), signal.SIGINT)
    return sheet(title)


def refused(title):
    raise RangeError(title)


PLANS = [Plan(name, 2, "", sheet, (name,)) for name in "abcdef"]


def test_pictures_are_the_same_from_any_number_of_processes_and_in_order():
    with Studio(1) as alone, Studio(2) as two:
        one = list(alone.draw(PLANS))
        assert list(two.draw(PLANS)) == one
        here, there = (next(studio.draw([Plan("p", 2, "", own_process, ("p",))]))[1] for studio in (alone, two))
    assert [plan.stem for plan, _ in one] == list("abcdef")
    assert len({png for _, png in one}) == len(PLANS)
    assert here != there, "no other process has drawn anything"


def test_an_interrupt_of_the_terminal_is_left_to_the_process_that_started_them():
    with Studio(2) as studio:
        drawn = list(studio.draw([Plan("a", 2, "", interrupted, ("a",)), *PLANS]))
    assert drawn[0][1] == drawn[1][1]  # the interrupted one was drawn all the same, as "a"


@pytest.mark.parametrize("workers", [1, 2])
def test_an_error_in_a_figure_is_raised(workers):
    with Studio(workers) as studio, pytest.raises(RangeError, match="why"):
        list(studio.draw([Plan("a", 2, "", refused, ("why",))]))
