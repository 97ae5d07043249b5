r"""Systems composed of the parts that sentences name: a trolley on a rail, a beam hinged to it, a buffer.

`rows` writes a plan (`eom.checker.infer.plans`) down as a description with coordinates and places, from
which the equations are derived: nothing here is a result.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any

from eom.checker.infer.plans import Guide, Hinge, Plan, UnknownSystem, plan
from eom.checker.infer.setups import GROUND, MOVING, Setup, Size, Thing, vocabulary
from eom.checker.infer.systems import DIRECTIONS, Row, Tie, table_row
from eom.checker.read.symbol_shape import Look

Point = tuple[str, str]


@dataclass
class Built:
    """A description while it is written: keys of a system's table, letters, what is tied by words."""

    plan: Plan
    coordinates: dict[str, str] = field(default_factory=dict)
    parameters: dict[str, str] = field(default_factory=dict)
    given: dict[str, str] = field(default_factory=dict)
    bodies: dict[str, dict[str, Any]] = field(default_factory=dict)
    reactions: dict[str, dict[str, Any]] = field(default_factory=dict)
    values: dict[str, dict[str, Any]] = field(default_factory=dict)
    potential: list[str] = field(default_factory=list)
    springs: dict[str, dict[str, Any]] = field(default_factory=dict)
    forces: dict[str, list[str]] = field(default_factory=dict)
    letters: dict[str, tuple[str, str]] = field(default_factory=dict)
    ties: dict[str, Tie] = field(default_factory=dict)
    angles: list[str] = field(default_factory=list)
    assume: list[str] = field(default_factory=list)
    at: dict[str, Point] = field(default_factory=dict)
    tips: dict[str, Point] = field(default_factory=dict)
    moves: dict[str, str] = field(default_factory=dict)
    turns: dict[str, str] = field(default_factory=dict)
    phrases: list[str] = field(default_factory=list)
    looks: dict[tuple[str, Look | str], str] = field(default_factory=dict)
    sized: str = ""
    level: bool = False
    """Whether displacements are counted from rest, where weights and springs balance."""

    def size(self, key: str, quantity: str) -> str:
        """Return the name of the quantity of a part, a new parameter where it is not known yet."""
        base, usual, words = _QUANTITIES[quantity]
        found = self.plan.setup.size(key, quantity) or self._unowned(key, quantity)
        look = found.look if found is not None else None
        known = self.looks.get((quantity, look or key))
        if known is not None:
            return known
        name = f"{base}_{key}" if self._several(key, quantity) else base
        self.parameters[name] = _units()[quantity]
        noun = self.plan.setup.things[key].noun if key in self.plan.setup.things else ""
        self.letters[name] = usual, rf"(?:{words})\b.{{0,40}}\b{noun}\b"
        self.looks[quantity, look or key] = name
        if found is not None and look is not None:
            self.ties[name] = Tie(look, name, found.words, found.line)
        elif found is not None and quantity == "length":
            self.sized = name
        return name

    def _several(self, key: str, quantity: str) -> bool:
        """Return whether other parts have such a quantity, too."""
        kinds = MOVING if quantity == "mass" else {self.plan.kind(key)}
        alike = self.plan.of_kind(self.plan.setup.things, *kinds)
        return len([k for k in alike if quantity != "mass" or k in self.plan.placed]) > 1

    def _unowned(self, key: str, quantity: str) -> Size | None:
        """Return a letter of which no part is named, where this part alone lacks one."""
        kind = self.plan.kind(key)
        lacking = [
            k
            for k, t in self.plan.setup.things.items()
            if t.kind == kind and not self.plan.setup.size(k, quantity)
        ]
        if len(lacking) != 1:
            return None
        whole = [
            k
            for k in self.plan.of_kind(self.plan.setup.things, "buffer")
            if k not in self.plan.springs
        ]
        found = (self.plan.setup.size(k, quantity) for k in ("", *whole))
        return next((f for f in found if f is not None), None)

    def coordinate(self, base: str, unit: str, key: str, usual: str, words: str) -> str:
        """Return the name of a new coordinate."""
        name = base if base not in self.coordinates else f"{base}_{key}"
        self.coordinates[name] = unit
        self.letters[name] = usual, words
        return name


