"""An arm of many links, and its forward dynamics by the product's recursion over scalars of any kind."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any

from eom.multibody import GROUND, Body, Joint, Placement, Tree
from eom.multibody.algebra.scalars import Numbers
from eom.multibody.recursion.lumped_tree import lumped_tree
from eom.multibody.recursion.recursions import forward_dynamics

Scalar = Any
Function = Callable[[Scalar], Scalar]

GRAVITY = 9.81
TURNS = (((1, 0, 0), (0, 0, 1), (0, -1, 0)), ((1, 0, 0), (0, 0, -1), (0, 1, 0)))


@lru_cache
def chain(count: int) -> Tree:
    """Return an arm of ``count`` links whose joint axes are at right angles to their neighbours'.

    All other numbers are of no special value, so that nothing of them is folded away. A motor turns
    each joint.
    """
    return Tree(
        "chain",
        tuple(_link(k) for k in range(count)),
        tuple(
            Joint(f"joint{k}", "revolute", f"link{k - 1}" if k else GROUND, f"link{k}",
                  on_parent=_seat(k), motor=True)
            for k in range(count)
        ),
        gravity=(0, 0, -GRAVITY),
    )  # fmt: skip


def _link(k: int) -> Body:
    a, b = _numbers(k)
    inertia = ((0.5 + a, 0.01 + b, 0.02), (0.01 + b, 0.6 - a, 0.03), (0.02, 0.03, 0.7 + b))
    return Body(f"link{k}", 1.5 + a - b, (0.04 - b, 0.03 + a, 0.15 + b), inertia)


def _seat(k: int) -> Placement:
    a, b = _numbers(k)
    return Placement((0.05 + a, -0.04 - b, 0.3 + a * b), TURNS[k % 2])


def _numbers(k: int) -> tuple[float, float]:
    return 0.03 * (k % 5), 0.02 * (k % 7)


def accelerations(
    tree: Tree,
    q: Sequence[Scalar],
    rates: Sequence[Scalar],
    torques: Sequence[Scalar],
    sin: Function,
    cos: Function,
) -> list[Scalar]:
    """Return the joint accelerations (rad/s^2) of angles, rates and torques; gravity is along -3."""
    work = Numbers(sin, cos)
    lumped = lumped_tree(tree, lambda x: x if x in (0, 1, -1) else float(x), work)
    return forward_dynamics(lumped, q, rates, torques, work)
