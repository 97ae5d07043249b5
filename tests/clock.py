"""Times as ratios to a fixed piece of work, so that bounds hold on any machine."""

import time


def reference():
    """Seconds of a loop that takes about 0.05 s where the figures of the README were measured."""
    return min(_loop() for _ in range(3))


def _loop():
    start = time.process_time()
    assert sum(k * k % 7 for k in range(600_000)) > 0
    return time.process_time() - start


ATTEMPTS = 6


def within(bound, measure):
    """Tell whether a measurement is below ``bound``, both taken anew until one is, a few times.

    Another process makes single runs slow, on either side; a law that is broken stays broken.
    """
    return any(measure() < bound() for _ in range(ATTEMPTS))


def growth_within(limit, work, small, large):
    """Tell whether ``work(large)`` takes less than ``limit`` times the time of ``work(small)``."""
    return within(lambda: limit * _seconds(work, small), lambda: _seconds(work, large))


def _seconds(work, argument):
    start = time.process_time()
    work(argument)
    return time.process_time() - start
