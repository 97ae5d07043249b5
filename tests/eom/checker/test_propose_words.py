"""Drafts of lexica: what a note says of its symbols goes before what a preset says of them."""

import eom
from eom.checker.infer.draft import propose
from eom.checker.read.documents import read_document

NOTE = r"""
The direction cosine matrix $[C]$ maps components in $\mathcal{N}$ to components in $\mathcal{B}$,
and $\boldsymbol{\omega}_{\mathcal{B}/\mathcal{N}}$ is not used here.
The angular velocity of the body is $\mathbf{q}$.

$$[\dot{C}] = -[\tilde{\mathbf{q}}][C]$$

$$[\dot{C}] = [\tilde{\mathbf{q}}][C]$$
"""


def test_words_of_the_note_go_before_the_preset():
    found = propose(read_document(NOTE))
    assert found.preset == "schaub-junkins"
    assert [(d.latex, d.meaning) for d in found.drafts] == [(r"\mathbf{q}", "angular_velocity B I")]
    assert [f.verdict for f in eom.check(NOTE).faults] == ["wrong"]


def test_what_a_preset_says_more_closely_stays():
    text = NOTE.replace(
        "angular velocity of the body is $\\mathbf{q}$", "angular velocity is $\\omega_1$"
    )
    text += r" The angular momentum is $\mathbf{H}_{O}$, the kinetic energy $T_{rot}$,"
    text += " the mass of the body is $m$."
    drafts = {d.latex for d in propose(read_document(text)).drafts}
    assert not drafts & {r"\mathbf{H}_{O}", "T_{rot}", "m"}
