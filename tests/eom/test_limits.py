"""Deadlines, and how often garbage is looked for."""

import gc
import threading

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


def test_the_last_thread_to_leave_gives_back_what_the_first_found():
    def work():
        with limits.seldom_collected():
            arrived.set()
            assert leave.wait(60)

    before, arrived, leave = gc.get_threshold(), threading.Event(), threading.Event()
    gc.set_threshold(700, 10, 10)
    try:
        other = threading.Thread(target=work)
        with limits.seldom_collected():
            other.start()
            assert arrived.wait(60)
        assert gc.get_threshold() == limits.SELDOM
        leave.set()
        other.join(60)
        assert gc.get_threshold() == (700, 10, 10)
    finally:
        leave.set()
        gc.set_threshold(*before)


@pytest.mark.parametrize("own", [(0, 10, 10), (10**6, 5, 5)])
def test_who_collects_never_or_more_seldom_is_left_alone(own):
    before = gc.get_threshold()
    gc.set_threshold(*own)
    try:
        with limits.seldom_collected():
            assert gc.get_threshold() == own
        assert gc.get_threshold() == own
    finally:
        gc.set_threshold(*before)


def test_the_sooner_of_two_deadlines_holds():
    with limits.deadline(1e9, "all"):
        with (
            limits.deadline(-1.0, "this part"),
            pytest.raises(limits.Overdue, match="this part takes more than -1 s"),
        ):
            limits.check()
        limits.check()
