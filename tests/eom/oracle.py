"""Whether an equation is true, by 60-digit numerics on smooth motions: no series, no exact field.

Every quantity is a table of values at `NODES` Chebyshev points of a short span of time; a derivative is
that of the polynomial through them. Frames turn by products of elementary rotations whose angles are
smooth functions, paths are sines, and motions that obey a condition on torques are solved for by Picard
iteration. `eom.terms.terms` gives the shape of an equation; nothing else of the checker is used.
"""

import random
from dataclasses import dataclass, field
from decimal import Decimal, DecimalException, localcontext
from functools import lru_cache
from itertools import product

import mpmath as mp
import numpy as np
import sympy as sp

from eom.terms.terms import INDICES, nodes

DIGITS, NODES = 60, 15
STEP = Decimal("0.001")
TRUE, FALSE = 1e-25, 1e-12
"""Below the one an equation is true, above the other it is false; nothing may lie between."""


class Undefined(ArithmeticError):
    """An equation has no value in real numbers, or none that these numerics can find."""


class Absent(Undefined):
    """What an equation is of is not there unless it is assumed to be."""


NEEDS = {
    "third_law_strong": ("third_law_weak",),
    "O_at_origin": ("O_fixed_in_space",),
    "body_frame": ("rigid",),
    "O_fixed_in_body": ("rigid",),
    "principal_axes": ("body_frame",),
    **dict.fromkeys(("symmetric", "symmetric_1", "symmetric_2"), ("principal_axes",)),
    "torque_free": ("body_frame", "newton_2", "third_law_strong"),
    "A_fixed_in_body": ("body_frame",),
    "thin_rod": ("body_frame",),
    "spin_312": ("rigid",),
    "no_torque_2": ("spin_312", "newton_2"),
    "no_torque_3": ("spin_312", "newton_2"),
    "viscous_slug": ("newton_2", "constant_mass"),
    "rotors": ("constant_mass",),
    "principal_at_O": ("O_fixed_in_body",),
}


def _exact(x):
    return Decimal(mp.nstr(x, DIGITS + 5))


def _by_mpmath(function):
    def at(x):
        with mp.workdps(DIGITS + 10):
            return _exact(function(mp.mpf(str(x))))

    return np.frompyfunc(at, 1, 1)


SIN, COS, TAN, LOG, EXP = (_by_mpmath(f) for f in (mp.sin, mp.cos, mp.tan, mp.log, mp.exp))
SQRT = np.frompyfunc(lambda x: x.sqrt(), 1, 1)


@lru_cache(maxsize=1)
def _calculus():
    """Times, and the matrices that differentiate and integrate (from the middle) values there."""
    with mp.workdps(3 * DIGITS):
        x = [mp.cos(mp.pi * (2 * k + 1) / (2 * NODES)) for k in range(NODES)]
        x[NODES // 2] = mp.mpf(0)
        powers = mp.matrix([[t**n for n in range(NODES)] for t in x])
        rates = mp.matrix([[n * t ** (n - 1) if n else 0 for n in range(NODES)] for t in x])
        areas = mp.matrix([[t ** (n + 1) / (n + 1) for n in range(NODES)] for t in x])
        inverse = powers**-1
        h = mp.mpf(str(STEP))

        def exact(m):
            return np.array([[_exact(m[i, j]) for j in range(NODES)] for i in range(NODES)])

        return (
            np.array([_exact(t * h) for t in x]),
            exact(rates * inverse / h).T,
            exact(areas * inverse * h).T,
        )


def times():
    """The times of the nodes, from the middle of the span."""
    return _calculus()[0]


def rate(values):
    return np.dot(values, _calculus()[1])


def integrate(start, rates):
    """Values from a start in the middle of the span and the rates at the nodes."""
    return start[..., None] + np.dot(rates, _calculus()[2])


def picard(start, rule):
    """Solve x' = rule(x)."""
    x = np.repeat(start[..., None], NODES, axis=-1)
    for _ in range(22):
        x = integrate(start, rule(x))
    return x


def cross(a, b):
    return np.array([a[k - 2] * b[k - 1] - a[k - 1] * b[k - 2] for k in range(3)])


def skew(a):
    nought = a[0] * 0
    return np.array([[nought, -a[2], a[1]], [a[2], nought, -a[0]], [-a[1], a[0], nought]])


def matrix_by_vector(m, v):
    return (m * v[None]).sum(axis=1)


def matrix_by_matrix(a, b):
    return (a[:, :, None] * b[None]).sum(axis=1)


def turned(m):
    return np.swapaxes(m, 0, 1)


def inverted(m):
    """The inverse by cofactors."""
    rows = [cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])]
    return turned(np.array(rows)) / (m[0] * rows[0]).sum(axis=0)


