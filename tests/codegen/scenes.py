"""Ready scenes for tests that look at every instruction: those of one body, and the smallest tree."""

from eom.scenes import catalogue

SCENES = [*catalogue.single(), "double-pendulum"]
