"""Shared by all tests: a private cache of compiled code, and the targets of this machine."""

import gc
import os

import pytest
from hypothesis import HealthCheck, Phase, settings

from codegen import native
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


@pytest.fixture(scope="session", autouse=True)
def private_cache(tmp_path_factory):
    """Compile into a folder of this session; what is compiled twice is compiled once."""
    folder = tmp_path_factory.mktemp("cache")
    folder.chmod(0o700)
    before = os.environ.get(native.CACHE_VARIABLE)
    os.environ[native.CACHE_VARIABLE] = str(folder)
    yield folder
    if before is None:
        del os.environ[native.CACHE_VARIABLE]
    else:
        os.environ[native.CACHE_VARIABLE] = before


@pytest.fixture(scope="session", params=TARGETS)
def target(request):
    """Each target that works here; C only where there is a compiler."""
    return request.param