def still(point):
    """Numbers that do not change, at every node."""
    values = np.array(point, dtype=object)
    return np.repeat(values[..., None], NODES, axis=-1)


class Random:
    """Random numbers, and smooth functions of them."""

    def __init__(self, *seed):
        self.generator = random.Random(str(seed))

    def number(self, low=0.3, high=1.7):
        return Decimal(str(round(self.generator.uniform(low, high), 9)))

    def either(self):
        return self.number() * self.generator.choice((-1, 1))

    def point(self):
        return np.array([self.either() for _ in range(3)])

    def smooth(self):
        t = _calculus()[0]
        a, b, c, w, d = (self.either() for _ in range(5))
        return a + b * t + c * SIN(w * t + d)

    def path(self):
        return np.array([self.smooth() for _ in range(3)])

    def wide_angle(self):
        """An angle away from a right one."""
        t = _calculus()[0]
        return self.number(0.2, 0.9) + self.either() * t + self.number() * t * t


@dataclass(frozen=True)
class Frame:
    """The rotation from I, and the angular velocity in I (components in I)."""

    C: np.ndarray
    omega: np.ndarray


def elementary(axis, angle):
    """The passive rotation about one axis."""
    s, c = SIN(angle), COS(angle)
    nought, one = s * 0, s * 0 + 1
    rows = [
        [[one, nought, nought], [nought, c, s], [nought, -s, c]],
        [[c, nought, -s], [nought, one, nought], [s, nought, c]],
        [[c, s, nought], [-s, c, nought], [nought, nought, one]],
    ]
    return np.array(rows[axis])


def chained(turns, base=None):
    """The frames after each of some turns (axis, angle); angular velocities add along the axes."""
    C = (
        still([[Decimal(int(i == j)) for j in range(3)] for i in range(3)])
        if base is None
        else base.C
    )
    omega = C[0] * 0 if base is None else base.omega
    frames = []
    for axis, angle in turns:
        C = matrix_by_matrix(elementary(axis, angle), C)
        omega = omega + rate(angle) * C[axis]
        frames.append(Frame(C, omega))
    return frames


def any_frame(rnd):
    return chained([(axis, rnd.smooth()) for axis in (2, 0, 1)])[-1]


@dataclass
class Scene:
    """Masses, places and forces at the nodes, frames, points and angles."""

    seed: int
    masses: list
    places: list
    frames: dict
    points: dict
    angles: dict = field(default_factory=dict)
    rotors: list = field(default_factory=list)
    slug: tuple = ()
    forces: list = field(default_factory=list)
    internal: list = field(default_factory=list)
    memo: dict = field(default_factory=dict)
    open: dict = field(default_factory=dict)


# -- bodies ----------------------------------------------------------------------------------


def moment_matrix(masses, points):
    """The sum of m (r.r 1 - r r^T) of plain numbers."""
    J = np.array([[Decimal(0)] * 3 for _ in range(3)])
    for m, p in zip(masses, points, strict=True):
        for i, j in product(range(3), repeat=2):
            J[i, j] += m * ((p * p).sum() * int(i == j) - p[i] * p[j])
    return J


def centred(masses, points):
    middle = sum(m * p for m, p in zip(masses, points, strict=True)) / sum(masses)
    return [p - middle for p in points]


def to_principal_axes(masses, points):
    """The same cloud about its centre, along its principal axes, found by an eigensolver."""
    return along_principal_axes(masses, centred(masses, points))


def along_principal_axes(masses, points):
    """The same cloud along the principal axes at the origin."""
    with mp.workdps(DIGITS + 10):
        J = mp.matrix([[mp.mpf(str(e)) for e in row] for row in moment_matrix(masses, points)])
        _, axes = mp.eigsy(J)
        Q = np.array([[_exact(axes[i, j]) for j in range(3)] for i in range(3)])
    return [np.array([(Q[:, k] * p).sum() for k in range(3)]) for p in points]


EQUAL = {"spin_312": (0, 2), "symmetric": (0, 1), "symmetric_1": (1, 2), "symmetric_2": (2, 0)}
"""Axes about which the moments are equal."""
UNKNOWN = frozenset(
    "plane_body fixed_axis first_turn steady_turn one_rotor steady_rotors O_uniform".split()
)
"""Assumptions that these numerics draw no motion for."""


