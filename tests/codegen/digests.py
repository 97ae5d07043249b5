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

    from codegen.compiled import TARGETS, generate
    from codegen.derivative import jacobian
    from codegen.elsewhere import as_system
    from codegen.lower import RATES
    from codegen.pipeline import specialised
    from eom import catalogue
    from eom.scene import Scene

    systems = {name: Scene.ready(name).derive() for name in catalogue.names()}
    systems["pendulum"] = as_system(n_link_pendulum_on_cart(LINKS))
    found = {}
    for name, system in systems.items():
        program, layout = specialised(system, {})
        for target in sorted(set(TARGETS) - {"auto"}):
            for file, text in generate(program, layout, target).items():
                found[f"{name} {target} {file}"] = _digest(text)
        found[f"{name} jacobian"] = _digest(str(jacobian(program, RATES).program))
    return found


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