_QUANTITIES = {
    "mass": ("m", "m M", "mass"),
    "length": ("l", r"l \ell L", "length"),
    "radius": ("r", "r R a", "radius"),
    "inertia": ("J", r"J I \Theta", "moment of inertia"),
    "stiffness": ("k", "k", "stiffness|constant|rate"),
    "damping": ("c", "c b d", "damp|viscous|dashpot"),
    "natural": ("l_0", r"l_0 \ell_0 L_0", "natural|relaxed|unstretched|rest"),
    "slope": ("alpha", r"\alpha \beta \theta", "slope|inclination|incline|angle"),
    "friction": ("mu", r"\mu", "friction"),
}


def _units() -> Mapping[str, str]:
    return {k: w[1] for k, w in vocabulary()["sizes"].items()}


def _sum(a: str, b: str) -> str:
    if b.startswith("-"):
        return b if a == "0" else f"{a} - {b[1:]}"
    return b if a == "0" else a if b == "0" else f"{a} + {b}"


def _moved(point: Point, angle: str, length: str) -> Point:
    """Return the point at a distance from another, in a direction counted from the downward vertical."""
    return _sum(point[0], f"({length})*sin({angle})"), _sum(point[1], f"-({length})*cos({angle})")


_TRANSLATION = (
    r"x s y q u z",
    "position|displacement|travel|coordinate|distance|deflection|elongation",
)
_ANGLE = r"\theta \varphi \phi \alpha \vartheta \psi", "angle|deflection"


def build(p: Plan, *, level: bool = False, farther: bool = False) -> Built:
    """Write a plan down. ``farther``: a ball at the end of a rod touches it with its surface."""
    b = Built(p, level=level)
    for key, guide in p.guides.items():
        _guide(b, key, guide)
    left = dict(p.hinges)
    while left:
        ready = [k for k, h in left.items() if h.on == GROUND or h.on in b.at]
        if not ready:
            raise UnknownSystem("hinges in a circle")
        for key in ready:
            _swing(b, key, left.pop(key))
    for key, rod in p.glued.items():
        _fix(b, key, rod, farther=farther)
    for rope in (*p.over, *p.wound):
        _rope(b, rope)
    for key in p.rotors:
        _rotor(b, key)
    for key, ends in p.springs.items():
        _spring(b, key, ends)
    for key in p.braked:
        b.forces.setdefault(b.moves[key], []).append(
            f"-{b.size(key, 'damping')}*{b.moves[key]}_dot"
        )
        b.phrases.append(f"viscous friction on the {_noun(key)}")
    _loads(b)
    _extras(b)
    return b


def _noun(key: str) -> str:
    return "ground" if key == GROUND else key.replace("_", " ")


def _own_words(b: Built, key: str, words: str) -> str:
    """Return words for a coordinate: with the noun of its part, of one alone without."""
    noun = b.plan.setup.things[key].noun
    return rf"(?:{words})\b.{{0,40}}\b{noun}|\b{noun}\b.{{0,20}}(?:{words})|{words}"


def _guide(b: Built, key: str, guide: Guide) -> None:
    if guide.way == "turning":
        _turned(b, key, guide.by)
        return
    usual, words = _TRANSLATION
    name = b.coordinate("x", "m", key, usual, _own_words(b, key, words))
    at = {
        "horizontal": (name, "0"),
        "vertical": ("0", f"-{name}"),
    }.get(guide.way)
    if at is None:
        slope = b.size(guide.by, "slope") if "alpha" not in b.parameters else "alpha"
        at = f"{name}*cos({slope})", f"-{name}*sin({slope})"
    b.at[key], b.moves[key] = at, name
    body = {"mass": b.size(key, "mass"), "at": [at[0], at[1], 0]}
    if guide.rolls:
        r = b.size(key, "radius")
        body |= {"moments": [_moment(b, key, r)], "omega": [f"{name}_dot/{r}"]}
        b.values["omega"] = {"is": f"{name}_dot/{r}", "unit": "rad/s"}
        b.letters["omega"] = r"\omega", "angular (?:velocity|speed)"
    b.bodies[key] = body
    does = "rolls" if guide.rolls else "moves"
    line = {"incline": "down an incline"}.get(guide.way, f"along a {guide.way} line")
    b.phrases.append(f"the {_noun(key)} {does} {line}")