def body_points(rnd, assumed):
    """Masses and places in the body's frame, the centre of mass anywhere."""
    n = rnd.generator.randint(4, 6)
    masses, points = [rnd.number() for _ in range(n)], [rnd.point() for _ in range(n)]
    if "thin_rod" in assumed:
        a, b = rnd.point(), rnd.point()
        points = [a + rnd.either() * b for _ in points]
    if {"principal_axes", "spin_312"} & assumed:
        points = to_principal_axes(masses, points)
    for i, j in (pair for name, pair in EQUAL.items() if name in assumed):
        squares = [sum(m * p[k] ** 2 for m, p in zip(masses, points, strict=True)) for k in (i, j)]
        factor = (squares[1] / squares[0]).sqrt()
        points = [np.array([c * factor if k == i else c for k, c in enumerate(p)]) for p in points]
    shift = rnd.point()
    return masses, [p + shift for p in points]


def free_frame(rnd, J):
    """Torque-free attitude: C' = -skew(J^-1 C h) C for a constant h."""
    J_inverse = inverted(still(J))
    h = still(rnd.point())
    start = any_frame(rnd).C[:, :, 0]

    def turning(C):
        return matrix_by_vector(J_inverse, matrix_by_vector(C, h))

    C = picard(start, lambda C: -matrix_by_matrix(skew(turning(C)), C))
    return Frame(C, matrix_by_vector(turned(C), turning(C)))


def spin_frames(rnd, J, assumed):
    """Frames and angles of the 3-1-2 sequence, those without torque by their differential equations."""
    I1, I2 = J[0, 0], J[1, 1]
    theta = rnd.wide_angle()
    rate_theta, tangent, cosine = rate(theta), SIN(theta) / COS(theta), COS(theta)
    psi, phi = rnd.smooth(), rnd.smooth()
    spin = rnd.either()
    free_2, free_3 = "no_torque_2" in assumed, "no_torque_3" in assumed
    if free_3:
        rate_phi = rate(phi)

        def rates(x):
            u = x[1]
            whole = spin if free_2 else rate_phi + u * tangent
            return np.array([u / cosine, u * tangent * rate_theta - rate_theta * I2 / I1 * whole])

        psi = picard(np.array([rnd.either(), rnd.either()]), rates)[0]
    if free_2:
        phi = integrate(np.array(rnd.either()), spin - rate(psi) * SIN(theta))
    frames = dict(zip("ABC", chained([(2, psi), (0, theta), (1, phi)]), strict=True))
    return frames, {"psi": psi, "theta": theta, "phi": phi}


def weighted_mean(masses, places):
    return sum(m * p for m, p in zip(masses, places, strict=True)) / sum(masses)


# -- scenes ----------------------------------------------------------------------------------


def _particles(rnd, seed, assumed):
    n = 1 if "one_particle" in assumed else 3 + seed % 2
    steady = "constant_mass" in assumed
    masses = [still(rnd.number()) if steady else rnd.smooth() + 4 for _ in range(n)]
    places = [rnd.path() for _ in range(n)]
    return Scene(seed, masses, places, {n: any_frame(rnd) for n in "AB"}, {})


def _rigid(rnd, seed, assumed):
    masses, points = body_points(rnd, assumed)
    at_O = "principal_at_O" in assumed
    if at_O and "principal_axes" not in assumed:
        points = along_principal_axes(masses, points)
    J = moment_matrix(masses, centred(masses, points))
    frames, angles = {"A": any_frame(rnd), "B": any_frame(rnd)}, {}
    body = any_frame(rnd)
    if "torque_free" in assumed:
        body = free_frame(rnd, J)
    if "spin_312" in assumed:
        frames, angles = spin_frames(rnd, J, assumed)
        body = frames["C"]
    if "body_frame" in assumed:
        frames["B"] = body
    if "A_fixed_in_body" in assumed:
        frames["A"] = chained([(k, still(rnd.number())) for k in (0, 1, 2)], body)[-1]

    def carried(p):
        return matrix_by_vector(turned(body.C), still(p))

    path = rnd.path()
    fixed = {name: path + carried(rnd.point()) for name in ("O in body", "OA", "OB")}
    if at_O:  # the origin of the cloud, or on a principal axis through the centre of mass
        along = np.array([Decimal(0), Decimal(0), rnd.either()])
        middle = sum(m * p for m, p in zip(masses, points, strict=True)) / sum(masses)
        O = middle + along if "principal_axes" in assumed else along * 0
        fixed["O in body"] = path + carried(O)
    places = [path + carried(p) for p in points]
    return Scene(seed, [still(m) for m in masses], places, frames, fixed, angles)


