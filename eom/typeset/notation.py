"""The notations of the lectures, of Kasdin and Paley, of Hughes, and of Kane, as tables.

``arrow``: arrows and tildes, R from the inertial origin and r from the centre of mass.
``superscript``: frames to the upper left, points after a stroke (Kasdin, Paley: Engineering Dynamics).
``underline``: underlined vectors, bullet and circle for the derivatives in I and B, columns in bold
(Hughes: Spacecraft Attitude Dynamics; de Ruiter, Damaren, Forbes: Spacecraft Dynamics and Control).
``kane``: frames and points as superscripts on both sides (Kane, Levinson: Dynamics).
``PLAIN`` is for messages: ASCII, every frame spelt out.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from eom.errors import unknown_name
from eom.terms.terms import COLUMN, DYADIC, MATRIX, SCALAR, VECTOR, Term
from eom.typeset.boxes import (
    Accent,
    Box,
    Fence,
    Operator,
    Row,
    Scripts,
    Symbol,
    accented,
    joined,
    nucleus,
    raised,
    row,
    symbol,
)
from eom.typeset.letters import Notation, Nucleus, Written, letter_box, quantity_box
from eom.typeset.writing import (
    ATOM,
    JUXTAPOSED,
    Writer,
    equation_parts,
    is_inertial,
    peel,
    rate,
    term_box,
    write,
    write_equation,
)

__all__ = [
    "NOTATIONS",
    "PLAIN",
    "Notation",
    "equation_parts",
    "notation_named",
    "term_box",
    "write",
    "write_equation",
]

ELEMENT = Row((Operator("d"), Symbol("m")))
_NAMES = ("arrow", "superscript", "underline", "kane", "plain")


def _letters(column: int) -> dict[str, str]:
    return {name: words.split()[column] for name, words in LETTERS.items()}


LETTERS: dict[str, str] = {
    "mass": "m m m m m",
    "force": "F F f F f",
    "internal_force": "F F f F f",
    "constraint_force": "N N N N N",
    "applied_force": "K K K K K",
    "identity": "1 U 1 U 1",
    "identity_matrix": "1 1 1 1 1",
    "angle": "theta theta theta theta theta",
    "exhaust_velocity": "u u u u u",
    "gravity": "g g g g g",
    "gravity_parameter": "mu mu mu mu mu",
    "orbit_radius": "R R R R R",
    "orbit_direction": "u u u u u",
    "orbit_position": "R_c R_c R_c R_c R_c",
    "gravity_torque": "tau_g M_g tau_g M_g tau_g",
    "gravity_energy": "V_g V_g V_g V_g V_g",
    "turn_angle": "theta theta theta theta theta",
    "free_angle": "theta theta theta theta theta",
    "principal_angle": "Phi Phi Phi Phi Phi",
    "principal_axis": "e k a lambda e",
    "euler_parameter": "beta q q epsilon beta",
    "euler_vector": "beta q q epsilon beta",
    "rodrigues": "q rho p rho q",
    "modified_rodrigues": "sigma sigma sigma sigma sigma",
    "shadow_rodrigues": "sigma^S sigma^S sigma^S sigma^S sigma^S",
    "scalar": "s s s s s",
    "coordinate": "q q q q q",
    "function": "f f f f f",
    "vector": "v v v v v",
    "fixed_vector": "v v v v v",
    "dyadic": "D D D D D",
    "rotor_axis": "a a a a a",
    "rotor_speed": "Omega Omega Omega Omega Omega",
    "rotor_inertia": "I_s I_s I_s I_s I_s",
    "rotor_momentum": "H h h H h",
    "rotor_torque": "tau_a M_a tau_a M_a tau_a",
    "slug_momentum": "H_s h_s h_s H_s h_s",
    "slug_inertia": "J_s J_s J_s J_s J_s",
    "slug_damping": "c c c c c",
    "total_mass": "M m m m m",
    "linear_momentum": "p p p L p",
    "external_force": "F_ext F_ext f_ext R f_ext",
    "first_moment": "c c c S c",
    "absolute_angular_momentum": "H^abs h^abs H H^abs H",
    "angular_momentum": "H h h H h",
    "torque": "tau M tau M tau",
    "weight": "W W W W W",
    "weight_torque": "tau_W M_W tau_W M_W tau_W",
    "weight_energy": "V V V V V",
    "reaction": "N N N N N",
    "reaction_torque": "tau_N M_N tau_N M_N tau_N",
    "kinetic_energy": "T T T K T",
    "rotational_energy": "T_rot T_rot T_rot K_rot T_rot",
    "inertia": "I I J I J",
    "position": "r r r p r",
    "angular_velocity": "omega omega omega omega omega",
    "rotation": "C C C C C",
    "eigenvectors": "E E E E E",
    "unit": "b b b b b",
}
"""The letter of each quantity: arrow, superscript, underline, kane, plain."""


# -- points, frames, nuclei ----------------------------------------------------------------------


def _points(special: Mapping[str, Box]) -> Callable[[str], Box]:
    """Return how points are written: OA is the origin O of A."""
    named = {"OI": Scripts(Symbol("O"), Symbol("I")), "dm": ELEMENT, **special}

    def point(label: str) -> Box:
        if label in named:
            return named[label]
        split = len(label) == 2 and label[0] == "O"
        return Scripts(Symbol("O"), Symbol(label[1])) if split else symbol(label)

    return point


def _frames(special: Mapping[str, str], style: str = "") -> Callable[[str], Box]:
    """Return how frames are written, some by other letters than their label."""
    if style:
        return lambda label: Symbol(special.get(label, label), style)
    return lambda label: symbol(special.get(label, label))


def _marked(mark: str, style: str = "italic") -> Nucleus:
    return lambda letter: Accent(mark, Symbol(letter, style))


def _in(style: str) -> Nucleus:
    return lambda letter: Symbol(letter, style)


def _bracketed(letter: str) -> Box:
    return Fence(nucleus(letter), "[")


def _over(notation: Notation, of: str, origin: str) -> Box:
    return Row((notation.point(of), Operator("slash"), notation.point(origin)))


# -- quantities that a notation writes in its own way ----------------------------------------------


def _unit(letters: Mapping[str, str], nucleus_of: Nucleus) -> Callable[..., Box]:
    def box(_: Notation, frame: str, axis: str) -> Box:
        return Scripts(nucleus_of(letters.get(frame, frame.lower())), Symbol(axis))

    return box


def _absolute(absolute: Callable[..., Box], relative: Callable[..., Box]) -> Callable[..., Box]:
    """About the inertial origin both angular momenta are one."""
    return lambda n, who, about: (relative if about == "OI" else absolute)(n, who, about)


def _generic(name: str, kind: str) -> Callable[..., Box]:
    return lambda notation, *labels: quantity_box(notation, name, labels, kind)


def _short_position(letters: Mapping[str, str]) -> Callable[..., Box]:
    """Return the rule for positions whose letter says from where: {origin: letter}."""

    def box(notation: Notation, of: str, origin: str) -> Box:
        if origin not in letters:
            return letter_box(notation, "r", VECTOR, [_over(notation, of, origin)])
        sub = None if of in {"P", "dm"} else notation.point(of)
        return letter_box(notation, letters[origin], VECTOR, [sub])

    return box


def _frames_below(notation: Notation, frame: str, base: str) -> Box:
    """Omega; frames are shown unless it is that of B in I."""
    both = Row((notation.frame(frame), Operator("slash"), notation.frame(base)))
    return letter_box(notation, "omega", VECTOR, [None if (frame, base) == ("B", "I") else both])


def _frames_around(notation: Notation, frame: str, base: str) -> Box:
    return Scripts(
        notation.nuclei[VECTOR]("omega"), sup=notation.frame(frame), left=notation.frame(base)
    )


def _rotation_below(notation: Notation, to: str, of: str) -> Box:
    return letter_box(notation, "C", MATRIX, [notation.frame(to), notation.frame(of)])


def _rotation_around(notation: Notation, to: str, of: str) -> Box:
    return Scripts(Symbol("C"), sup=notation.frame(of), left=notation.frame(to))


def _momentum_in(name: str, frame: str = "I") -> Callable[..., Box]:
    """Return a momentum with its frame to the upper left."""

    def box(notation: Notation, who: str, about: str = "") -> Box:
        plain = quantity_box(notation, name, (who, about) if about else (who,), VECTOR)
        if isinstance(plain, Scripts):
            return replace(plain, left=notation.frame(frame))
        return Scripts(plain, left=notation.frame(frame))

    return box


def _hughes_inertia(_: Notation, about: str) -> Box:
    """J, and I about the centre of mass; the point O goes without saying."""
    letter = Accent("underline", Symbol("I" if about == "C" else "J", "blackboard"))
    return letter if about in {"C", "O"} else Scripts(letter, NOTATIONS["underline"].point(about))


def _kane_owner(who: str) -> Box:
    owner = {"body": "B", "system": "S", "P": "P", "dm": "P"}
    return Symbol(owner[who]) if who in owner else Scripts(Symbol("P"), symbol(who))


def _kane(name: str, in_frame: bool = True) -> Callable[..., Box]:
    """Return a quantity with its owner, and the point that it is about, as superscripts."""

    def box(notation: Notation, who: str, about: str = "") -> Box:
        letter, _, mark = notation.letters[name].partition("^")
        parts = [_kane_owner(who), notation.point(about) if about else None]
        sub = Symbol(mark, "roman") if mark else None
        left = notation.frame("I") if in_frame else None
        return Scripts(Symbol(letter, "bold"), sub, joined(parts, "slash"), left)

    return box


def _kane_position(notation: Notation, of: str, origin: str) -> Box:
    return Scripts(Symbol("p", "bold"), sup=Row((notation.point(origin), notation.point(of))))


# -- derivatives -----------------------------------------------------------------------------------


def _dots(writer: Writer, term: Term) -> Written:
    """Overdots for what is plain to differentiate, else d/dt with the frame."""
    inner, frame, times = peel(term)
    box = writer.box(inner, ATOM)
    if is_inertial(frame) and times <= 2:
        dotted = accented("dot" if times == 1 else "ddot", box)
        if dotted is not None:
            return dotted, ATOM
    return rate(writer, inner, frame, times)


def _fractions(writer: Writer, term: Term) -> Written:
    """Dots on scalars alone; every vector names the frame of its derivative."""
    return _dots(writer, term) if term.kind == SCALAR else rate(writer, *peel(term))


def _velocities(writer: Writer, term: Term) -> Written:
    """Velocity and acceleration have letters of their own (Kasdin, Paley)."""
    inner, frame, times = peel(term)
    if inner.head == "atom" and inner.data[0] == "position" and times <= 2:
        sub = _over(writer.notation, *inner.data[1:])
        return letter_box(writer.notation, " va"[times], VECTOR, [sub], frame), ATOM
    return _fractions(writer, term)


def _kane_velocities(writer: Writer, term: Term) -> Written:
    """The velocity and acceleration of P in N: derivatives from a point fixed in N."""
    inner, frame, times = peel(term)
    if (
        inner.head == "atom"
        and inner.data[::2] == ("position", "OI")
        and frame == "I"
        and times <= 2
    ):
        sup = writer.notation.point(inner.data[1])
        left = writer.notation.frame(frame)
        return Scripts(Symbol(" va"[times], "bold"), sup=sup, left=left), ATOM
    return _fractions(writer, term)


_MARKS = {"I": "bullet", "B": "circle"}


def _bullets(writer: Writer, term: Term) -> Written:
    """Bullets for the derivative in I, circles for that in B; overdots on scalars and columns."""
    inner, frame, times = peel(term)
    if not frame or frame not in _MARKS:
        return _dots(writer, term)
    marks = Row((Operator(_MARKS[frame]),) * times)
    box = writer.box(inner, ATOM)
    if inner.head == "der" and isinstance(box, Scripts) and box.sup is not None:
        return replace(box, sup=row(box.sup, marks)), ATOM
    return raised(box, marks), ATOM


def _spelt(writer: Writer, term: Term) -> Written:
    """d_I(...): the derivative as a function, for messages."""
    frame = term.data[0]
    name = Scripts(Symbol("d"), Symbol(frame)) if frame else Symbol("ddt")
    return Row((name, Fence(writer.box(term.args[0])))), JUXTAPOSED


# -- columns and tildes ----------------------------------------------------------------------------


def _in_brackets(writer: Writer, term: Term) -> Written:
    """[v]_B."""
    box, frame = writer.box(term.args[0]), writer.notation.frame(term.data[0])
    inner = box if isinstance(box, Fence) and box.opening == "[" else Fence(box, "[")
    return Scripts(inner, frame), ATOM


def _crossed(writer: Writer, term: Term) -> Written:
    """[v x]_B."""
    (a,) = term.args
    mark = Operator("cross-mark")
    if a.head == "column":
        inner = writer.box(a.args[0], ATOM)
        return Scripts(Fence(Row((inner, mark)), "["), writer.notation.frame(a.data[0])), ATOM
    return Fence(Row((writer.box(a, ATOM), mark)), "["), ATOM


def _wavy(writer: Writer, term: Term) -> Written:
    """The column with a tilde, in square brackets."""
    (a,) = term.args
    bare, frame = (a.args[0], a.data[0]) if a.head == "column" else (a, "")
    box = writer.box(bare)
    marked = Fence(accented("tilde", box) or Accent("widetilde", box), "[")
    return (Scripts(marked, writer.notation.frame(frame)) if frame else marked), ATOM


def _bold(writer: Writer, term: Term) -> Written:
    """A bold letter; the frame is shown where a statement has several, or B is not meant."""
    (a,), (frame,) = term.args, term.data
    shown = frame != "B" or len(writer.frames) > 1
    below = writer.notation.frame(frame) if shown else None
    if a.head != "atom":
        return Scripts(Fence(writer.box(a)), writer.notation.frame(frame)), ATOM
    box = _unmarked(writer.box(a))
    if below is None:
        return box, ATOM
    if isinstance(box, Scripts):
        return replace(box, sub=joined([box.sub, below])), ATOM
    return Scripts(box, below), ATOM


def _unmarked(box: Box) -> Box:
    """Return the bold letter of an underlined one."""
    if isinstance(box, Scripts):
        return replace(box, base=_unmarked(box.base))
    if isinstance(box, Row):
        return Row(tuple(_unmarked(b) for b in box.items))
    return Symbol(box.base.name, "bold") if _is_marked_letter(box) else box  # type: ignore[union-attr]


def _is_marked_letter(box: Box) -> bool:
    return isinstance(box, Accent) and isinstance(box.base, Symbol)


def _raised_cross(writer: Writer, term: Term) -> Written:
    return raised(writer.box(term.args[0], ATOM), Operator("cross-mark")), ATOM


def _skew(writer: Writer, term: Term) -> Written:
    return Row((Symbol("skew"), Fence(writer.box(term.args[0])))), JUXTAPOSED


# -- the notations -----------------------------------------------------------------------------------


def _nuclei(vector: Nucleus, dyadic: Nucleus, matrix: Nucleus) -> dict[str, Nucleus]:
    return {
        SCALAR: nucleus,
        VECTOR: vector,
        DYADIC: dyadic,
        COLUMN: matrix,
        MATRIX: matrix,
    }


NOTATIONS: dict[str, Notation] = {
    "arrow": Notation(
        name="arrow",
        title="arrows and tildes (lecture 000)",
        letters=_letters(0),
        nuclei=_nuclei(_marked("vec"), _bracketed, _bracketed),
        point=_points({}),
        frame=_frames({"C": "W", "E": "U"}),
        atoms={
            "position": _short_position({"OI": "R", "C": "r", "O": "rho"}),
            "angular_velocity": _frames_below,
            "rotation": _rotation_below,
            "unit": _unit({"C": "w", "E": "u"}, _marked("hat")),
            "rotor_axis": lambda _, k: Scripts(Accent("hat", Symbol("a")), symbol(k)),
            "absolute_angular_momentum": _absolute(
                _generic("absolute_angular_momentum", VECTOR), _generic("angular_momentum", VECTOR)
            ),
        },
        derivative=_dots,
        column=_in_brackets,
        tilde=_wavy,
        domain=Symbol("B"),
        frames_outside=False,
        juxtaposed=True,
    ),
    "superscript": Notation(
        name="superscript",
        title="frames as superscripts (lecture 001; Kasdin and Paley)",
        letters=_letters(1),
        nuclei=_nuclei(_in("bold"), _in("blackboard"), _in("bold")),
        point=_points({"C": Symbol("G")}),
        frame=_frames({"E": "U"}, "calligraphic"),
        atoms={
            "position": lambda n, of, origin: letter_box(n, "r", VECTOR, [_over(n, of, origin)]),
            "angular_velocity": _frames_around,
            "rotation": _rotation_around,
            "unit": _unit({"I": "e", "E": "u"}, _in("bold")),
            "linear_momentum": _momentum_in("linear_momentum"),
            "angular_momentum": _momentum_in("angular_momentum"),
            "absolute_angular_momentum": _absolute(
                _momentum_in("absolute_angular_momentum"), _momentum_in("angular_momentum")
            ),
        },
        derivative=_velocities,
        column=_in_brackets,
        tilde=_crossed,
        domain=Symbol("B", "calligraphic"),
        outer="tensor",
    ),
    "underline": Notation(
        name="underline",
        title="underlined vectors, bullets and circles (lecture 002; Hughes, de Ruiter)",
        letters=_letters(2),
        nuclei=_nuclei(
            _marked("underline"), lambda n: Accent("underline", Symbol(n, "bold")), _in("bold")
        ),
        point=_points({"C": Operator("bullet")}),
        frame=_frames({"E": "U"}),
        atoms={
            "position": _short_position({"OI": "r", "O": "rho"}),
            "angular_velocity": _frames_below,
            "rotation": _rotation_below,
            "unit": _unit({"E": "u"}, _marked("underline")),
            "inertia": _hughes_inertia,
        },
        derivative=_bullets,
        column=_bold,
        tilde=_raised_cross,
        domain=Symbol("m"),
    ),
    "kane": Notation(
        name="kane",
        title="frames and points as superscripts (Kane and Levinson)",
        letters=_letters(3),
        nuclei=_nuclei(_in("bold"), _in("bold"), _in("bold")),
        point=_points(
            {
                "C": Scripts(Symbol("B"), sup=Operator("star")),
                "dm": Symbol("P"),
                **{i: Scripts(Symbol("P"), Symbol(i)) for i in "ijk"},
            }
        ),
        frame=_frames({"I": "N", "E": "U"}),
        atoms={
            "position": _kane_position,
            "angular_velocity": _frames_around,
            "rotation": _rotation_around,
            "unit": _unit({"I": "n", "E": "u"}, _marked("hat", "bold")),
            "linear_momentum": _kane("linear_momentum"),
            "angular_momentum": _kane("angular_momentum"),
            "absolute_angular_momentum": _absolute(
                _kane("absolute_angular_momentum"), _kane("angular_momentum")
            ),
            "first_moment": _kane("first_moment", in_frame=False),
            "torque": _kane("torque", in_frame=False),
            "inertia": lambda n, about: _kane("inertia", in_frame=False)(n, "body", about),
        },
        derivative=_kane_velocities,
        column=_in_brackets,
        tilde=_crossed,
        domain=Symbol("B"),
        frames_outside=False,
    ),
}

PLAIN = Notation(
    name="plain",
    title="ASCII, for messages",
    letters=_letters(4),
    nuclei=_nuclei(*(Symbol,) * 3),
    point=Symbol,
    frame=Symbol,
    atoms={
        "position": lambda n, of, origin: letter_box(n, "r", VECTOR, [_over(n, of, origin)]),
        "angular_velocity": lambda n, b, a: letter_box(n, "omega", VECTOR, [_over(n, b, a)]),
        "rotation": lambda n, b, a: letter_box(n, "C", MATRIX, [Symbol(b + a)]),
        "unit": _unit({}, Symbol),
    },
    derivative=_spelt,
    column=_in_brackets,
    tilde=_skew,
    domain=Symbol("body"),
    markup="ascii",
)

ALIASES: dict[str, str] = {
    "vec": "arrow",
    "tilde": "arrow",
    "000": "arrow",
    "kasdin-paley": "superscript",
    "001": "superscript",
    "hughes": "underline",
    "de-ruiter": "underline",
    "002": "underline",
    "levinson": "kane",
}
"""Other names of the notations."""


def notation_named(name: str) -> Notation:
    """Return a notation by its name or an alias. Raises `InputError` for other names."""
    name = ALIASES.get(name, name)
    if name not in NOTATIONS:
        raise unknown_name("notation", name, NOTATIONS)
    return NOTATIONS[name]
