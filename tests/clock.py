"""Work as counts of calls, or as ratios of times, so that bounds hold on any machine."""

import sys
import time


def calls(function, *arguments):
    """Count the calls of functions, in Python and in C, that ``function(*arguments)`` makes.

    The same on a busy machine as on an idle one. What one call does inside C is not seen.
    """
    count = 0

    def note(frame, event, argument):
        nonlocal count
        count += event in {"call", "c_call"}

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        function(*arguments)
    finally:
        sys.setprofile(before)
    return count


def growth_in_calls(limit, work, small, large):
    """Return whether ``work(large)`` makes less than ``limit`` times the calls of ``work(small)``.

    Both run once before: the first run of anything imports modules and fills caches.
    """
    work(small)
    work(large)
    return calls(work, large) < limit * calls(work, small)


ATTEMPTS = 6


def within(bound, measure):
    """Return whether a measurement is below ``bound``, both taken anew until one is, a few times.

    Another process makes single runs slow, on either side; a law that is broken stays broken.
    """
    return any(measure() < bound() for _ in range(ATTEMPTS))


def growth_within(limit, work, small, large):
    """Return whether ``work(large)`` takes less than ``limit`` times the time of ``work(small)``.

    For work inside C, such as that of regular expressions, whose calls say nothing.
    """
    return within(lambda: limit * _seconds(work, small), lambda: _seconds(work, large))


def _seconds(work, argument):
    start = time.process_time()
    work(argument)
    return time.process_time() - start