def _with_rotors(rnd, seed, _):
    B = any_frame(rnd)
    masses = [rnd.number() for _ in range(4)]
    places = [still(rnd.point()) for _ in masses]
    rotors = []
    half, root = Decimal("0.5"), Decimal("0.75").sqrt()
    for _ in range(2 + seed % 2):
        angle = rnd.smooth()
        mount = chained([(k, still(rnd.number())) for k in (2, 0, 1)])[-1]
        turn = turned(matrix_by_matrix(elementary(2, angle), mount.C))
        middle = still(rnd.point())
        first, inertia = len(masses), Decimal(0)
        for _ in range(2):
            m, (x, y, z) = rnd.number(), rnd.point()
            inertia += 3 * m * (x * x + y * y)
            for c, s in ((1, 0), (-half, root), (-half, -root)):
                p = still(np.array([c * x - s * y, s * x + c * y, z]))
                masses.append(m)
                places.append(middle + matrix_by_vector(turn, p))
        members = range(first, len(masses))
        rotors.append((mount.C[2], still(inertia), rate(angle), members))
    path, back = rnd.path(), turned(B.C)
    rotors = [(matrix_by_vector(back, axis), *rest) for axis, *rest in rotors]
    places = [path + matrix_by_vector(back, p) for p in places]
    frames = {"A": any_frame(rnd), "B": B}
    return Scene(seed, [still(m) for m in masses], places, frames, {}, rotors=rotors)


def _with_slug(rnd, seed, assumed):
    masses, points = body_points(rnd, assumed)
    points = centred(masses, points)
    m, a, damping = rnd.number(), rnd.number(), rnd.number()
    corners = [a * np.array(c) for c in product((1, -1), repeat=3)]
    inertia = 16 * m * a * a
    J_inverse = inverted(still(moment_matrix(masses, points)))
    total, spin = still(rnd.point()), rnd.point()
    B, S = (any_frame(rnd).C[:, :, 0] for _ in range(2))

    def omegas(x):
        C, h = x[:3], x[6]
        w = matrix_by_vector(J_inverse, matrix_by_vector(C, total - h))
        return matrix_by_vector(turned(C), w), h / inertia

    def rates(x):
        w_body, w_slug = omegas(x)
        turning = [-matrix_by_matrix(C, skew(w)) for C, w in ((x[:3], w_body), (x[3:6], w_slug))]
        return np.concatenate([*turning, (-damping * (w_slug - w_body))[None]])

    x = picard(np.concatenate([B, S, spin[None]]), rates)
    w_body, w_slug = omegas(x)
    frames = {"A": any_frame(rnd), "B": Frame(x[:3], w_body), "S": Frame(x[3:6], w_slug)}
    path = rnd.path()
    places = [path + matrix_by_vector(turned(x[:3]), still(p)) for p in points]
    places += [path + matrix_by_vector(turned(x[3:6]), still(p)) for p in corners]
    members = range(len(masses), len(places))
    masses = [*masses, *[m] * 8]
    slug = (still(inertia), still(damping), members)
    return Scene(seed, [still(m) for m in masses], places, frames, {}, slug=slug)


def _points(rnd, scene, assumed):
    """Place O and C; move everything where one of them has to be at rest."""
    centre = weighted_mean(scene.masses, scene.places)
    reference = rnd.path()
    if "O_fixed_in_space" in assumed:
        reference = still(rnd.point()) * int("O_at_origin" not in assumed)
    inside = scene.points.pop("O in body", None)
    tied = centre if "about_centre" in assumed else inside if "O_fixed_in_body" in assumed else None
    held = tied if tied is not None and "O_fixed_in_space" in assumed else None
    shift = centre * 0
    if held is not None:
        shift = reference - held
    elif "C_at_rest" in assumed:
        shift = still(rnd.point()) - centre
    scene.places = [p + shift for p in scene.places]
    scene.points = {name: p + shift for name, p in scene.points.items()}
    scene.points |= {"C": centre + shift, "OI": shift * 0}
    scene.points["O"] = reference if tied is None else tied + shift
    scene.points["A"] = Random(scene.seed, "A").path()