def _turned(b: Built, key: str, by: str) -> None:
    """Put a part on a straight line that turns in a horizontal plane."""
    setup = b.plan.setup
    if (
        not re.search(r"horizontal plane|vertical (?:axis|axle|shaft)", setup.text)
        or "inclin" in setup.text
    ):
        raise UnknownSystem(by)
    name = b.coordinate(
        "r", "m", key, r"r s x \rho", _own_words(b, key, "distance|position|coordinate")
    )
    b.given["phi"] = "rad"
    b.letters["phi"] = r"\varphi \phi \theta", "angle"
    b.letters["phi_dot"] = r"\omega \Omega", "rate|angular (?:velocity|speed)"
    rate = setup.size(by, "rate")
    if rate is not None and rate.look is not None:
        b.ties["phi_dot"] = Tie(rate.look, "phi_dot", rate.words, rate.line)
    if re.search(r"\b(?:constant|uniform|steady)\b", rate.words if rate is not None else ""):
        b.assume.append("phi_dot constant")
    b.moves[key] = name
    b.bodies[key] = {"mass": b.size(key, "mass"), "at": [f"{name}*cos(phi)", 0, f"{name}*sin(phi)"]}
    b.reactions["N"] = {"on": key, "along": ["-sin(phi)", 0, "cos(phi)"]}
    b.letters["N"] = "N S F", "force"
    b.phrases.append(f"the {_noun(key)} moves along a {_noun(by)} that turns in a horizontal plane")


_SHAPES = (
    (r"\bhollow (?:ball|sphere)|spherical shell", "2/3"),
    (r"\b(?:hoop|ring)|thin-walled|hollow cylinder", "1"),
    (r"\b(?:ball|sphere)", "2/5"),
    (r"\b(?:disc|cylinder|drum|wheel|roller|pulley|flywheel)", "1/2"),
)


_EVEN = frozenset({"uniform", "homogeneous", "solid", "thin-walled", "hollow", "thin"})


def _moment(b: Built, key: str, radius: str) -> str:
    """Return the moment of inertia of a round part: by its shape if it is uniform, else a letter."""
    thing, setup = b.plan.setup.things[key], b.plan.setup
    inertia = setup.size(key, "inertia")
    if not thing.adjectives & _EVEN or (inertia is not None and setup.size(key, "mass") is None):
        return b.size(key, "inertia")
    shape = " ".join((*sorted(thing.adjectives), thing.noun))
    factor = next(f for s, f in _SHAPES if re.search(s, shape))
    found = f"{factor}*{b.size(key, 'mass')}*{radius}^2"
    if inertia is not None and inertia.look is not None:
        name = f"J_{key}"
        b.values[name] = {"is": found, "unit": "kg m^2"}
        b.letters[name] = _QUANTITIES["inertia"][1:]
        b.ties[name] = Tie(inertia.look, name, inertia.words, inertia.line)
    return found


def _swing(b: Built, key: str, hinge: Hinge) -> None:
    p, thing = b.plan, b.plan.setup.things[key]
    pivot = _support(b) if hinge.on == GROUND else (b.tips if hinge.at_end else b.at)[hinge.on]
    usual, words = _ANGLE
    noun = thing.noun if not hinge.link else f"{thing.noun}|{p.setup.things[hinge.link].noun}"
    angle = b.coordinate("theta", "rad", key, usual, rf"(?:{words}).{{0,60}}\b(?:{noun})|{words}")
    b.angles.append(angle)
    b.turns[key] = angle
    mass = b.size(key, "mass")
    if thing.kind == "rod":
        length = b.size(key, "length")
        b.at[key], b.tips[key] = _moved(pivot, angle, f"{length}/2"), _moved(pivot, angle, length)
        moments = {"moments": [f"{mass}*{length}^2/12"], "omega": [f"{angle}_dot"]}
    elif _small(b, thing, hinge):
        length = b.size(hinge.link if p.setup.size(hinge.link, "length") else key, "length")
        b.at[key] = b.tips[key] = _moved(pivot, angle, length)
        moments = {}
        if not b.reactions:
            b.reactions["S"] = {"on": key, "along": [f"-sin({angle})", f"cos({angle})", 0]}
            b.letters["S"] = "S T Z F", "tension|force (?:in|of) the (?:string|rod|rope|cord)"
        if pivot == ("0", "0"):
            b.values["v"] = {"is": f"{length}*{angle}_dot", "unit": "m/s"}
            b.values["h"] = {"is": f"{length} - {length}*cos({angle})", "unit": "m"}
            b.letters |= {"v": ("v", "(?<!angular )(?:speed|velocity)"), "h": ("h", "height")}
    else:
        raise UnknownSystem(key)
    b.bodies[key] = {"mass": mass, "at": [*b.at[key], 0], **moments}
    where = "a fixed pivot" if hinge.on == GROUND else f"the {_noun(hinge.on)}"
    by = f" on a {_noun(hinge.link)}" if hinge.link else ""
    b.phrases.append(f"the {_noun(key)} swings about {where}{by}")


