"""Derivations that users keep: notes that are judged true, programs in Python."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from eom.errors import InputError

if TYPE_CHECKING:
    from eom.derivations.derived import Derived

PROGRAM = ".py"


def is_kept(name: str) -> bool:
    """Return whether a name is that of a note or of a program rather than of a scene or derivation."""
    from eom.checker.read.documents import KINDS

    return Path(name).suffix.lower() in {PROGRAM, *KINDS}


def kept(name: str, run: bool) -> list[Derived]:
    """Return the derivations of a note or of a program; ``run``: whether programs may be run.

    Raises `InputError` where there are none, and for a program that is not to be run.
    """
    from eom.checker.note.kept import from_note

    if not Path(name).is_file():
        raise InputError("no such file", where=name)
    if Path(name).suffix.lower() != PROGRAM:
        return [from_note(Path(name))]
    if not run:
        raise InputError(
            "this is a program, which would be run, with all that it does",
            where=name,
            hint="look into it first; then add --run",
        )
    return _of_program(name)


def _of_program(name: str) -> list[Derived]:
    """Run a program as Python does and return the derivations that its variables are."""
    import runpy

    from eom.derivations.derivation import Derivation
    from eom.derivations.derived import Derived

    try:
        made: dict[str, Any] = runpy.run_path(name, run_name="__main__")
    except InputError:
        raise
    except Exception as error:
        got = f"{type(error).__name__}: {error}"
        raise InputError("this program ends with an error", where=name, got=got) from error
    found = {id(v): v for v in made.values() if isinstance(v, Derivation | Derived)}.values()
    done = [v.finish() if isinstance(v, Derivation) else v for v in found]
    if not done:
        raise InputError(
            "no derivation in this program",
            where=name,
            expected="a variable that is an eom.Derivation, or what its finish() returns",
        )
    return done
