"""What the user asked for on the command line."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Settings:
    """``quick``: ratios alone, in less than a minute. ``instructions``: count them too."""

    quick: bool = False
    instructions: bool = False
