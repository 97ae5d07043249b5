"""What structure saves: counts of the recursion with and without it."""

import pytest

from codegen.ir import scalars
from codegen.ir.program import Builder
from eom.multibody import Body, Joint, Placement, Tree
from eom.multibody.algebra.scalars import Numbers
from eom.multibody.recursion.lumped_tree import lumped_tree
from eom.multibody.recursion.operation_count import savings
from eom.multibody.recursion.recursions import forward_dynamics
from tests.eom.multibody.trees import tree


def plane(count):
    bodies = [Body(f"b{k}", 2, (0, 0, -1), (3, 5, 4)) for k in range(count)]
    joints = [
        Joint(f"j{k}", "revolute", f"b{k - 1}" if k else "ground", f"b{k}", "y",
              on_parent=Placement((0, 0, -2 * min(k, 1))))
        for k in range(count)
    ]  # fmt: skip
    return Tree("plane", bodies, joints, gravity=(0, 0, -9))


def test_a_plane_chain_skips_most():
    found = savings(plane(5))
    assert found.done * 4 < found.without
    assert found.skipped == found.without - found.done


@pytest.mark.parametrize("seed", range(4))
def test_nothing_is_counted_that_is_not_done(seed):
    """Programs share equal values and leave out what no result needs: they are shorter."""
    given = tree(seed, 4, loads=False)
    b = Builder()
    lumped = lumped_tree(given, lambda x: x, Numbers(scalars.sin, scalars.cos))
    x = scalars.scalars(b, "state", lumped.coordinates + lumped.speeds)
    tau = scalars.scalars(b, "input", lumped.speeds)
    q, u = x[: lumped.coordinates], x[lumped.coordinates :]
    made = scalars.program(
        b, {"f": forward_dynamics(lumped, q, u, tau, Numbers(scalars.sin, scalars.cos))}
    )
    counts = made.counts()
    operations = sum(counts.values()) - counts.get("neg", 0)
    assert 0.7 * savings(given).done <= operations <= 1.1 * savings(given).done


def test_reasons_name_the_parts():
    bodies = [Body("hub", 2, (1, 0, 0), (3, 4, 5)), Body("wheel", 1, (0, 0, 0), (1, 1, 2)),
              Body("box", 1), Body("cross")]  # fmt: skip
    joints = [
        Joint("a", "revolute", "ground", "cross", "x"),
        Joint("b", "revolute", "cross", "hub", "y"),
        Joint("spin", "revolute", "hub", "wheel", "z"),
        Joint("bolt", "fixed", "hub", "box"),
    ]
    text = str(savings(Tree("t", bodies, joints)))
    for part in ("bolt", "wheel", "cross"):
        assert part in text
