r"""What each part of a system does, from what sentences say: guides, hinges, springs, ropes.

`plan` sorts facts (`eom.checker.infer.setups`): every part with a mass has to be placed once, every spring
and damper to have two ends, and what does not fit into that leaves the system unknown.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from eom.checker.infer.setups import GROUND, MOVING, Fact, Setup, Thing

_FIXED = frozenset({"line", "place"})


class UnknownSystem(Exception):
    """What is said does not make a system that can be composed."""


@dataclass(frozen=True)
class Guide:
    """A line along which a part moves: "horizontal", "vertical", "incline" or "turning"; whether it rolls.

    ``by``: the part that guides it.
    """

    way: str
    rolls: bool = False
    by: str = ""


@dataclass(frozen=True)
class Hinge:
    """A pivot about which a part swings: on what, by which string or light rod, whether at its end."""

    on: str
    link: str = ""
    at_end: bool = False


@dataclass
class Plan:
    """What each part does."""

    setup: Setup
    guides: dict[str, Guide] = field(default_factory=dict)
    hinges: dict[str, Hinge] = field(default_factory=dict)
    glued: dict[str, str] = field(default_factory=dict)
    rotors: list[str] = field(default_factory=list)
    springs: dict[str, tuple[str, str]] = field(default_factory=dict)
    wound: dict[str, str] = field(default_factory=dict)
    over: dict[str, str] = field(default_factory=dict)
    ends: dict[str, list[str]] = field(default_factory=dict)
    tied: dict[str, str] = field(default_factory=dict)
    braked: list[str] = field(default_factory=list)
    turning: list[str] = field(default_factory=list)

    def kind(self, key: str) -> str:
        """Return the kind of a part."""
        thing = self.setup.things.get(key)
        return "" if thing is None else thing.kind

    def of_kind(self, keys: Iterable[str], *kinds: str) -> list[str]:
        """Return the keys of parts of some kinds."""
        return [k for k in keys if self.kind(k) in kinds]

    def light(self, key: str) -> bool:
        """Whether a part is a rod or string without mass."""
        thing = self.setup.things.get(key)
        if thing is None or thing.kind not in {"rod", "string"}:
            return False
        return thing.kind == "string" or (thing.light and not self.setup.size(key, "mass"))

    @property
    def placed(self) -> list[str]:
        """Parts that have a place."""
        pulled = [b for s in (*self.over, *self.wound) for b in self.ends.get(s, ())]
        return [*self.guides, *self.hinges, *self.glued, *self.rotors,
                *(b for b in pulled if b not in self.guides)]  # fmt: skip


def plan(setup: Setup) -> Plan:
    """Return what each part of a setup does. Raises `UnknownSystem`."""
    made = Plan(setup)
    for fact in _ordered(setup.facts):
        rule = _RULES.get(fact.verb)
        if rule is None:
            raise UnknownSystem(fact.words)
        for subject in _each(fact):
            rule(made, subject, fact)
    _whole(made)
    return made


def _ordered(facts: Sequence[Fact]) -> list[Fact]:
    """Return facts in an order in which ropes are laid before masses hang from them."""
    first = ("turn", "wind", "slide", "roll", "carry")
    return sorted(facts, key=lambda f: first.index(f.verb) if f.verb in first else len(first))


def _each(fact: Fact) -> tuple[str, ...]:
    return fact.subjects if fact.verb != "join" else fact.subjects[:1]


_ALONG = ("on", "along", "upon", "over", "in", "inside", "down", "up", "against", "through")


def _slide(p: Plan, subject: str, fact: Fact) -> None:
    objects = fact.to()
    if p.kind(subject) == "string":
        rounds = p.of_kind(fact.to("over", "around", "on"), "round")
        if len(rounds) != 1:
            raise UnknownSystem(fact.words)
        p.over[subject] = rounds[0]
        bodies = [k for k in p.of_kind(objects, "point", "round") if k != rounds[0]]
        p.ends.setdefault(subject, []).extend(bodies)
        return
    if p.kind(subject) in _FIXED | {"spring", "damper", "motor"}:
        return
    lines = p.of_kind(fact.to(*_ALONG), "line", "rod")
    others = [k for k in p.of_kind(objects, *MOVING, "string", "spring") if k not in p.turning]
    if others or len(lines) != 1 or p.kind(subject) not in {"point", "round"}:
        raise UnknownSystem(fact.words)
    if lines[0] in p.turning:
        _place(p.guides, subject, Guide("turning", by=lines[0]), p)
        return
    rolls = p.kind(subject) == "round"
    slips = not re.search(r"roll\w* .{0,30}without slip", p.setup.text)
    if rolls and (slips or (fact.verb == "slide" and "slid" in fact.words)):
        raise UnknownSystem(fact.words)
    way = _way(p.setup.things[lines[0]], p.setup.words)
    _place(p.guides, subject, Guide(way, rolls, lines[0]), p)


def _way(line: Thing, words: str) -> str:
    """Return how a line lies."""
    if line.noun in {"slope", "incline", "ramp"} or "inclined" in line.adjectives:
        return "incline"
    if re.search(rf"{line.noun}\s+(?:\S+\s+){{0,2}}(?:inclin|of slope|of inclination)", words):
        return "incline"
    if "vertical" in line.adjectives:
        return "vertical"
    level = {"horizontal", "level"} & line.adjectives
    if level or line.noun in {"table", "floor", "ground", "bench", "track", "rail"}:
        return "horizontal"
    raise UnknownSystem(line.noun)


def _place(where: dict[str, Any], key: str, new: Any, p: Plan) -> None:
    """Give a part a place; it has one, or the same again."""
    if key in p.placed and where.get(key) != new:
        old = where.get(key)
        if isinstance(old, Hinge) and isinstance(new, Hinge) and GROUND in {old.on, new.on}:
            where[key] = old if new.on == GROUND and not new.link else new
            return
        raise UnknownSystem(key)
    where[key] = new


def _hang(p: Plan, subject: str, fact: Fact) -> None:
    objects = [k for k in fact.to() if k != subject]
    kind = p.kind(subject)
    if kind in _FIXED | {"string", "spring"}:
        if kind == "string":
            _tie(p, subject, objects)
        return
    if kind not in MOVING:
        raise UnknownSystem(fact.words)
    if (
        kind == "rod"
        and "end" not in objects
        and (subject in fact.to() or _INSIDE.search(fact.words))
    ):
        raise UnknownSystem(fact.words)
    springs = p.of_kind(objects, "spring")
    strings = [k for k in objects if k in p.over or k in p.wound]
    links = [k for k in objects if p.light(k)]
    bodies = [k for k in p.of_kind(objects, *MOVING) if k not in links]
    if springs:
        _on_spring(p, subject, springs, bodies)
    elif strings or _from_rope(p, kind, objects, bodies):
        rope = (strings or [*p.over, *p.wound])[0]
        p.ends.setdefault(rope, []).append(subject)
    elif len(links) <= 1 and len(bodies) <= 1:
        _pivot(p, subject, objects, links, bodies)
    else:
        raise UnknownSystem(fact.words)


def _from_rope(p: Plan, kind: str, objects: Sequence[str], bodies: Sequence[str]) -> bool:
    """Return whether a part hangs from the end of a rope that lies over a pulley or drum."""
    return bool(
        {"ends", "end"} & set(objects) and not bodies and (p.over or p.wound) and kind != "rod"
    )


def _pivot(
    p: Plan, subject: str, objects: Sequence[str], links: Sequence[str], bodies: Sequence[str]
) -> None:
    """Note about what a part swings; words on its motion alone say nothing."""
    on = bodies[0] if bodies else p.tied.get(links[0], GROUND) if links else GROUND
    held = "end" in objects or p.of_kind(objects, "place") or not p.of_kind(objects, "line")
    if on == GROUND and not links and (subject in p.hinges or not held):
        return
    _place(p.hinges, subject, Hinge(on, links[0] if links else "", p.kind(on) == "rod"), p)


_INSIDE = re.compile(r"\b(?:middle|cent(?:re|er)|third|quarter|half|distance)\b")
"""Words of a point of a rod that is not its end."""


def _on_spring(p: Plan, subject: str, springs: Sequence[str], bodies: Sequence[str]) -> None:
    swings = re.search(r"\b(?:swing\w*|pendul\w+)\b", p.setup.text)
    if swings or len(springs) != 1 or len(bodies) > 1 or springs[0] in p.springs:
        raise UnknownSystem(subject)
    p.springs[springs[0]] = (subject, bodies[0] if bodies else GROUND)
    if subject not in p.guides:
        p.guides[subject] = Guide("vertical")


def _tie(p: Plan, string: str, objects: Sequence[str]) -> None:
    """Note where the upper end of a string is."""
    bodies = p.of_kind(objects, *MOVING)
    if bodies and string not in p.over:
        p.tied[string] = bodies[0]


def _join(p: Plan, subject: str, fact: Fact) -> None:
    keys = [*fact.subjects, *fact.to()]
    elastic = p.of_kind(keys, "spring", "damper", "twist", "buffer")
    bodies = list(dict.fromkeys(p.of_kind(keys, *MOVING)))
    links = [k for k in keys if p.light(k)]
    bodies = [b for b in bodies if b not in links]
    fixed = p.of_kind(keys, *_FIXED)
    if elastic and 1 <= len(bodies) <= 2 and not (len(bodies) == 2 and p.of_kind(fixed, "place")):
        for one in elastic:
            p.springs[one] = (bodies[0], bodies[1] if len(bodies) > 1 else GROUND)
    elif links and len(bodies) == 1 and "end" in keys:
        _place(p.hinges, bodies[0], Hinge(p.tied.get(links[0], GROUND), links[0]), p)
    elif len(bodies) == 2 and "end" in keys and p.kind(bodies[1]) == "rod":
        _glue(p, subject, fact)
    elif links and not bodies:
        return
    elif links and p.kind(subject) == "string":
        _tie(p, subject, bodies)
    elif bodies or elastic:
        raise UnknownSystem(fact.words)


def _glue(p: Plan, subject: str, fact: Fact) -> None:
    rods = [k for k in p.of_kind(fact.to("to", "at", "of", "on"), "rod") if k != subject]
    if len(rods) != 1 or "end" not in fact.to() or p.kind(subject) not in {"point", "round"}:
        raise UnknownSystem(fact.words)
    if p.light(rods[0]):
        raise UnknownSystem(fact.words)
    _place(p.glued, subject, rods[0], p)


def _carry(p: Plan, subject: str, fact: Fact) -> None:
    links = [k for k in fact.to() if p.light(k)]
    bodies = [k for k in p.of_kind(fact.to(), *MOVING) if k not in links]
    if len(bodies) > 1:
        bodies = [k for k in bodies if p.kind(k) != "pendulum"]
    if len(bodies) != 1 or len(links) > 1 or p.kind(subject) not in MOVING:
        raise UnknownSystem(fact.words)
    if links:
        _place(p.hinges, bodies[0], Hinge(subject, links[0], p.kind(subject) == "rod"), p)
    elif p.kind(subject) == "rod" and "end" in fact.to():
        _place(p.glued, bodies[0], subject, p)
    elif p.kind(bodies[0]) in {"pendulum", "rod"} and p.kind(subject) == "point":
        _place(p.hinges, bodies[0], Hinge(subject), p)
    else:
        raise UnknownSystem(fact.words)


def _wind(p: Plan, subject: str, fact: Fact) -> None:
    rounds = p.of_kind(fact.to(), "round")
    if p.kind(subject) != "string" or len(rounds) != 1:
        raise UnknownSystem(fact.words)
    p.wound[subject] = rounds[0]


def _turn(p: Plan, subject: str, fact: Fact) -> None:
    others = p.of_kind(fact.to(), *MOVING, "string", "spring")
    slides = [f for f in p.setup.facts if f.verb == "slide" and subject in f.to()]
    if others or p.kind(subject) not in {"round", "rod", "line"}:
        raise UnknownSystem(fact.words)
    if slides and p.kind(subject) in {"rod", "line"} and not p.setup.size(subject, "mass"):
        p.turning.append(subject)
    elif p.kind(subject) == "rod":
        _place(p.hinges, subject, Hinge(GROUND), p)
    elif p.kind(subject) == "round" and not slides:
        p.rotors += [subject] if subject not in p.rotors else []
    else:
        raise UnknownSystem(fact.words)


def _act(p: Plan, subject: str, fact: Fact) -> None:
    if p.kind(subject) not in {*_FIXED, "motor"}:
        raise UnknownSystem(fact.words)


def _brake(p: Plan, subject: str, fact: Fact) -> None:  # noqa: ARG001
    bodies = p.of_kind(fact.to(), "point")
    if len(bodies) != 1 or "viscous" not in fact.words:
        raise UnknownSystem(fact.words)
    p.braked.append(bodies[0])


_RULES = {
    "slide": _slide, "roll": _slide, "hang": _hang, "join": _join, "glue": _glue, "carry": _carry,
    "wind": _wind, "turn": _turn, "act": _act, "brake": _brake,
}  # fmt: skip


def _whole(p: Plan) -> None:
    """Complete a plan: pulleys turn, pendulums hang. Raises `UnknownSystem` where a part has no place."""
    for rope, drum in (*p.over.items(), *p.wound.items()):
        if drum not in p.rotors:
            p.rotors.append(drum)
        if len(p.ends.get(rope, ())) != (2 if rope in p.over else 1):
            raise UnknownSystem(rope)
    links = {h.link for h in p.hinges.values()} - {""}
    for key, thing in p.setup.things.items():
        if thing.kind in MOVING and key not in {*p.placed, *links, *p.turning}:
            if thing.kind != "pendulum" or (p.hinges and not links):
                raise UnknownSystem(key)
            if not p.hinges:
                p.hinges[key] = Hinge(GROUND)
        elif not _joined(p, thing, links):
            raise UnknownSystem(key)
    if not p.placed or len(p.placed) != len(set(p.placed)) or _rubs(p):
        raise UnknownSystem("nothing is placed, or there is friction")


_RUBS = re.compile(r"\bfriction coefficient|\bcoefficients? of (?:\w+ ){0,3}friction|\brough\b")
_STICKY = "hinge|pin|pivot|joint|bearing|axle"
_TOUGH = re.compile(rf"\bviscous\b[^.,;]*\b(?:{_STICKY})|\b(?:{_STICKY})s?\b[^.,;]*\bviscous\b")


def _rubs(p: Plan) -> bool:
    """Return whether there is friction besides dampers: on what slides, or in a hinge."""
    text, slides = p.setup.text, any(not g.rolls for g in p.guides.values())
    damped = p.braked or p.of_kind(p.springs, "damper", "buffer")
    return bool(
        (slides and _RUBS.search(text))
        or _TOUGH.search(text)
        or (re.search(r"\bviscous\b", text) and not damped)
    )


def _joined(p: Plan, thing: Thing, links: Iterable[str]) -> bool:
    """Return whether a spring, damper or string has its ends."""
    heavy = thing.adjectives & {"heavy", "massive"} or p.setup.size(thing.key, "mass") is not None
    if thing.kind in {"string", "spring"} and heavy:
        return False
    if thing.kind in {"spring", "damper", "twist"}:
        return thing.key in p.springs
    return thing.kind != "string" or thing.key in {*links, *p.over, *p.wound}
