"""Shared by all tests: one cache of compiled code, and the targets of this machine."""

import gc
import os
import shutil
import time

import pytest
from hypothesis import HealthCheck, Phase, settings

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

gc.set_threshold(*SELDOM)
"""As the command line does; in a long run of tests, one collection of all generations takes seconds."""

TARGETS = ("numpy", "c") if native.compiler() else ("numpy",)


FORGOTTEN = 7 * 24 * 3600
"""Seconds after which compiled code of earlier runs is made anew, so that the folder does not grow."""


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
