"""The quantities of mechanics by name: kind, meaning in words, definition in terms of others.

Labels say whose quantity it is and about which point: ``angular_momentum("body", "O")``. Whose:
``system`` (particles, sums), ``body`` (a continuum, integrals), or one particle. Points: ``O`` is the
reference point, ``C`` the centre of mass, ``OI`` the origin of the inertial frame; ``open`` is a body whose
mass changes. Primitive quantities have no definition; a world gives them values (`eom.worlds.evaluate`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from eom.errors import InputError, unknown_name
from eom.terms.terms import (
    DYADIC,
    MATRIX,
    SCALAR,
    VECTOR,
    Term,
    add,
    atom,
    cross,
    der,
    dot,
    integral,
    mul,
    number,
    outer,
    total,
)

ORIGIN = "OI"
CENTRE = "C"


@dataclass(frozen=True)
class Quantity:
    """A row: kind, words with one place for each label, and what defines it, from its labels."""

    kind: str
    words: str
    definition: Callable[..., Term] | None = None


def quantity(name: str, *labels: str) -> Term:
    """Return a quantity by its ``name`` in `QUANTITIES` as a term.

    Parameters
    ----------
    name : str
        One of `QUANTITIES`.
    labels : str
        Whose it is, and about which point or in which frames, in the order of its words.

    Returns
    -------
    Term
        In SI units. It is an atom: what it is made of is the definition that a derivation states.

    Raises
    ------
    InputError
        For other names, and for a wrong number of labels.

    Examples
    --------
    >>> words(quantity("angular_momentum", "body", "C"))
    'angular momentum of the body about the centre of mass'
    """
    if name not in QUANTITIES:
        raise unknown_name("quantity", name, QUANTITIES)
    wanted = QUANTITIES[name].words.count("{")
    if len(labels) != wanted:
        raise InputError(
            f"wrong number of labels of {name}",
            got=labels,
            expected=f"{wanted}: {QUANTITIES[name].words}",
        )
    return atom(name, *labels, kind=QUANTITIES[name].kind)


def definition(term: Term) -> Term | None:
    """Return what defines an atom, or None for a primitive quantity. Raises `InputError` for others."""
    if term.data[0] not in QUANTITIES:
        raise InputError("no world has this quantity", got=" ".join(map(str, term.data)))
    row = QUANTITIES[term.data[0]]
    return row.definition(*term.data[1:]) if row.definition else None


def words(term: Term) -> str:
    """Return the meaning of an atom in words."""
    name, *labels = term.data
    said = QUANTITIES[name].words
    labels = [label_words(n) if name in _OF_BODIES else _LABEL_WORDS.get(n, n) for n in labels]
    if "about {1}" in said and labels[0] == labels[1]:
        labels[1] = "its centre of mass"
    return said.format(*labels)


_OF_BODIES = frozenset(
    "mass position linear_momentum angular_momentum absolute_angular_momentum kinetic_energy "
    "rotational_energy external_force torque".split()
)


def label_words(label: str) -> str:
    """Return what a point or body is in words: one that has a name has an article."""
    named = label.isalpha() and label.islower() and len(label) > 2
    return _LABEL_WORDS.get(label, f"the {label}" if named else label)


_HEAD_WORDS = {
    "der": "a derivative",
    "integral": "an integral over the body",
    "sum": "a sum over particles",
    "column": "a column of components",
    "cross": "a vector product",
    "dot": "a product of vectors",
    "since": "an integral over time",
    "start": "a value at the beginning",
    "partial": "a partial derivative",
}
"""Terms that are no quantities by themselves."""


def described(term: Term) -> str:
    """Return what a term is in words: a quantity, or how it is made."""
    kinds = {VECTOR: "a vector", MATRIX: "a matrix", DYADIC: "a dyadic"}
    made = _HEAD_WORDS.get(term.head) or kinds.get(term.kind, f"a {term.kind}")
    return words(term) if term.head == "atom" and term.data[0] in QUANTITIES else made


_LABEL_WORDS = {
    "body": "the body",
    "system": "the system",
    "P": "the point mass",
    "open": "the open body",
    "C": "the centre of mass",
    "OI": "the inertial origin",
    "dm": "a mass element",
    "OA": "O_A",
    "OB": "O_B",
}


def position(of: str, origin: str = ORIGIN) -> Term:
    """Return the position vector of the point ``of`` from ``origin``, the inertial one by default.

    Parameters
    ----------
    of : str
        A point, such as ``C`` for the centre of mass.
    origin : str, default "OI"
        A point, too; ``OI`` is the origin of the inertial frame.

    Returns
    -------
    Term
        In metres, from ``origin`` to the point; the origin is the inertial one by default.

    Examples
    --------
    >>> words(position("C"))
    'position of the centre of mass from the inertial origin'
    """
    return quantity("position", of, origin)


def velocity(of: str) -> Term:
    """Return the absolute velocity of a point ``of``: the inertial derivative of its position.

    Parameters
    ----------
    of : str
        A point, such as ``C`` for the centre of mass.

    Returns
    -------
    Term
        In m/s, the inertial derivative of its position from the inertial origin.

    Examples
    --------
    >>> velocity("C").args[0] == position("C")
    True
    """
    return der(position(of))


def mass(of: str) -> Term:
    """Return the mass of one particle."""
    return quantity("mass", of)


def omega(frame: str = "B", base: str = "I") -> Term:
    """Return the angular velocity of ``frame`` with respect to ``base``, right-handed.

    Parameters
    ----------
    frame : str, default "B"
        Which turns.
    base : str, default "I"
        Against which it turns.

    Returns
    -------
    Term
        In rad/s: that of ``frame`` with respect to ``base``, right-handed.

    Examples
    --------
    >>> words(omega())
    'angular velocity of frame B with respect to I'
    """
    return quantity("angular_velocity", frame, base)


def unit(frame: str, axis: int) -> Term:
    """Return the unit vector along the axis number ``axis`` (1, 2, 3) of ``frame``.

    Parameters
    ----------
    frame : str
        Whose axis it is.
    axis : int
        1, 2 or 3.

    Returns
    -------
    Term
        Along the axis number ``axis`` (1, 2, 3) of ``frame``, without a unit.

    Examples
    --------
    >>> words(unit("I", 3))
    'unit vector along axis 3 of frame I'
    """
    return quantity("unit", frame, str(axis))


def over_mass(who: str, term: Callable[[str], Term]) -> Term:
    """Return the mass-weighted sum over ``who``: of a system, a body, or one particle."""
    if who == "body":
        return integral(term("dm"))
    if who == "system":
        return total(mul(mass("i"), term("i")))
    return mul(mass(who), term(who))


def over_parts(who: str, term: Callable[[str], Term]) -> Term:
    """Return the plain sum over the parts of ``who``."""
    if who == "body":
        return total(term("dm"), "dm", "elements")
    return total(term("i")) if who == "system" else term(who)


def _applied(who: str) -> Term:
    """Return the forces on a particle, external and internal, less that of the constraints."""
    inner = total(quantity("internal_force", who, "n"), "n")
    return add(quantity("force", who), inner, -quantity("constraint_force", who))


def _relative_momentum(who: str, about: str) -> Term:
    return over_mass(who, lambda i: cross(position(i, about), der(position(i, about))))


def _absolute_momentum(who: str, about: str) -> Term:
    if who == "body":
        return integral(cross(position("dm", about), velocity("dm")))
    return over_parts(who, lambda i: cross(position(i, about), quantity("linear_momentum", i)))


def _inertia(about: str) -> Term:
    rho = position("dm", about)
    return integral(add(dot(rho, rho) * quantity("identity"), -outer(rho, rho)))


QUANTITIES: dict[str, Quantity] = {
    "mass": Quantity(SCALAR, "mass of {0}"),
    "position": Quantity(VECTOR, "position of {0} from {1}"),
    "force": Quantity(VECTOR, "external force on {0}"),
    "internal_force": Quantity(VECTOR, "force on {0} exerted by {1}"),
    "constraint_force": Quantity(VECTOR, "force of the constraints on {0}"),
    "applied_force": Quantity(VECTOR, "force on {0} besides that of the constraints", _applied),
    "angular_velocity": Quantity(VECTOR, "angular velocity of frame {0} with respect to {1}"),
    "unit": Quantity(VECTOR, "unit vector along axis {1} of frame {0}"),
    "identity": Quantity(DYADIC, "unit dyadic"),
    "identity_matrix": Quantity(MATRIX, "unit matrix"),
    "rotation": Quantity(MATRIX, "rotation matrix from components in {1} to components in {0}"),
    "eigenvectors": Quantity(
        MATRIX, "columns along the axes of {1} in any order, of any length, by components in {0}"
    ),
    "angle": Quantity(SCALAR, "angle {0}"),
    "turn_angle": Quantity(
        SCALAR, "angle {0} of the turns about axes {1} by which frame {2} is reached from {3}"
    ),
    "free_angle": Quantity(SCALAR, "any angle {0}"),
    "principal_angle": Quantity(
        SCALAR, "angle of the rotation from frame {1} to {0} about one axis"
    ),
    "principal_axis": Quantity(
        VECTOR, "unit vector along the axis of the rotation from frame {1} to {0}"
    ),
    "euler_parameter": Quantity(
        SCALAR, "Euler parameter {0} of the rotation from frame {2} to {1}; number 0 is the scalar"
    ),
    "euler_vector": Quantity(
        VECTOR, "vector part of the Euler parameters of the rotation from frame {1} to {0}"
    ),
    "rodrigues": Quantity(
        VECTOR, "Rodrigues parameters (Gibbs vector) of the rotation from frame {1} to {0}"
    ),
    "modified_rodrigues": Quantity(
        VECTOR, "modified Rodrigues parameters of the rotation from frame {1} to {0}"
    ),
    "shadow_rodrigues": Quantity(
        VECTOR, "shadow set of the modified Rodrigues parameters of the rotation from {1} to {0}"
    ),
    "gravity_parameter": Quantity(SCALAR, "gravitational parameter of the attracting centre"),
    "orbit_radius": Quantity(SCALAR, "distance from the attracting centre to the centre of mass"),
    "orbit_direction": Quantity(
        VECTOR, "unit vector from the attracting centre to the centre of mass"
    ),
    "orbit_position": Quantity(
        VECTOR,
        "position of the centre of mass from the attracting centre",
        lambda: mul(quantity("orbit_radius"), quantity("orbit_direction")),
    ),
    "gravity_torque": Quantity(
        VECTOR, "torque of gravity about the centre of mass, to second order in the body's size"
    ),
    "gravity_energy": Quantity(
        SCALAR, "potential energy of gravity, to second order in the body's size"
    ),
    "exhaust_velocity": Quantity(
        VECTOR, "velocity, relative to {0}, of the mass that it takes in or loses"
    ),
    "gravity": Quantity(VECTOR, "acceleration of uniform gravity"),
    "scalar": Quantity(SCALAR, "any number {0}"),
    "coordinate": Quantity(SCALAR, "any coordinate {0}, which changes with time"),
    "function": Quantity(SCALAR, "any function {0} of coordinates"),
    "vector": Quantity(VECTOR, "any vector {0}"),
    "fixed_vector": Quantity(VECTOR, "any vector {0} that is fixed in frame {1}"),
    "dyadic": Quantity(DYADIC, "any dyadic {0}"),
    "rotor_axis": Quantity(VECTOR, "unit vector along the axis of rotor {0}"),
    "rotor_speed": Quantity(SCALAR, "rate of rotor {0} about its axis, relative to the body"),
    "rotor_momentum": Quantity(
        VECTOR, "angular momentum of rotor {0} about its own centre of mass"
    ),
    "slug_momentum": Quantity(VECTOR, "angular momentum of the slug about its centre"),
    "slug_inertia": Quantity(SCALAR, "moment of inertia of the spherical slug"),
    "slug_damping": Quantity(SCALAR, "viscous torque on the slug for each unit of relative rate"),
    "rotor_inertia": Quantity(SCALAR, "moment of inertia of rotor {0} about its axis"),
    "rotor_torque": Quantity(
        SCALAR,
        "torque on rotor {0} about its axis, exerted by the body",
        lambda k: dot(quantity("rotor_axis", k), der(quantity("rotor_momentum", k))),
    ),
    "total_mass": Quantity(
        SCALAR,
        "mass of {0}",
        lambda who: integral(number(1)) if who == "body" else total(mass("i")),
    ),
    "linear_momentum": Quantity(VECTOR, "linear momentum of {0}", lambda w: over_mass(w, velocity)),
    "external_force": Quantity(
        VECTOR,
        "external force on {0}",
        lambda w: over_parts(w, lambda i: quantity("force", i)),
    ),
    "first_moment": Quantity(
        VECTOR,
        "first moment of mass of {0} about {1}",
        lambda w, o: over_mass(w, lambda i: position(i, o)),
    ),
    "absolute_angular_momentum": Quantity(
        VECTOR, "absolute angular momentum of {0} about {1}", _absolute_momentum
    ),
    "angular_momentum": Quantity(VECTOR, "angular momentum of {0} about {1}", _relative_momentum),
    "torque": Quantity(
        VECTOR,
        "external torque on {0} about {1}",
        lambda w, o: over_parts(w, lambda i: cross(position(i, o), quantity("force", i))),
    ),
    "weight": Quantity(
        VECTOR, "weight of {0}", lambda w: over_mass(w, lambda _: quantity("gravity"))
    ),
    "weight_torque": Quantity(
        VECTOR,
        "torque of the weight of {0} about {1}",
        lambda w, o: over_mass(w, lambda i: cross(position(i, o), quantity("gravity"))),
    ),
    "weight_energy": Quantity(
        SCALAR,
        "potential energy of the weight of {0}, zero at {1}",
        lambda w, o: -over_mass(w, lambda i: dot(quantity("gravity"), position(i, o))),
    ),
    "reaction": Quantity(
        VECTOR,
        "force on {0} besides its weight",
        lambda w: add(quantity("external_force", w), -quantity("weight", w)),
    ),
    "reaction_torque": Quantity(
        VECTOR,
        "torque on {0} about {1} besides that of its weight",
        lambda w, o: add(quantity("torque", w, o), -quantity("weight_torque", w, o)),
    ),
    "kinetic_energy": Quantity(
        SCALAR,
        "kinetic energy of {0}",
        lambda w: over_mass(w, lambda i: number(1, 2) * dot(velocity(i), velocity(i))),
    ),
    "rotational_energy": Quantity(
        SCALAR,
        "kinetic energy of {0} relative to {1}",
        lambda w, o: over_mass(
            w, lambda i: number(1, 2) * dot(der(position(i, o)), der(position(i, o)))
        ),
    ),
    "inertia": Quantity(DYADIC, "second moment of mass (inertia dyadic) about {0}", _inertia),
}
"""Every quantity; the order is that of the lectures."""