def _forces(rnd, scene, assumed):
    n = len(scene.places)
    nought = scene.places[0] * 0
    scene.internal = [[nought] * n for _ in range(n)]
    for i, j in product(range(n), repeat=2):
        if i < j:
            force = rnd.path()
            if "third_law_strong" in assumed:
                force = rnd.smooth() * (scene.places[i] - scene.places[j])
            scene.internal[i][j] = force
            scene.internal[j][i] = -force if "third_law_weak" in assumed else rnd.path()
    scene.forces = [rnd.path() for _ in range(n)]
    if "newton_2" in assumed:
        scene.forces = [
            m * rate(rate(p)) - sum(row, nought)
            for m, p, row in zip(scene.masses, scene.places, scene.internal, strict=True)
        ]


def _open_body(rnd, scene, assumed):
    """A body apart from all others, whose mass changes; the force is what its motion needs."""
    mass, place = rnd.smooth() + 4, rnd.path()
    exhaust = rnd.path()
    if "exhaust_at_rest" in assumed:
        exhaust = -rate(place)
    if "exhaust_with_body" in assumed:
        exhaust = exhaust * 0
    force = mass * rate(rate(place)) - rate(mass) * exhaust
    scene.points["open"] = place
    scene.open = {
        "mass": mass,
        "exhaust": exhaust,
        "force": force if "newton_2" in assumed else rnd.path(),
    }


@lru_cache(maxsize=64)
def scene_of(assumed, seed, placing=None):
    """The scene of a seed; ``placing``: where each particle is, by number, if not anywhere."""
    chosen, waiting = set(), list(assumed)
    while waiting:
        name = waiting.pop()
        chosen.add(name)
        waiting.extend(NEEDS.get(name, ()))
    rnd = Random("oracle", seed, sorted(chosen))
    make = _particles
    for name, maker in (("rigid", _rigid), ("rotors", _with_rotors), ("viscous_slug", _with_slug)):
        make = maker if name in chosen else make
    scene = make(rnd, seed, chosen)
    eye = still([[Decimal(int(i == j)) for j in range(3)] for i in range(3)])
    scene.frames["I"] = Frame(eye, eye[0] * 0)
    scene.frames.setdefault("S", any_frame(Random("oracle", "S", seed)))
    if placing is not None:
        scene.places = [placing(n) for n in range(len(scene.masses))]
    _open_body(Random("oracle", "open", seed), scene, chosen)
    _points(rnd, scene, chosen)
    _forces(rnd, scene, chosen)
    return scene


# -- quantities ------------------------------------------------------------------------------


def _members(s, who):
    return range(len(s.masses)) if who in {"body", "system"} else [who]


def _place(s, label):
    return s.places[label] if isinstance(label, int) else s.points[label]


def _over(s, who, rule):
    return sum((rule(n) for n in _members(s, who)), Decimal(0))


def _rotation(s, to, start):
    return matrix_by_matrix(s.frames[to].C, turned(s.frames[start].C))


def _identity(s):
    return s.frames["I"].C


def _inertia(s, about):
    o = _place(s, about)

    def one(n):
        r = s.places[n] - o
        return s.masses[n] * ((r * r).sum(axis=0) * _identity(s) - r[:, None] * r[None])

    return _over(s, "body", one)


def _spin(s, members):
    masses, places = [s.masses[n] for n in members], [s.places[n] for n in members]
    middle = weighted_mean(masses, places)
    arms = [p - middle for p in places]
    return sum(m * cross(r, rate(r)) for m, r in zip(masses, arms, strict=True))


def _gravity(s):
    return still(Random(s.seed, "gravity").point())


def _fixed(s, name, frame):
    return matrix_by_vector(turned(s.frames[frame].C), still(Random(s.seed, "fixed", name).point()))


def _energy(s, who, about):
    def one(n):
        v = rate(s.places[n] - about)
        return s.masses[n] * (v * v).sum(axis=0) / 2

    return _over(s, who, one)


def _slug(scene):
    if not scene.slug:
        raise Absent("there is no slug in this scene")
    return scene.slug


