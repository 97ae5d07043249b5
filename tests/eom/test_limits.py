"""Deadlines, and how often garbage is looked for."""

import gc

import pytest

from eom import limits


def test_thresholds_are_given_back_whatever_happens():
    def work():
        with limits.seldom_collected():
            inside.append(gc.get_threshold())
            return 1 / 0

    before, inside = gc.get_threshold(), []
    with pytest.raises(ZeroDivisionError):
        work()
    assert inside == [limits.SELDOM]
    assert gc.get_threshold() == before


def test_the_sooner_of_two_deadlines_holds():
    with limits.deadline(1e9, "all"):
        with (
            limits.deadline(-1.0, "this part"),
            pytest.raises(limits.Overdue, match="this part takes more than -1 s"),
        ):
            limits.check()
        limits.check()
