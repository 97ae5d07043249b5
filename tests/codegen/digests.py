"""Digests of everything that is generated, for comparing processes: ``python -m tests.codegen.digests``."""

import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

HASH_SEEDS = (0, 1, 12345)
LINKS = 3


def digests():
    """A digest of each generated file by system, target and name."""
    from sympy.physics.mechanics.models import n_link_pendulum_on_cart

    from codegen.compiling.compiled import ROWS, generate
    from codegen.derivatives.derivative import jacobian
    from codegen.frontend.from_sympy_mechanics import as_system
    from codegen.ir.program import RATES
    from codegen.passes.pipeline import specialised
    from eom import gravity_gradient_satellite, heavy_top
    from eom.opening import load_scene
    from tests.codegen.scenes import SCENES

    systems = {name: load_scene(name).derive() for name in SCENES}
    systems["pendulum"] = as_system(n_link_pendulum_on_cart(LINKS))
    systems["top in other angles"] = heavy_top("3-1-2")
    systems["satellite by cosines"] = gravity_gradient_satellite("dcm")
    systems["unordered"] = _unordered()
    found = {}
    for name, system in systems.items():
        program, layout = specialised(system, {})
        for target in ROWS:
            for file, text in generate(program, layout, target).items():
                found[f"{name} {target} {file}"] = _digest(text)
        found[f"{name} jacobian"] = _digest(str(jacobian(program, RATES).program))
    return found


def _unordered():
    """A system of operations whose operands SymPy keeps in no order of its own."""
    import sympy as sp

    from eom.system import System

    x, y, a = sp.symbols("x y a", real=True)
    choice = sp.Piecewise((1, (x > 0) & (y > 1) & (a < x)), (2, True))
    greatest = sp.Max(sp.sin(x), sp.cos(y), sp.exp(a)) + sum(sp.sin(k * x + y) for k in range(9))
    return System.from_rates("unordered", {x: sp.Min(x, y, a, x * y, 3) + choice, y: greatest})


def _digest(text):
    return hashlib.sha256(text.encode()).hexdigest()


def digests_apart(hash_seed):
    """The digests that a process with another hash seed finds."""
    return digests_started(hash_seed)()


def digests_started(hash_seed):
    """Start such a process; a function that waits for its digests."""
    run = subprocess.Popen(
        [sys.executable, "-m", "tests.codegen.digests"],
        env={**os.environ, "PYTHONHASHSEED": str(hash_seed)},
        cwd=Path(__file__).parents[2],
        stdout=subprocess.PIPE,
        text=True,
    )

    def result():
        out, _ = run.communicate(timeout=300)
        assert run.returncode == 0
        return json.loads(out)

    return result


if __name__ == "__main__":
    print(json.dumps(digests()))
