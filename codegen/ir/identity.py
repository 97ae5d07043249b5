"""Values as keys of caches by what they are, not by what they hold."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class SameObject(Generic[T]):
    """A value as a key by identity, kept alive while it is in a cache."""

    value: T

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SameObject) and other.value is self.value

    def __hash__(self) -> int:
        return id(self.value)
