"""Live pages for tests: each made once, and its own scripts run in Node.js."""

import json
import re
import subprocess
import tempfile
from dataclasses import replace
from functools import lru_cache
from html.parser import HTMLParser
from pathlib import Path

import eom
from eom.views.live.page import written
from eom.views.live.scenes import subject_of
from tests import node

SUPPORTED = (
    "lecture-wheel", "gravity-gradient-satellite", "heavy-top", "t-handle", "t-handle-in-angles",
    "double-pendulum", "floating-tree", "pendulum-on-cart", "satellite-with-panels", "seven-joint-arm",
    "bicycle-wheel", "rotary-pendulum", "reaction-wheels", "dual-spin-satellite",
    "control-moment-gyroscope", "gyroscope-in-gimbals", "quadrotor", "rocket", "walking-leg",
    "foucault-pendulum", "four-bar-linkage", "slider-crank", "rolling-disc", "rolling-ellipsoid",
    "whipple-bicycle",
)  # fmt: skip
SINGLE = SUPPORTED[:5]
BOUND = SUPPORTED[-5:]
"""Scenes with constraints."""
WHOLE = (*SINGLE, "double-pendulum", "satellite-with-panels")
"""Pages that are made whole; of other trees the scene's own choice alone, which is made sooner."""


@lru_cache(maxsize=16)
def text_of(name):
    about = subject(name)
    if name not in WHOLE:
        about = replace(about, switches=(), variants={(): about.variants[about.choice]})
    return written(about)


@lru_cache(maxsize=16)
def subject(name):
    return subject_of(eom.load_scene(name))


class Elements(HTMLParser):
    """The elements of a page, each with its attributes and its text."""

    def __init__(self, text):
        super().__init__()
        self.found, self.inside = [], False
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.found.append([tag, dict(attrs), ""])
        self.inside = True

    def handle_endtag(self, tag):
        self.inside = False

    def handle_data(self, data):
        if self.inside:
            self.found[-1][2] += data

    def all(self, tag):
        return [(attributes, text) for name, attributes, text in self.found if name == tag]


def data_of(text):
    (found,) = re.findall(
        r'<script type="application/json" id="scene">(.*?)</script>', text, re.DOTALL
    )
    return json.loads(found)


def core_of(text):
    """The script that needs no document: right-hand sides, integrator, motion."""
    (core,) = [
        s for s in re.findall(r"<script>(.*?)</script>", text, re.DOTALL) if "EOM_SYSTEMS = [" in s
    ]
    return core


def run(text, program):
    """Run ``program``, which sees ``motion`` and ``data``, and calls ``give`` with its result."""
    lines = [
        core_of(text),
        f"const data = {json.dumps(data_of(text))};",
        "const motion = createMotion(data, EOM_SYSTEMS, EOM_METHOD);",
        "const give = (x) => console.log(JSON.stringify(x));",
        program,
    ]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "page.js"
        file.write_text("\n".join(lines), encoding="utf-8")
        done = subprocess.run(
            [node.NODE, str(file)], check=False, capture_output=True, text=True, encoding="utf-8"
        )
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout)
