"""The same system gives the same bytes in every process, whatever Python hashes strings to."""

import pytest

from codegen.compiling.compiled import ROWS
from tests.codegen.digests import HASH_SEEDS, digests_started
from tests.codegen.scenes import SCENES


@pytest.mark.slow
def test_processes_with_other_hash_seeds_generate_the_same_bytes():
    results = [digests_started(seed) for seed in HASH_SEEDS]
    first, *others = (result() for result in results)
    more = ("pendulum", "top in other angles", "satellite by cosines", "unordered")
    systems = [*SCENES, *more]
    for name in systems:
        assert any(key.startswith(f"{name} jacobian") for key in first)
        for target in ROWS:
            assert any(key.startswith(f"{name} {target} ") for key in first)
    assert len(set(first.values())) > len(systems)
    assert all(other == first for other in others)