ATOMS = {
    "mass": lambda s, i: s.open["mass"] if i == "open" else s.masses[i],
    "exhaust_velocity": lambda s, _: s.open["exhaust"],
    "position": lambda s, a, b: _place(s, a) - _place(s, b),
    "force": lambda s, i: s.open["force"] if i == "open" else s.forces[i],
    "internal_force": lambda s, i, j: s.internal[i][j],
    "angular_velocity": lambda s, f, g: s.frames[f].omega - s.frames[g].omega,
    "unit": lambda s, f, k: s.frames[f].C[int(k) - 1],
    "identity": _identity,
    "identity_matrix": _identity,
    "rotation": _rotation,
    "angle": lambda s, name: s.angles[name],
    "scalar": lambda s, name: still(Random(s.seed, "scalar", name).either()),
    "vector": lambda s, name: Random(s.seed, "vector", name).path(),
    "fixed_vector": _fixed,
    "dyadic": lambda s, name: np.array([Random(s.seed, name, k).path() for k in range(3)]),
    "rotor_axis": lambda s, k: s.rotors[k][0],
    "rotor_inertia": lambda s, k: s.rotors[k][1],
    "rotor_speed": lambda s, k: s.rotors[k][2],
    "rotor_momentum": lambda s, k: _spin(s, s.rotors[k][3]),
    "rotor_torque": lambda s, k: (s.rotors[k][0] * rate(_spin(s, s.rotors[k][3]))).sum(axis=0),
    "slug_inertia": lambda s: _slug(s)[0],
    "slug_damping": lambda s: _slug(s)[1],
    "slug_momentum": lambda s: _spin(s, _slug(s)[2]),
    "total_mass": lambda s, who: sum(s.masses),
    "linear_momentum": lambda s, who: _over(s, who, lambda n: s.masses[n] * rate(s.places[n])),
    "external_force": lambda s, who: _over(s, who, lambda n: s.forces[n]),
    "first_moment": lambda s, who, o: _over(
        s, who, lambda n: s.masses[n] * (s.places[n] - _place(s, o))
    ),
    "absolute_angular_momentum": lambda s, who, o: _over(
        s, who, lambda n: s.masses[n] * cross(s.places[n] - _place(s, o), rate(s.places[n]))
    ),
    "angular_momentum": lambda s, who, o: _over(
        s,
        who,
        lambda n: s.masses[n] * cross(s.places[n] - _place(s, o), rate(s.places[n] - _place(s, o))),
    ),
    "torque": lambda s, who, o: _over(
        s, who, lambda n: cross(s.places[n] - _place(s, o), s.forces[n])
    ),
    "gravity": _gravity,
    "weight": lambda s, who: _over(s, who, lambda n: s.masses[n] * _gravity(s)),
    "weight_torque": lambda s, who, o: _over(
        s, who, lambda n: cross(s.places[n] - _place(s, o), s.masses[n] * _gravity(s))
    ),
    "weight_energy": lambda s, who, o: (
        -_over(
            s, who, lambda n: s.masses[n] * ((s.places[n] - _place(s, o)) * _gravity(s)).sum(axis=0)
        )
    ),
    "reaction": lambda s, who: _over(s, who, lambda n: s.forces[n] - s.masses[n] * _gravity(s)),
    "reaction_torque": lambda s, who, o: _over(
        s,
        who,
        lambda n: cross(s.places[n] - _place(s, o), s.forces[n] - s.masses[n] * _gravity(s)),
    ),
    "kinetic_energy": lambda s, who: _energy(s, who, s.points["OI"]),
    "rotational_energy": lambda s, who, o: _energy(s, who, _place(s, o)),
    "inertia": _inertia,
}
"""One rule a quantity, from its meaning in words."""


# -- terms -----------------------------------------------------------------------------------