def _support(b: Built) -> Point:
    """Return the place of a pivot that is not on a part: a fixed one, or one that is moved."""
    moved = [s for s in b.plan.setup.sizes if s.quantity in {"sideways", "upwards"}]
    if len(moved) > 1 or (
        moved and (len(b.plan.hinges) > 1 or b.plan.kind(moved[0].of) != "place")
    ):
        raise UnknownSystem("moved supports")
    if not moved or moved[0].look is None:
        return "0", "0"
    b.given["u"] = "m"
    b.letters["u"] = "u", "displacement|motion"
    b.ties["u"] = Tie(moved[0].look, "u", moved[0].words, moved[0].line)
    b.phrases.append(f"the {_noun(moved[0].of)} is moved {moved[0].quantity}")
    return ("u", "0") if moved[0].quantity == "sideways" else ("0", "u")


def _small(b: Built, thing: Thing, hinge: Hinge) -> bool:
    """Return whether a part hangs as a particle does."""
    if thing.kind == "round":
        return bool(hinge.link) and b.plan.setup.size(thing.key, "radius") is None
    return thing.kind == "pendulum" or bool(hinge.link) or thing.noun in {"bob", "particle"}


def _fix(b: Built, key: str, rod: str, *, farther: bool) -> None:
    """Fix a part to the end of a rod."""
    angle, pivot = b.turns[rod], b.plan.hinges[rod]
    if pivot.on != GROUND:
        raise UnknownSystem(key)
    mass, length = b.size(key, "mass"), b.size(rod, "length")
    moments: dict[str, Any] = {}
    if b.plan.kind(key) == "round":
        radius = b.size(key, "radius")
        length = f"{length} + {radius}" if farther else length
        moments = {"moments": [_moment(b, key, radius)], "omega": [f"{angle}_dot"]}
    at = _moved(("0", "0"), angle, length)
    b.at[key] = at
    b.bodies[key] = {"mass": mass, "at": [at[0], at[1], 0], **moments}
    b.phrases.append(f"the {_noun(key)} is fixed to the end of the {_noun(rod)}")


_PULL = "tension|force (?:in|of) the (?:string|rope|cord)|rope force"


def _rope(b: Built, rope: str) -> None:
    """Lay a rope over a pulley or wind it on a drum; its masses move with it."""
    p = b.plan
    drum, masses = (p.over.get(rope) or p.wound[rope]), p.ends[rope]
    slid = [m for m in masses if m in p.guides]
    if len(slid) > 1 or any(p.guides[m].way not in {"horizontal", "incline"} for m in slid):
        raise UnknownSystem(rope)
    usual, words = _TRANSLATION
    own = _own_words(b, masses[0], words)
    name = b.moves[slid[0]] if slid else b.coordinate("x", "m", masses[0], usual, own)
    signs = iter(["-", ""])
    for number, key in enumerate(masses, 1):
        if key not in slid:
            b.at[key], b.moves[key] = ("0", f"{next(signs)}{name}"), name
            b.bodies[key] = {"mass": b.size(key, "mass"), "at": [*b.at[key], 0]}
            side = f"S_{number}" if len(masses) > 1 else "S"
            b.reactions[side] = {"on": key, "along": [0, 1, 0]}
            b.letters[side] = f"{side} T_{number} F_{number} S T F", _PULL
    radius = b.size(drum, "radius")
    light = p.setup.things[drum].light
    b.turns[drum] = f"{name}/{radius}"
    b.bodies[drum] = {
        "mass": 0,
        "at": [0, 0, 0],
        "omega": [f"{name}_dot/{radius}"],
        "moments": ["0" if light else _moment(b, drum, radius)],
    }
    b.values["omega"] = {"is": f"{name}_dot/{radius}", "unit": "rad/s"}
    b.letters["omega"] = r"\omega \Omega", "angular (?:velocity|speed)"
    joined = " and ".join(map(_noun, masses))
    b.phrases.append(f"a {_noun(rope)} joins {joined} over the {_noun(drum)}")


