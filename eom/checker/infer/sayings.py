r"""What the sentences of a note say of its symbols: "$H$ is the angular momentum about $O$".

Formulas of the text become marks with a number, ``⟦3⟧``; a list of symbols one mark for each. A sentence is
parted at the symbols that something is said of: ``LIST verb words``, ``LIST, the words`` behind such a
part ("$H$ is the momentum, $T$ the energy"), ``words LIST`` ("a body of mass $m$"), ``words is called
LIST``.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from eom.checker.read.documents import Document
from eom.checker.read.statements import Formula, Statement, read
from eom.checker.read.symbol_shape import Look, Seen, called_symbol, seen
from eom.checker.read.syntax import Group, Marks, Node, Product, Quotient, Scripts, Symbol, Words
from eom.checker.read.syntax import Sequence as Items

MARK = r"⟦\d+⟧"
BREAK = "‡"
MAX_NOUN, MAX_WORDS = 200, 1000
"""Characters before symbols, and of what is said of them, that are read."""
LIST = rf"{MARK}(?:(?:\s*,\s*(?:and |or |then )?|\s+and\s+|\s+or\s+|\s*/\s*){MARK}){{0,20}}"
_VERB = (
    r"(?:is|are|be|was|were|denotes?|means?|stands?\s+for|represents?|designates?|signif(?:y|ies)|names?|"
    r"takes?|maps?|turns?|leads?|"
    r"points?|carries|transforms?|runs?)"
)
_ADVERB = r"(?:(?:itself|here|again|now|then|both|respectively|always|shall|will|also)\s+)*"
_HEAD = re.compile(
    rf"(?P<of>{LIST})\s*,?\s+(?:{_ADVERB}(?P<verb>{_VERB})\b|(?P<article>the|its|their|an?|that|any|another)\b)"
)
_OBJECT = re.compile(
    r"\b(?:(?:of|about|to|in|for|by|on|from|between|at)\s+(?:[a-z]+\s+){0,3}"
    r"|components?|angles)\s*$"
)
"""Words before a list of symbols that make it the object of what is said."""
_CALLED = re.compile(
    rf"(?P<what>(?<![^,;()\s])[^,;()]{{0,200}}?)\s+(?:(?:is|are|be)\s+(?:\w+\s+)?)?(?:called|denoted(?:\s+by)?|written(?:\s+as)?|"
    rf"named|abbreviated(?:\s+as)?|(?:defined|given|expressed)(?:\s+(?:as|by))(?:\s+follows)?:?)\s+(?P<of>{LIST})"
)
_BEFORE = re.compile(
    rf"(?P<what>(?<![\w’'-])(?:[\w’'-]{{1,40}}\s+){{0,8}}[\w’'-]{{1,40}})"
    rf"(?:\s+(?P<of>{LIST})|,\s+(?P<within>{LIST})(?=\s*[,)]))"
)
_END = re.compile(rf"(?<=[.;:!?])\s+|{BREAK}|\n\s*\n")


@dataclass(frozen=True)
class Mention:
    """A symbol in the text: its look, its formula, its line, and whether it begins a display."""

    look: Look
    node: Node
    line: int
    shown: bool = False


@dataclass(frozen=True)
class Said:
    """Symbols, what is said of them, the sentence, and whether the words stand ``before`` them.

    ``behind``: the words behind symbols that follow theirs, up to the next mark of punctuation; marks in
    words are mentions by their numbers.
    """

    of: tuple[Mention, ...]
    words: str
    sentence: str
    before: bool = False
    behind: str = ""
    start: int = 0


_WORD = re.compile(r"[A-Za-z]{3}")
_WORDY = frozenset({"prose", "heading"})


@dataclass(frozen=True)
class Prose:
    """The sentences of a note with marks for formulas, the mentions, and formulas that define letters.

    ``cases``: formulas of sentences about a special case, with their lines; ``has_words``: whether words
    stand outside of its formulas.
    """

    sentences: tuple[str, ...]
    mentions: tuple[Mention, ...]
    formulas: tuple[Statement, ...]
    lines: tuple[int, ...]
    cases: tuple[tuple[Statement, int], ...] = ()
    has_words: bool = True

    def shown(self, words: str) -> str:
        """Return words with the letters of symbols in the place of marks."""
        shown = re.sub(r"⟦(\d+)⟧", lambda m: self.mentions[int(m[1])].look.text, words)
        return re.sub(r"\s+", " ", shown).strip(" ,.;:()")

    def marked(self, words: str) -> tuple[Mention, ...]:
        """Return the mentions of a text."""
        return tuple(self.mentions[int(n)] for n in re.findall(r"⟦(\d+)⟧", words))


def prose(document: Document) -> Prose:
    """Return the text of a document with marks for the symbols in it."""
    inline = {id(f.piece): f for f in read(document)}
    shown = {k: f for k, f in inline.items() if f.piece.kind == "display"}
    mentions: list[Mention] = []
    formulas: list[tuple[Statement, int]] = []
    cases: list[tuple[Statement, int]] = []
    text: list[str] = []
    for piece in document.pieces:
        if piece.kind == "prose":
            text.append(_plain(piece.body))
        elif piece.kind != "inline":
            so_far = "".join(text)
            start = max(0, len(so_far) - MAX_SENTENCE)
            led = _LED.search(_END.split(text[-1].rstrip())[-1]) if text else None
            taken = next((m for p in _LEADING if (m := p.search(so_far, start))), None)
            led = None if taken and MARKS.search(taken["what"]) else led
            taken = None if led else taken
            left = _left(shown.get(id(piece)), mentions) if led else ""
            what = _left(shown.get(id(piece)), mentions) if taken else ""
            if left:
                text[-1] = text[-1].rstrip().rstrip(":,")
            elif taken and what:
                text = [f"{so_far[: taken.start('what')]}{BREAK}{what} is the {taken['what']}."]
            text.append(f"{left}{BREAK}{_glosses(shown.get(id(piece)), mentions)}")
        elif (formula := inline.get(id(piece))) is not None:
            lead = _END.split("".join(text[-3:]))[-1]
            text.append(_marks(formula, mentions, cases if CASE.search(lead) else formulas))
    whole = _ROW.sub(_told, _LISTED.sub(_spelt_out, "".join(text)))
    whole = re.sub(r"[ \t]*\n(?![ \t]*\n)[ \t]*", " ", whole)
    sentences = tuple(part for s in _END.split(whole) if s.strip() for part in _bounded(s))
    return Prose(
        sentences,
        tuple(mentions),
        tuple(s for s, _ in formulas),
        tuple(n for _, n in formulas),
        tuple(cases),
        any(_WORD.search(_plain(p.body)) for p in document.pieces if p.kind in _WORDY),
    )


MAX_SENTENCE = 2000
"""Characters of a sentence; a longer one is read in parts: what ends nowhere is no sentence."""


def _bounded(sentence: str) -> Iterator[str]:
    """Yield a sentence, or parts of one without an end, divided between words."""
    words = re.sub(r"\s+", " ", sentence.strip())
    while len(words) > MAX_SENTENCE:
        cut = words.rfind(" ", 0, MAX_SENTENCE) + 1 or MAX_SENTENCE
        yield words[:cut].strip()
        words = words[cut:]
    if words.strip():
        yield words.strip()


_LISTED = re.compile(rf"((?:^|[.;,:\n]|- )\s*)({LIST})\s*:\s+(?:the |an? )?(?=[a-z])")
"""A letter in a list of such, with what it is behind a colon."""


_ROW = re.compile(
    rf"^[ \t]*\|\s*({LIST})\s*\|\s*(?:the |an? )?([a-z][^|\n]*?)\s*\|[^\n]*$", re.MULTILINE
)
"""A row of a table: a letter, and in the next column what it is."""


def _told(match: re.Match[str]) -> str:
    """Return a row of a table as a sentence."""
    several = match[1].count("⟦") > 1
    return f"{BREAK}{match[1]} {'are' if several else 'is'} the {match[2]}.{BREAK}"


def _spelt_out(match: re.Match[str]) -> str:
    """Return an item of a list of letters as a sentence."""
    several = match[2].count("⟦") > 1
    return f"{match[1]}{match[2]} {'are' if several else 'is'} the "


CASE = re.compile(
    r"^(?:finally|for a(?!n? point)|in the case)\b"
    r"|\b(?:if|when|suppose|assum\w+|unless|because|in which case)\b",
    re.IGNORECASE,
)
"""Words of a sentence that is about a special case."""
MARKED = "any symbol with a mark"
"""The letter of a mention that is about a mark: of a derivative, as a rule."""
_MARK = re.compile(
    r"(?:\\?\(\s*\\[cb]?dot\s*\\?\)|\\(?:cdot|square|bullet))\s*(?:\^\s*\{?\\?(bullet|circ|prime|star|ast)\}?|')$"
)


def _plain(body: str) -> str:
    return re.sub(r"\\\w+|[*_`{}\\~#$]", " ", body)


def _marks(formula: Formula, mentions: list[Mention], formulas: list[tuple[Statement, int]]) -> str:
    """Return what stands for a formula: marks of symbols, or a word that is none."""
    line = formula.piece.line
    mark = _MARK.match(formula.piece.body.strip())
    if mark is not None and formula.reading is not None:
        name = mark[1] or "prime"
        mentions.append(Mention(Look(MARKED, sup=(name,)), formula.reading.tree, line))
        return f"⟦{len(mentions) - 1}⟧"
    nodes: list[Node] = []
    for statement in formula.statements:
        if statement.relational and len(statement.members) > 1:
            formulas.append((statement, line))
            nodes += _compared(statement)
        else:
            nodes += [i for m in statement.members for i in _items(m)]
    marks = []
    for node in nodes:
        look = look_of(node)
        if look is not None:
            marks.append(f"⟦{len(mentions)}⟧")
            mentions.append(Mention(look, node, line))
    return ", ".join(marks) if marks else "…"


def _compared(statement: Statement) -> list[Node]:
    """Return what a relation is about: its left side, letters on both sides of "greater than"."""
    larger = {g.name for g in statement.signs} <= {"<", ">", "lt", "gt"}
    letters = larger and all(look_of(m) is not None for m in statement.members)
    return list(statement.members) if letters else [statement.members[0]]


_LED = re.compile(
    r"\b(?:is|are|be|reads?|(?:defined|given|expressed)\s+(?:as|by)(?:\s+follows)?)\s*[:,]?\s*$"
    r"|\b(?:is|are)\s+(?:the|an?)\s+(?:[\w-]+\s+){1,8}[\w-]+,\s*$"
    r"|^\s*for\s+the\s+[^,;:]*\b(?:one|we)\s+(?:finds?|gets?|has|have|obtains?|writes?)\s*:?\s*$"
    r"|^\s*(?:and|while)\s+(?:the|its|their)\s+(?:[\w-]+\s+){0,6}[\w-]+\s*,?\s*$",
    re.IGNORECASE,
)
"""The end of words that say what the left side of the display behind them is."""


_TAKEN = re.compile(
    r"(?:^|(?<=[.!?\n‡])\s*)(?:[Nn]ow,?\s+)?[Tt]ake\s+the\s+(?P<what>[^.;:!?\n‡]+)[.:]\s*\Z"
)
"""A sentence of its own that says what the left side of the display behind it is: "Take the momentum."."""
_APPOSED = re.compile(
    r"(?:^|[.!?;,:‡]|\n\s*\n|\b(?:and|then|hence|so|has|have|gets?|obtains?|finds?|writes?|defines?|introduces?))"
    rf"\s+(?:[Tt]he|[Ii]ts|[Tt]heir)\s+(?P<what>(?:[\w-]+\s+){{0,8}}?(?:[\w-]+|{MARK}))"
    r"(?P<verb>\s+(?:is|are|reads?|becomes?))?\s*[:,]?\s*\Z"
)
"""The end of words that name the left side of the display behind them: "... and the momentum about $O$"."""

_TITLED = re.compile(
    rf"(?:^|[.!?‡]|\n\s*\n)\s*(?P<what>[A-Z](?:[\w-]*\s+){{1,8}}?(?:[\w-]+|{MARK}))\s*:\s*\Z"
)
"""A sentence without a verb in front of a colon and a display: "Total momentum about $C$:"."""


_DEFINES = re.compile(
    r"(?:\A|(?<=[.!?\n‡]))[^.!?\n‡]*\b(?:[Ww]e|[Oo]ne)\s+(?:define|introduce)s?\s+(?:the\s+)?"
    r"(?P<what>[^.,;:!?\n‡]*?)\s*"
    r"(?:,?\s*and\s+[^.;:!?‡]*?)?,?\s*(?:as\s+follows|as|by)\s*:?\s*\Z"
)
"""A sentence that says what the display behind it defines: "We define the momentum as follows:"."""
_LEADING = (_TAKEN, _DEFINES, _APPOSED, _TITLED)


def _left(formula: Formula | None, mentions: list[Mention]) -> str:
    """Return the mark of a symbol that stands alone on the left of a display, which words lead to."""
    first = next((s for s in formula.statements if s.relational), None) if formula else None
    node = first.members[0] if first is not None and len(first.members) > 1 else None
    given = seen(node) if node is not None else None
    look = look_of(node) if node is not None else None
    if formula is None or node is None or look is None or given is None or given.dots:
        return ""
    if given.raised and look == given.look:
        return ""
    mentions.append(Mention(look, node, formula.piece.line, shown=True))
    return f" ⟦{len(mentions) - 1}⟧"


def _glosses(formula: Formula | None, mentions: list[Mention]) -> str:
    """Return the sentences within a display that say what a symbol is: one alone, with words behind it."""
    found = ""
    for one in formula.statements if formula is not None else ():
        look = look_of(one.members[0]) if len(one.members) == 1 else None
        if look is not None and not one.relational and len(one.words) == 1:
            mentions.append(Mention(look, one.members[0], formula.piece.line if formula else 0))
            found += f"⟦{len(mentions) - 1}⟧ {one.words[0].rstrip(' .:;,')}.{BREAK}"
    return found


def _items(node: Node) -> tuple[Node, ...]:
    if isinstance(node, Group) and isinstance(node.body, Items):
        return node.body.items
    return node.items if isinstance(node, Items) else (node,)


def look_of(node: Node) -> Look | None:
    """Return the look of a symbol, dots left out, with a raised label where it is one."""
    if isinstance(node, Group) and node.open == "[":
        node = node.body
    found = seen(called_symbol(node)) or _called(node)
    if found is None:
        return None
    raised = found.raised[0] if found.raised else None
    return found.with_label() if _is_label(raised) else found.look


def _is_label(raised: Node | None) -> bool:
    """Return whether what is raised is a label: no power, no transpose."""
    if isinstance(raised, Symbol):
        return raised.name not in {"T", "top", "t", "intercal", "n"}
    return isinstance(raised, Marks | Quotient | Words | Scripts | Items)


def _called(node: Node) -> Seen | None:
    if not isinstance(node, Product) or len(node.factors) != 2:
        return None
    first, behind = node.factors
    return seen(first) if isinstance(behind, Group) and behind.open == "(" else None


def said(text: Prose) -> Iterator[Said]:
    """Yield what is said of symbols, sentence by sentence."""
    for sentence in text.sentences:
        heads, told = _heads(sentence), ""
        for k, (_, end, of, verb) in enumerate(heads):
            stop = heads[k + 1][0] if k + 1 < len(heads) else len(sentence)
            words = verb + _TAIL.sub("", sentence[end : min(stop, end + MAX_WORDS)].strip())
            words = _ANOTHER.sub(f"another {_KIND.sub('', told)}", words) if told else words
            told = words
            yield Said(text.marked(of), words, sentence, start=heads[k][0])
        yield from _equated(text, sentence)
        yield from _enumerated(text, sentence)
        yield from _measured(text, sentence)
        for match in _CALLED.finditer(sentence):
            whole = re.sub(r"^\s*(?:and|where|while|with)\s+", "", match["what"])
            yield Said(text.marked(match["of"]), whole, sentence, start=match.start())
            yield Said(text.marked(match["of"]), match["what"], sentence, before=True)
        for match in _BEFORE.finditer(sentence):
            if match["within"] and _PREDICATE.match(match["what"]):
                continue
            behind = re.split(r"[,;.:()]", sentence[match.end() :])[0].strip()
            named = text.marked(match["of"] or match["within"])
            yield Said(named, match["what"].strip(), sentence, True, behind, match.start())
        for match in _ABOUT.finditer(sentence):
            words = re.sub(r"^.*\bfor\s+", "", match["what"])
            yield Said(text.marked(match["of"]), words, sentence, start=match.start())


_ABOUT = re.compile(
    rf"\b(?P<what>(?:[a-z]+\s+){{1,3}}about\s+(?:the\s+)?(?:point\s+)?{MARK})\s*,\s+"
    rf"(?P<of>{MARK})(?=\s*(?:[,:.)]|$))"
)
"""What is taken about a point, with its symbol behind a comma: "the torque about $O$, $M_O$:"."""


def _equated(text: Prose, sentence: str) -> Iterator[Said]:
    """Yield what stands before "is": "the place of $dm$ from $O$ is $r$, that of $P$ is $p$"."""
    noun = ""
    for match in _IS.finditer(sentence):
        what = _WHOSE.split(_NEXT.split(match["what"])[-1])[-1]
        if _THAT.match(what):
            what = _THAT.sub(f"{noun} of ", what) if noun else ""
        noun = re.split(r"\s+of\b", what)[0]
        if MARKS.search(what) and not _NAMED.search(what):
            yield Said(text.marked(match["of"]), what, sentence, start=match.start())


def _measured(text: Prose, sentence: str) -> Iterator[Said]:
    """Yield where particles are, and from where that is measured: "masses at $r_i$, measured from $O$"."""
    for match in _AT.finditer(sentence):
        words = f"position vector from {match['start'] or 'the inertial origin'}"
        yield Said(text.marked(match["of"]), words, sentence, start=match.start())


_AT = re.compile(
    rf"\b(?:particles?|masses|mass points?|point mass(?:es)?|elements?)\b[^.;:]{{0,80}}\bat\s+"
    rf"(?:(?:the\s+)?(?:position|place|point)s?\s+)?(?P<of>{MARK})"
    rf"(?:\s*,?\s+(?:(?:measured|counted|reckoned|taken|seen)\s+)?(?:from|relative to|with respect to)\s+"
    rf"(?:the\s+)?(?:point\s+)?(?P<start>{MARK})|\s*\([^()]*\borigin\b[^()]*\)|(?=\s*[.,;:]|\s*$))"
)


def _enumerated(text: Prose, sentence: str) -> Iterator[Said]:
    """Yield what follows symbols in a list of such without a verb: "$m$ mass of the rod, $l$ length"."""
    items = _ITEM.findall(f", {sentence}"[: MAX_WORDS * 2])
    for of, words in items if len(items) > 1 else ():
        yield Said(text.marked(of), words.strip(), sentence)


MARKS = re.compile(MARK)
_NAMED = re.compile(
    rf"(?<!\bof )(?<!\bfrom )(?<!\babout )(?<!\bto )(?<!\bin )(?<!\bat )(?<!\bfor )"
    rf"(?<!\bpoint )(?<!\bframe ){MARK}\s*$"
)
"""A symbol behind its noun: words for the one that stands there."""
_IS = re.compile(
    rf"\b(?P<what>(?:the|its|their|that|those)\s(?:(?!\b(?:is|are|be)\b)[^.;:]){{3,150}}?)\s+(?:is|are|be)\s+"
    rf"(?P<of>{LIST})(?=\s*[,.;)]|\s+and\b|\s*$)",
    re.IGNORECASE,
)
_NEXT = re.compile(r",\s*(?:and\s+)?(?=(?:the|its|their|that|those|an?)\b)|;")
_WHOSE = re.compile(r",?\s*\b(?:whose|with)\s+")
_THAT = re.compile(r"(?:that|those)\s+of\s+", re.IGNORECASE)
_ITEM = re.compile(
    rf"[,;]\s*(?:and\s+)?({LIST})\s+"
    r"(?!(?:is|are|be|was|and|or|the|an?|its|their|for|of|in|on|by|to|from|with|which|that|as|at|we|so)\b)"
    r"([a-z][^,;⟦]*)(?=[,;.]|$)"
)
"""An item of a list of symbols, with what it is behind it."""
_ANOTHER = re.compile(r"^another(?: one)?(?: of them)?$")
_KIND = re.compile(r"^(?:an?|the|another)\s+")
"""What is said of a second one ("another one") is what is said of the first."""
_EQUATES = re.compile(
    r"is|are|be|was|were|denotes?|means?|stands?\s+for|represents?|names?|designates?|signif(?:y|ies)"
)
"""Verbs behind which stands what symbols are."""
_PREDICATE = re.compile(r"(?:is|are|be|was|were)\b")
"""What begins so is said of the symbols in front of it, and not of those behind a comma."""
_TAIL = re.compile(r"(?:[\s,]+(?:and|or|while|where|with|but))*[\s,.]*$")


def _heads(sentence: str) -> list[tuple[int, int, str, str]]:
    """Return where something begins to be said of symbols: start, end, their marks, what the verb says."""
    found: list[tuple[int, int, str, str]] = []
    for match in _HEAD.finditer(sentence):
        start, of, article = match.start(), match["of"], match["article"] or ""
        apposed = article in {"a", "an"} and "," in match[0][len(of) :]
        if _OBJECT.search(sentence[max(0, start - MAX_NOUN) : start]):
            last = re.search(rf"{'' if apposed else '(?:,|and)'}\s*({MARK})$", of)
            if last is None:
                continue
            start, of = start + last.start(1), last[1]
        named = apposed or _named(match[0][len(match["of"]) :], sentence, match.end())
        before = sentence[max(0, start - MAX_NOUN) : start]
        if article and not (named or _begins(before, match[0], bool(found))):
            continue
        verb = match["verb"] or ""
        last = re.search(rf"(?:,|and)\s*({MARK})$", of) if verb in {"is", "was"} else None
        if last is not None:
            start, of = start + last.start(1), last[1]
        says = "" if _EQUATES.fullmatch(verb) else f"{verb} "
        found.append((start, match.end(), of, says if verb else f"{article} "))
    return found


_VERBS = re.compile(r"\b(?:is|are|be|has|have|we|one|follows?|reads?|becomes?|gives?|obeys?|⟦)")
_APPOSED = re.compile(r"[^,;:.()]{3,80}(?=,)")


def _named(article: str, sentence: str, end: int) -> bool:
    """Return whether a noun with an article stands between commas behind symbols: ", the momentum, "."""
    match = _APPOSED.match(sentence, end) if article.lstrip().startswith(",") else None
    return match is not None and _VERBS.search(match[0]) is None


def _begins(before: str, here: str, later: bool) -> bool:
    """Return whether symbols with an article behind them begin something: behind a comma, or with one."""
    before = before.rstrip()
    opened = (
        not before or before[-1] in ",;(" or before.endswith((" and", " where", " with", " while"))
    )
    return opened and (later or "," in here)
