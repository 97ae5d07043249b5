"""Shared by all tests: one cache of compiled code, the targets of this machine, what is left out."""

import gc
import os
import shutil
import time
import zlib

import pytest
from hypothesis import HealthCheck, Phase, settings

from codegen.loops import taylor, taylor_lanes
from codegen.native import native
from eom.limits import SELDOM

settings.register_profile(
    "same",
    deadline=None,
    derandomize=True,
    database=None,
    report_multiple_bugs=False,
    phases=(Phase.explicit, Phase.generate, Phase.shrink),
    suppress_health_check=[
        HealthCheck.too_slow,
        HealthCheck.data_too_large,
        HealthCheck.filter_too_much,
    ],
)
settings.register_profile("other", settings.get_profile("same"), derandomize=False)
settings.load_profile("same")
"""The same examples each time, so that a change alone can turn a test red; others on request:
pytest --hypothesis-profile=other."""

FEW = 25
"""Examples of a property in the default suite; Hypothesis' own number, which slow tests draw, is 100."""


gc.set_threshold(*SELDOM)
"""As the command line does; in a long run of tests, one collection of all generations takes seconds."""

TARGETS = ("numpy", "c") if native.compiler() else ("numpy",)


FORGOTTEN = 7 * 24 * 3600
"""Seconds after which compiled code of earlier runs is made anew, so that the folder does not grow."""


collect_ignore_glob = ["eom/checker/unseen/oracle_*.py"]
"""No tests, and their import takes long: `test_unseen` reads them."""

QUICK_FLAGS = {
    module: tuple("-O0" if flag.startswith("-O") else flag for flag in module.FLAGS)
    for module in (native, taylor, taylor_lanes)
}
"""Five times as fast to compile; same numbers, but in Taylor loops, which fuse operations if optimised."""

MARKS = (
    "sparse(most, only, slow): by default the diagonal of the product runs, at most so many",
    "long: CI does not run it, since a shorter form asks the same; it has a command of its own",
    "shipped_flags(when): compiled as users' code is, where flags are the question; 'slow': if it is slow",
)
"""Of `sparse`: at most so many, or the ids ``only``; slow tests run the ids ``slow``, by default all."""


def pytest_configure(config):
    """Say what the marks mean; choose how many examples properties take, before they are decorated."""
    for mark in MARKS:
        config.addinivalue_line("markers", mark)
    if config.getoption("markexpr") == "not slow" and not config.getoption("--hypothesis-profile"):
        settings.register_profile("few", settings.get_profile("same"), max_examples=FEW)
        settings.load_profile("few")


def spread(count, most):
    """Return at most so many of the numbers below ``count``, evenly."""
    return {k * count // most for k in range(most)} if most < count else set(range(count))


def thinned(items, most=None, only=(), slow=()):
    """Return the cases of one test that the default suite runs; its name says where they begin."""
    if only:
        return [item for item in items if item.callspec.id in only]
    places = [tuple(item.callspec._idlist) for item in items]  # an id of each set of parameters
    axes = [tuple(dict.fromkeys(axis)) for axis in zip(*places, strict=True)]
    longest = max(map(len, axes))
    first = zlib.crc32(items[0].originalname.encode())
    numbers = [first + k for k in spread(longest, most or longest)]
    kept = {tuple(axis[k % len(axis)] for axis in axes) for k in numbers}
    return [item for item, place in zip(items, places, strict=True) if place in kept]


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Mark as slow what `sparse` leaves out, and all that needs the built site."""
    for item in items:
        if "site" in getattr(item, "fixturenames", ()):
            item.add_marker("slow")
    tests = {}
    for item in items:
        if item.get_closest_marker("sparse") and hasattr(item, "callspec"):
            tests.setdefault(item.nodeid.partition("[")[0], []).append(item)
    for cases in tests.values():
        mark = cases[0].get_closest_marker("sparse")
        found = thinned(cases, *mark.args, **mark.kwargs) or cases[:1]  # one that is asked for
        kept, slow = {item.nodeid for item in found}, mark.kwargs.get("slow")
        for item in cases:
            if item.nodeid not in kept:
                item.add_marker("slow")
                if slow and item.callspec.id not in slow:
                    item.add_marker("long")


@pytest.fixture(autouse=True)
def quick_flags(request, monkeypatch):
    """Compile quickly, but for tests of what users' flags could change."""
    slow, mark = map(request.node.get_closest_marker, ("slow", "shipped_flags"))
    if not mark or (mark.args and not slow):
        for module, flags in QUICK_FLAGS.items():
            monkeypatch.setattr(module, "FLAGS", flags)


def pytest_sessionstart(session):
    """Leave out what was compiled long ago, before workers begin."""
    if not hasattr(session.config, "workerinput"):
        for folder in session.config.cache.mkdir("compiled").iterdir():
            if time.time() - folder.stat().st_mtime > FORGOTTEN:
                shutil.rmtree(folder, ignore_errors=True)


@pytest.fixture(scope="session", autouse=True)
def shared_cache(pytestconfig):
    """Compile into one folder of all workers and runs; its keys are compiler, flags and text."""
    folder = pytestconfig.cache.mkdir("compiled")
    folder.chmod(0o700)
    before = os.environ.get(native.CACHE_VARIABLE)
    os.environ[native.CACHE_VARIABLE] = str(folder)
    yield
    if before is None:
        del os.environ[native.CACHE_VARIABLE]
    else:
        os.environ[native.CACHE_VARIABLE] = before


@pytest.fixture(scope="session", params=TARGETS)
def target(request):
    """Each target that works here; C only where there is a compiler."""
    return request.param