def _rotor(b: Built, key: str) -> None:
    if key in b.bodies:
        return
    name = b.coordinate("phi", "rad", key, r"\varphi \phi \theta", "angle")
    b.turns[key] = name
    b.bodies[key] = {
        "mass": 0,
        "at": [0, 0, 0],
        "moments": [_inertia(b, key)],
        "omega": [f"{name}_dot"],
    }
    b.values["omega"] = {"is": f"{name}_dot", "unit": "rad/s"}
    b.letters["omega"] = r"\omega \Omega", "angular (?:velocity|speed)"
    b.phrases.append(f"the {_noun(key)} turns about a fixed axis")


def _inertia(b: Built, key: str) -> str:
    if b.plan.setup.size(key, "inertia") is None and b.plan.setup.size(key, "radius") is not None:
        return _moment(b, key, b.size(key, "radius"))
    return b.size(key, "inertia")


def _spring(b: Built, key: str, ends: tuple[str, str]) -> None:
    """Put a spring, a damper or both between two parts, or a part and the ground."""
    kind = b.plan.kind(key)
    held = b.turns if kind == "twist" else b.moves
    places = [held.get(e, "") for e in ends if e != GROUND]
    if "" in places or len(set(places)) < len(places):
        raise UnknownSystem(key)
    damped = kind == "damper" or (kind == "buffer" and b.plan.setup.size(key, "damping"))
    if damped:
        _damping(b, b.size(key, "damping"), places)
    if kind == "buffer" and not b.plan.setup.size(key, "stiffness"):
        raise UnknownSystem(key)
    if kind != "damper":
        _stiffness(b, key, ends, places)
    nouns = " and ".join(f"the {_noun(e)}" for e in ends)
    b.phrases.append(f"a {_noun(key)} between {nouns}")


def _damping(b: Built, c: str, places: Sequence[str]) -> None:
    rate = " - ".join(f"{q}_dot" for q in places)
    for sign, q in zip("-+", places, strict=False):
        b.forces.setdefault(q, []).append(f"{sign}{c}*({rate})")
    before = f"{b.values['D']['is']} + " if "D" in b.values else ""
    b.values["D"] = {"is": f"{before}{c}*({rate})^2/2", "unit": "W"}
    b.letters["D"] = r"D \mathcal{D} \mathcal{F} R", "dissipation|rayleigh"


def _stiffness(b: Built, key: str, ends: tuple[str, str], places: Sequence[str]) -> None:
    k, twist = b.size(key, "stiffness"), b.plan.kind(key) == "twist"
    natural = bool(b.plan.setup.size(key, "natural")) and not b.level
    if twist:
        b.parameters[k] = "N*m"
    if twist or natural:
        between = f"({' - '.join(places)})"
        less = f" - {b.size(key, 'natural')}" if natural else ""
        b.potential.append(f"{k}*({between}{less})^2/2")
    else:
        held = [e if e != GROUND else [0, 0, 0] for e in ends]
        b.springs[key] = {"between": held, "stiffness": k}


_REACTION = re.compile(
    r"\b(?:reaction|contact|constraint|normal|friction|tension|spring force|exerts?|between|vertical|"
    r"centrifugal|inertial?|restoring|elastic|gravit\w+|weight|resultant|total|net|generali[sz]ed|impulse)\b"
    r"|\b(?:of|by) the (?!motor|drive|engine)",
    re.IGNORECASE,
)
"""Words of a force that no writer applies: what keeps parts together."""


