"""The scenes that ship with the package."""

from __future__ import annotations

import subprocess
import sys

import pytest

from eom.errors import InputError
from eom.scenes import catalogue


def test_every_ready_scene_has_a_file_and_a_title():
    names = catalogue.names()
    assert names == sorted(names)
    assert len(names) >= 4
    assert set(catalogue.titles()) == set(names)
    assert all(title.strip() for title in catalogue.titles().values())
    assert all(catalogue.path_of(n).is_file() for n in names)


def test_titles_are_read_without_sympy():
    code = "import sys; from eom.scenes import catalogue; catalogue.titles(); print('sympy' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "False"


@pytest.mark.parametrize("name", ["heavy-tops", "", "../scenes/heavy-top", "heavy-top.toml", "a\0"])
def test_other_names_are_refused(name):
    with pytest.raises(InputError, match="unknown scene") as caught:
        catalogue.path_of(name)
    assert "heavy-top" in caught.value.hint
