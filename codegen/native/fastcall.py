"""Quick calls of compiled functions from Python: a small extension, compiled once a machine.

It needs the headers of Python beside the C compiler; without them calls go through `ctypes`, are
slower by some microseconds and give the same results.
"""

from __future__ import annotations

import importlib.machinery
import importlib.util
from collections.abc import Callable
from functools import cache, partial
from importlib import resources
from typing import Any

import numpy as np

from codegen.native import native


@cache
def _extension() -> Any | None:
    headers = native.python_headers()
    if headers is None:
        return None
    source = resources.files("codegen.native").joinpath("fastcall.c").read_text(encoding="ascii")
    try:
        library = native.compile_library(source, (f"-I{headers}",))
        loader = importlib.machinery.ExtensionFileLoader("eom_fastcall", str(library))
        spec = importlib.util.spec_from_loader("eom_fastcall", loader)
        assert spec is not None
        module = importlib.util.module_from_spec(spec)
        loader.exec_module(module)
    except (native.CompilerError, ImportError):
        return None
    return module


def bind(
    addresses: tuple[int, int],
    lengths: tuple[int, int, int, int],
    constants: int,
    fallback: Callable[..., Any],
) -> Callable[..., Any]:
    """Return a quick function for the C function and its preparation at ``addresses``.

    ``lengths``: numbers of states, parameters, inputs and results. ``constants``: doubles that the
    preparation fills. ``fallback`` serves every call
    that is not (float, contiguous arrays of doubles of these lengths); it must keep the code loaded.
    """
    extension = _extension()
    if extension is None:
        return fallback
    function: Callable[..., Any] = extension.bind(
        *addresses, lengths, constants, fallback, partial(np.empty, lengths[3])
    )
    return function
