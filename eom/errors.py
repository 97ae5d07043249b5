"""The one error that users see, and the near matches that it offers.

>>> print(InputError("unknown state", got="thta", expected="theta or psi", hint="theta?"))
unknown state
  got:      thta
  expected: theta or psi
  hint:     theta?
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class InputError(ValueError):
    """Say what is wrong with an input, where, what was got and expected, and what to do.

    The parts are kept as attributes (``what``, ``where``, ``got``, ``expected``, ``hint``), each a text; an
    empty part is left out of the message. A `ValueError`, so that it can be caught as one.

    >>> try:
    ...     raise InputError("unknown state", got="thta", hint="did you mean theta?")
    ... except ValueError as error:
    ...     print(error)
    unknown state
      got:      thta
      hint:     did you mean theta?
    """

    def __init__(
        self,
        what: str,
        *,
        where: str = "",
        got: object = "",
        expected: object = "",
        hint: str = "",
    ) -> None:
        self.what = what
        self.where = where
        self.got = str(got)
        self.expected = str(expected)
        self.hint = hint
        parts = [("where", where), ("got", self.got), ("expected", self.expected), ("hint", hint)]
        super().__init__("\n".join([what, *(f"  {k + ':':<9} {v}" for k, v in parts if v)]))

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle by parts, so that an error crosses process boundaries whole."""
        return (_rebuild, (type(self), self.what, self.where, self.got, self.expected, self.hint))


def _rebuild(
    kind: type[InputError], what: str, where: str, got: str, expected: str, hint: str
) -> InputError:
    return kind(what, where=where, got=got, expected=expected, hint=hint)


class AssumptionError(InputError):
    """Refuse values that contradict an assumption under which a system was derived.

    An `InputError` with the same parts: ``what`` names the assumption, ``got`` the values.
    """


def near_matches(name: str, known: Iterable[str]) -> str:
    """Return a hint that names the known spellings closest to ``name``, or all of a short list.

    >>> near_matches("omeg_1", ["omega_1", "omega_2", "psi"])
    'did you mean omega_1 or omega_2?'
    """
    names = sorted(known)
    folded = {n.casefold(): n for n in names}
    close = difflib.get_close_matches(name.casefold(), list(folded), n=3, cutoff=0.6)
    if close:
        return f"did you mean {' or '.join(folded[c] for c in close)}?"
    return f"known names: {', '.join(names)}" if 0 < len(names) <= 40 else ""


def unknown_name(kind: str, name: str, known: Iterable[str], where: str = "") -> InputError:
    """Build the error for a name that is not among the known ones."""
    return InputError(f"unknown {kind} {name!r}", where=where, hint=near_matches(name, known))