def _loads(b: Built) -> None:
    """Add forces and torques that are applied. Raises `UnknownSystem` for one on an unknown part."""
    for size in b.plan.setup.sizes:
        applied = size.quantity in {"force", "torque"} and not _REACTION.search(size.words)
        if size.look is None or not applied:
            continue
        names = b.moves if size.quantity == "force" else b.turns
        of = size.of or (next(iter(names)) if len(names) == 1 else "")
        name = names.get(of)
        if name is None or name not in b.coordinates:
            raise UnknownSystem(size.words)
        letter = "F" if size.quantity == "force" else "M"
        letter = letter if letter not in b.given else f"{letter}_{of}"
        b.given[letter] = "N" if size.quantity == "force" else "N*m"
        b.letters[letter] = "F u f" if letter[0] == "F" else r"M \tau", size.quantity
        b.ties[letter] = Tie(size.look, letter, size.words, size.line)
        b.forces.setdefault(name, []).append(f"+{letter}")
        b.phrases.append(f"a {size.quantity} on the {_noun(of)}")


def _extras(b: Built) -> None:
    """Add what people name in such systems: places and speeds of centres, moments of inertia, periods."""
    swung = {k: a for k, a in b.turns.items() if k in b.plan.hinges}
    rods = [k for k in swung if b.plan.kind(k) == "rod"]
    if len(rods) == 1:
        _rod_values(b, rods[0], swung[rods[0]])
    if len(b.coordinates) == 1:
        (name,) = b.coordinates
        if name in b.moves.values():
            b.values |= {
                "v": {"is": f"{name}_dot", "unit": "m/s"},
                "a": {"is": f"{name}_ddot", "unit": "m/s^2"},
            }
            b.letters |= {
                "v": ("v", "(?<!angular )(?:speed|velocity)"),
                "a": ("a", "(?<!angular )acceleration"),
            }
        else:
            _about_pivot(b, name)


def _rod_values(b: Built, key: str, angle: str) -> None:
    x, y = b.at[key]
    mass, length = b.size(key, "mass"), b.size(key, "length")
    b.values["x_centre"] = {"is": x, "unit": "m"}
    b.values["y_centre"] = {"is": y, "unit": "m"}
    b.values["I_centre"] = {"is": f"{mass}*{length}^2/12", "unit": "kg m^2"}
    b.letters["x_centre"] = "x_G x_C x_S x_{cm}", "x|horizontal coordinate"
    b.letters["y_centre"] = "y_G y_C y_S y_{cm} z_G z_C z_S", "height|vertical coordinate"
    b.letters["I_centre"] = (
        r"I_G J_G I_C J_C I_S J_S \Theta_S",
        "moment of inertia .{0,60}(?:centre|center|about [GCS])",
    )
    on = b.plan.hinges[key].on
    if on in b.plan.guides and b.plan.guides[on].way == "horizontal":
        q, w = f"{b.moves[on]}_dot", f"{length}/2*{angle}_dot"
        square = f"{q}^2 + 2*{q}*{w}*cos({angle}) + ({w})^2"
        b.values["v_centre"] = {"is": f"sqrt({square})", "unit": "m/s"}
        b.letters["v_centre"] = "v_G v_C v_S", "speed"
        b.letters[f"position of {key}"] = (
            r"\mathbf{r}_C \vec{r}_C \mathbf{r}_S \vec{r}_S \mathbf{r}_G \vec{r}_G",
            "position",
        )
        b.letters[f"velocity of {key}"] = (
            r"\mathbf{v}_C \vec{v}_C \mathbf{v}_S \vec{v}_S \mathbf{v}_G \vec{v}_G",
            "velocity",
        )
        b.reactions["N"] = {"on": key, "along": [0, 1, 0]}
        b.letters["N"] = "N V", "vertical force"