class Values:
    """Values of terms in a scene; symbols without a meaning are random numbers."""

    def __init__(self, scene, scalars):
        self.scene, self.scalars, self.memo = scene, scalars, {}

    def of(self, term, env):
        key = (term, tuple(sorted((k, v) for k, v in env.items() if k in term.labels)))
        if any(n.head == "expr" for n in nodes(term)):
            key = (term, tuple(sorted(env.items())))
        if key not in self.memo:
            self.memo[key] = getattr(self, "_" + term.head)(term, env)
        return self.memo[key]

    def _args(self, term, env):
        return [self.of(a, env) for a in term.args]

    def _zero(self, term, _):
        return (
            still(np.array(Decimal(0) if term.data[0] == "scalar" else [Decimal(0)] * 3))
            if (term.data[0] in {"scalar", "vector", "column"})
            else _identity(self.scene) * 0
        )

    def _atom(self, term, env):
        name, *labels = term.data
        labels = tuple(0 if n == "P" else env.get(n, n) for n in labels)
        key = (name, labels)
        if key not in self.scene.memo:
            self.scene.memo[key] = ATOMS[name](self.scene, *labels)
        return self.scene.memo[key]

    def _add(self, term, env):
        return sum(self._args(term, env))

    def _mul(self, term, env):
        return (
            np.prod(np.array([1, *self._args(term, env)], dtype=object), axis=0)
            if (term.kind == "scalar")
            else self.scaled(self._args(term, env))
        )

    @staticmethod
    def scaled(values):
        result = values[-1]
        for v in values[:-1]:
            result = v * result
        return result

    def _dot(self, term, env):
        a, b = self._args(term, env)
        if a.ndim == 2:
            return (a * b).sum(axis=0) if b.ndim == 2 else (a[:, None] * b).sum(axis=0)
        return matrix_by_vector(a, b) if b.ndim == 2 else matrix_by_matrix(a, b)

    def _cross(self, term, env):
        return cross(*self._args(term, env))

    def _outer(self, term, env):
        a, b = self._args(term, env)
        return a[:, None] * b[None]

    _outer_column = _outer

    def _der(self, term, env):
        (value,) = self._args(term, env)
        if term.args[0].kind not in {"vector", "dyadic"}:
            return rate(value)
        C = self.scene.frames[term.data[0]].C
        return self._components(turned(C), rate(self._components(C, value)))

    def _since(self, term, env):
        """The integral from the middle of the span, where time is zero."""
        return np.dot(*self._args(term, env), _calculus()[2])

    def _start(self, term, env):
        (value,) = self._args(term, env)
        return np.repeat(value[..., NODES // 2, None], NODES, axis=-1)

    @staticmethod
    def _components(C, value):
        once = matrix_by_vector if value.ndim == 2 else matrix_by_matrix
        return once(C, value) if value.ndim == 2 else matrix_by_matrix(once(C, value), turned(C))

    def _sum(self, term, env):
        index, over = term.data
        count = len(self.scene.rotors if over == "rotors" else self.scene.masses)
        return sum(self.of(term.args[0], {**env, index: n}) for n in range(count))

    def _integral(self, term, env):
        parts = enumerate(self.scene.masses)
        return sum(m * self.of(term.args[0], {**env, term.data[0]: n}) for n, m in parts)

    def _column(self, term, env):
        return self._components(self.scene.frames[term.data[0]].C, *self._args(term, env))

    def _matmul(self, term, env):
        a, b = self._args(term, env)
        return matrix_by_vector(a, b) if b.ndim == 2 else matrix_by_matrix(a, b)

    def _transpose(self, term, env):
        return turned(*self._args(term, env))

    def _inverse(self, term, env):
        return inverted(*self._args(term, env))

    def _tilde(self, term, env):
        return skew(*self._args(term, env))

    def _inner(self, term, env):
        a, b = self._args(term, env)
        return (a * b).sum(axis=0)

    def _entries(self, term, env):
        values = np.array(self._args(term, env))
        return values if len(values) == 3 else values.reshape(3, 3, NODES)

    def _rows(self, term, env):
        return np.array(self._args(term, env))

    def _partial(self, term, env):
        """The derivative of an expression by one of its symbols."""
        value, by = (a.data[0] for a in term.args)
        return still(Decimal(0)) + self.plain(value.diff(by), env)

    def _expr(self, term, env):
        return still(Decimal(0)) + self.plain(term.data[0], env)

    def plain(self, e, env):
        """The value of a SymPy expression: numbers at the nodes, or one number."""
        if e.is_Rational:
            return Decimal(int(e.p)) / Decimal(int(e.q))
        if e.is_NumberSymbol:
            return Decimal(str(sp.N(e, DIGITS + 8)))
        if e.is_Symbol:
            return env[e] if e in env else self._symbol(e, env)
        rule = next((r for kind, r in EXPRESSIONS if isinstance(e, kind)), None)
        if rule is not None:
            return rule(self, e, env)
        return FUNCTIONS[type(e)](self.plain(e.args[0], env))

    def parts(self, e, env):
        return [self.plain(a, env) for a in e.args]

    def _symbol(self, e, env):
        if e in self.scalars:
            return self.of(self.scalars[e], {k: v for k, v in env.items() if isinstance(k, str)})
        return Random(self.scene.seed, "symbol", e.name).number()

    def determinant(self, e, env):
        return _determinant([[self.plain(x, env) for x in row] for row in e.arg.tolist()])

    def power(self, e, env):
        base, exponent = self.plain(e.base, env), e.exp
        if exponent.is_Integer:
            return base ** int(exponent)
        if (2 * exponent).is_Integer:
            return SQRT(base) ** int(2 * exponent)
        return EXP(LOG(base) * self.plain(exponent, env))

    def quadrature(self, inside, limits, env):
        """A repeated integral by Gauss's rule, the innermost variable first in ``limits``."""
        if not limits:
            return self.plain(inside, env)
        *inner, (x, low, high) = limits
        a, b = self.plain(low, env), self.plain(high, env)
        points, weights = _gauss()
        axis = len(limits) - 1
        shape = [1] * 3
        shape[axis] = -1
        x_values = (a + b) / 2 + (b - a) / 2 * points.reshape(shape)
        value = self.quadrature(inside, inner, {**env, x: x_values})
        total = np.sum(value * (weights.reshape(shape) + 0 * x_values), axis=axis, keepdims=True)
        total = total * (b - a) / 2
        return total.item() if getattr(total, "size", 1) == 1 else total


def _determinant(rows):
    """By the first row."""
    if not rows:
        return Decimal(1)
    minors = ([[*row[:k], *row[k + 1 :]] for row in rows[1:]] for k in range(len(rows)))
    return sum((-1) ** k * rows[0][k] * _determinant(m) for k, m in enumerate(minors))


EXPRESSIONS = (
    (sp.Integral, lambda v, e, env: v.quadrature(e.function, list(e.limits), env)),
    (sp.Derivative, lambda v, e, env: v.plain(e.doit(), env)),
    (sp.Determinant, Values.determinant),
    (sp.Pow, Values.power),
    (sp.Add, lambda v, e, env: sum(v.parts(e, env))),
    (sp.Mul, lambda v, e, env: v.scaled(v.parts(e, env))),
)
FUNCTIONS = {
    sp.sin: SIN,
    sp.cos: COS,
    sp.tan: TAN,
    sp.exp: EXP,
    sp.log: LOG,
    sp.Abs: abs,
}


@lru_cache(maxsize=1)
def _gauss(order=36):
    """Points and weights on [-1, 1]."""
    with mp.workdps(DIGITS + 20):
        guesses = np.polynomial.legendre.leggauss(order)[0]
        roots = [mp.findroot(lambda x: mp.legendre(order, x), mp.mpf(g)) for g in guesses]
        weights = [2 * (1 - x * x) / (order * mp.legendre(order - 1, x)) ** 2 for x in roots]
        return np.array([_exact(x) for x in roots]), np.array([_exact(w) for w in weights])


# -- verdicts --------------------------------------------------------------------------------


def residual(equation, assumptions, scalars, seed):
    """How far the two sides are apart in the scene of a seed."""
    with localcontext(prec=DIGITS):
        return apart(equation, _values(frozenset(assumptions), seed, tuple(scalars.items())))


def apart(equation, values):
    """The largest difference of the two sides near the middle of the span, relative to their size.

    For ``>=``: how far the left side, less the right, is below zero.
    """
    scene = values.scene
    free = sorted(_free(equation, values.scalars) & INDICES)
    ranges = [range(len(scene.rotors if i == "k" else scene.masses)) for i in free]
    worst = 0.0
    for numbers in product(*ranges):
        env = dict(zip(free, numbers, strict=True))
        left, right = (values.of(t, env) for t in (equation.left, equation.right))
        difference = left - right
        if equation.relation == ">=":
            difference = np.minimum(difference, Decimal(0))
        middle = slice(NODES // 2 - 2, NODES // 2 + 3)
        size = max(1, *(abs(v[..., middle]).max() for v in (left, right)))
        worst = max(worst, float(abs(difference[..., middle]).max() / size))
    return worst


def _free(equation, scalars):
    """Free labels, those within the meanings of symbols too."""
    found = equation.left.labels | equation.right.labels
    for side in (equation.left, equation.right):
        for n in nodes(side):
            if n.head == "expr":
                known = [scalars[s] for s in n.data[0].free_symbols if s in scalars]
                found = found.union(*(m.labels for m in known))
    bound = {
        n.data[0]
        for s in (equation.left, equation.right)
        for n in nodes(s)
        if n.head in {"sum", "integral"}
    }
    plain = equation.left.labels | equation.right.labels
    return plain | (found - bound)


@lru_cache(maxsize=64)
def _values(assumed, seed, scalars):
    return Values(scene_of(assumed, seed), dict(scalars))


def is_true(equation, assumptions, scalars, scenes=2):
    """Whether an equation holds in all scenes; raises `Undefined`.

    A sign is right by chance in half of the scenes, so that it takes more of them.
    """
    if UNKNOWN.intersection(assumptions):
        raise Undefined("no motion is drawn for this", assumptions)
    for seed in range(40 if equation.relation == ">=" else scenes):
        try:
            found = residual(equation, assumptions, scalars, seed)
        except (DecimalException, ZeroDivisionError) as error:
            raise Undefined from error
        if found > FALSE:
            return False
        if found > TRUE:
            raise Undefined(found)
    return True