def _about_pivot(b: Built, angle: str) -> None:
    """Add the moment of inertia about the pivot and the distance of the centre of mass of a pendulum."""
    keys = (*b.plan.hinges, *b.plan.glued)
    arms = {k: _arm(b.at[k]) for k in keys}
    if angle not in b.turns.values() or "" in arms.values():
        return
    moments = [m for k in keys for m in b.bodies[k].get("moments", ())]
    inertia = [*moments, *(f"{b.bodies[k]['mass']}*({arms[k]})^2" for k in keys)]
    whole = " + ".join(b.bodies[k]["mass"] for k in keys)
    first = " + ".join(f"{b.bodies[k]['mass']}*({arms[k]})" for k in keys)
    b.values["I"] = {"is": " + ".join(inertia), "unit": "kg m^2"}
    b.letters["I"] = r"I_O J_O I_A J_A I_P I J \Theta_O \Theta", "moments? of inertia|inertia"
    b.values["d"] = {"is": f"({first})/({whole})", "unit": "m"}
    b.letters["d"] = (
        "d",
        r"distance .{0,60}(?:centre|center)|mass cent(?:er|re) .{0,60}distance",
    )


def _arm(at: Point) -> str:
    match = re.fullmatch(r"\((.*)\)\*sin\(\w+\)", at[0])
    return match[1] if match else ""


def rows(setup: Setup) -> tuple[Row, ...]:
    """Return the systems that a setup may be, the likeliest first; none where it is not understood."""
    found: dict[str, Row] = {}
    beyond = re.search(r"\bcent(?:er|re)\W+(?:is|lies)\b.{0,20}\bdistance", setup.text)
    for level, farther in product((False, True), (True,) if beyond else (True, False)):
        try:
            row = _row(build(plan(setup), level=level, farther=farther), setup)
        except UnknownSystem:
            return ()
        found.setdefault(repr(row.table), row)
    return tuple(found.values())


def _row(b: Built, setup: Setup) -> Row:
    vertical = any(g.way == "vertical" for g in b.plan.guides.values())
    b.parameters["g"] = "m/s^2"
    b.letters["g"] = "g", "gravit"
    still = [*b.coordinates]
    named: dict[str, Any] = {
        "coordinates": b.coordinates,
        "given": b.given,
        "parameters": b.parameters,
        "gravity": [0, 0 if b.level and vertical else "-g", 0],
        "potential": " + ".join(b.potential) or 0,
        "forces": {q: " ".join(f) for q, f in b.forces.items()},
        "bodies": b.bodies,
        "springs": b.springs,
        "reactions": b.reactions if not b.potential else {},
        "values": b.values,
        "assume": b.assume,
        "motions": {"rest": {"constant": still, "zero": [*b.angles, *b.given]}},
    }
    letters = {**b.letters, **_periods(b)}
    if b.potential:
        letters = {k: w for k, w in letters.items() if k not in b.reactions}
    table = {k: v for k, v in named.items() if v not in ({}, [], 0)}
    row = table_row("; ".join(b.phrases), letters, table)
    return replace(
        row,
        angles=tuple(b.angles),
        sizes=(b.sized, f"2*{b.sized}", b.sized) if b.sized else (),
        shapes=("", "") if b.sized else (),
        bound=tuple(b.ties.values()),
        lines=setup.lines,
        until=setup.until,
        turns=_turns(setup.sizes),
    )


_COUNTED = (
    (
        "downward",
        r"downwards? vertical|vertically down|hangs? (?:straight|vertically) down|from (?:the )?hanging",
    ),
    ("upward", r"upwards? vertical|upright|vertically up"),
    ("vertical", r"vertical"),
    ("horizontal", r"horizontal"),
)


def _turns(sizes: Iterable[Size]) -> tuple[int, ...]:
    """Return from which directions angles are counted by what the words say of angles."""
    said = "; ".join(s.words for s in sizes if s.quantity == "slope")
    return next((DIRECTIONS[k] for k, w in _COUNTED if re.search(w, said)), (0, 1, 2, 3))


def _periods(b: Built) -> dict[str, tuple[str, str]]:
    """Return letters of small oscillations."""
    held = {e for ends in b.plan.springs.values() for e in ends if b.plan.kind(e) in MOVING}
    swings = sum(
        n in b.turns.values() or any(b.moves.get(e) == n for e in held) for n in b.coordinates
    )
    if swings <= 1:
        return {
            "frequency at rest": (r"\omega_0 \omega_n \omega \Omega \nu", "frequenc"),
            "period at rest": (r"T_0 \tau P T", "period"),
        }
    return {
        "frequency 1 at rest": (r"\omega_1 \omega_-", "slow|lower|first"),
        "frequency 2 at rest": (r"\omega_2 \omega_+", "fast|higher|second"),
    }
