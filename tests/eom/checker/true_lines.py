"""True lines of mechanics in several notations, each note with its lexicon; some need assumptions.

After the books that the presets name; `test_explaining` holds that each is true.
"""

from eom.checker.mean.lexicon_files import parse_lexicon

ARROWS = parse_lexicon(
    r"""
preset = 'arrow-tilde'
[symbols]
'\vec a' = 'vector a'
'\vec b' = 'vector b'
'\vec c' = 'vector c'
'\vec H_O' = 'absolute_angular_momentum body OI'
"""
)
SUPERSCRIPTS = parse_lexicon(
    r"""
preset = 'left-superscript'
[symbols]
'\Omega' = '= \dot{\phi}'
'\mathbf{H}' = 'angular_momentum body C'
"""
)
UNDERLINES = parse_lexicon(
    r"""
preset = 'underline-bullet'
[symbols]
'\underline a' = 'vector a'
'\underline p' = 'linear_momentum system'
'\underline f' = 'external_force system'
'\underline f_{<i>}' = 'force <i>'
'\underline p_{<i>}' = 'linear_momentum <i>'
'\underline h_{<P>}' = 'angular_momentum system <P>'
'\underline \tau_{<P>}' = 'torque system <P>'
'\underline c_{<P>}' = 'first_moment system <P>'
'm' = 'total_mass system'
'\underline J_{<F>}' = 'inertia O in <F>'
"""
)
KANE = parse_lexicon("preset = 'kane'\n")
HUGHES = parse_lexicon("preset = 'hughes'\n")
SCHAUB = parse_lexicon("preset = 'schaub-junkins'\n")
PHYSICS = parse_lexicon("preset = 'physics-bold'\n")

NOTES = (
    (
        ARROWS,
        (
            r"\dot{\vec{H}}_C = \frac{^B d\vec{H}_C}{dt} + \vec{\omega} \times \vec{H}_C",
            r"[I] \dot{\vec{\omega}} = -[\tilde{\vec{\omega}}][I]\vec{\omega} + \vec{\tau}_C",
            r"\vec{H}_C = \int_B \vec{r} \times (\vec{\omega} \times \vec{r}) \, dm",
            r"\vec{H}_O = M \vec{R}_C \times \dot{\vec{R}}_C + \vec{H}_C",
            r"T = \frac{1}{2} M \dot{\vec{R}}_C \cdot \dot{\vec{R}}_C + \frac{1}{2} \vec{\omega} \cdot \vec{H}_C",
            r"\vec{a} \times (\vec{b} \times \vec{c}) = \vec{b} (\vec{a} \cdot \vec{c}) - \vec{c} (\vec{a} \cdot \vec{b})",
            r"I_{1} \dot{\omega}_1 = (I_{2} - I_{3}) \omega_2 \omega_3 + L_1",
            r"I_{3} \dot{\omega}_3 = (I_{1} - I_{2}) \omega_1 \omega_2 + L_3",
        ),
    ),
    (
        SUPERSCRIPTS,
        (
            r"{}^{\mathcal{I}}\boldsymbol{\omega}^{\mathcal{B}} = \dot{\theta} \mathbf{b}_1 + \dot{\psi} \sin\theta \mathbf{b}_2 + \dot{\psi} \cos\theta \mathbf{b}_3",
            r"{}^{\mathcal{I}}\frac{\mathrm{d}}{\mathrm{d}t}\mathbf{H} = {}^{\mathcal{B}}\frac{\mathrm{d}}{\mathrm{d}t}\mathbf{H} + {}^{\mathcal{I}}\boldsymbol{\omega}^{\mathcal{B}} \times \mathbf{H}",
            r"\mathbf{H} = I_1 \dot{\theta} \mathbf{b}_1 + I_2 (\Omega + \dot{\psi} \sin\theta) \mathbf{b}_2 + I_1 \dot{\psi} \cos\theta \mathbf{b}_3",
        ),
    ),
    (
        UNDERLINES,
        (
            r"\underline{a}^\bullet = \underline{a}^\circ + \underline{\omega} \times \underline{a}",
            r"\underline{a}^{\bullet\bullet} = \underline{a}^{\circ\circ} + 2 \underline{\omega} \times \underline{a}^\circ + \underline{\omega}^\circ \times \underline{a} + \underline{\omega} \times (\underline{\omega} \times \underline{a})",
            r"m \underline{r}_\bullet^{\bullet\bullet} = \underline{f}",
            r"\underline{h}_O = \sum_{i=1}^N m_i \underline{\rho}_i \times \underline{\rho}_i^\bullet",
            r"\underline{h}_O^\bullet = \underline{\tau}_O - \underline{c}_O \times \underline{r}_O^{\bullet\bullet}",
            r"\underline{c}_O = m (\underline{r}_\bullet - \underline{r}_O)",
            r"\underline{J}_B = \underline{C}_{BA} \underline{J}_A \underline{C}_{AB}",
            r"\underline{C}_{BA} = \underline{C}_{AB}^T",
        ),
    ),
    (
        KANE,
        (
            r"\frac{{}^{N}d\mathbf{T}}{dt} = \frac{{}^{B}d\mathbf{T}}{dt} + {}^{N}\boldsymbol{\omega}^{B} \times \mathbf{T}",
            r"{}^N\mathbf{H}^{B/B^*} = \mathbf{I}^{B/B^*} \cdot {}^N\boldsymbol{\omega}^B",
            r"{}^N\boldsymbol{\omega}^B = u_1 \mathbf{b}_1 + u_2 \mathbf{b}_2 + u_3 \mathbf{b}_3",
            r"T_1 = I_1 \dot{u}_1 - (I_2 - I_3) u_2 u_3",
            r"\mathbf{T} = \mathbf{I}^{B/B^*} \cdot {}^N\boldsymbol{\alpha}^B + {}^N\boldsymbol{\omega}^B \times (\mathbf{I}^{B/B^*} \cdot {}^N\boldsymbol{\omega}^B)",
        ),
    ),
    (
        HUGHES,
        (
            r"\dot{\mathbf{h}} + \boldsymbol{\omega}^\times \mathbf{h} = \mathbf{g}",
            r"\mathbf{h} = \mathbf{I} \boldsymbol{\omega}",
            r"\mathbf{I} \dot{\boldsymbol{\omega}} + \boldsymbol{\omega}^\times \mathbf{I} \boldsymbol{\omega} = \mathbf{g}",
            r"2 T = \boldsymbol{\omega}^T \mathbf{I} \boldsymbol{\omega}",
            r"I_2 \dot{\omega}_2 - (I_3 - I_1) \omega_3 \omega_1 = g_2",
        ),
    ),
    (
        SCHAUB,
        (
            r"[\dot{C}] = -[\tilde{\boldsymbol{\omega}}][C]",
            r"[C]^T[\dot{C}] = -[C]^T[\tilde{\boldsymbol{\omega}}][C]",
            r"\mathbf{H}_c = [I]\boldsymbol{\omega}",
            r"[I]\dot{\boldsymbol{\omega}} = -[\tilde{\boldsymbol{\omega}}][I]\boldsymbol{\omega} + \mathbf{L}_c",
            r"T_{rot} = \frac{1}{2} \boldsymbol{\omega}^T [I] \boldsymbol{\omega}",
            r"\mathbf{F} = M \ddot{\mathbf{R}}_c",
        ),
    ),
    (
        PHYSICS,
        (
            r"\dot{\mathbf{L}} = \mathbf{I} \dot{\boldsymbol{\omega}} + \boldsymbol{\omega} \times \mathbf{I} \boldsymbol{\omega}",
            r"N_2 = I_2 \dot{\omega}_2 - (I_3 - I_1) \omega_3 \omega_1",
            r"\mathbf{L} = \sum_i m_i (\mathbf{r}_i - \mathbf{R}) \times \mathbf{v}_i",
            r"T = \frac{1}{2} M \mathbf{V} \cdot \mathbf{V} + \frac{1}{2} \boldsymbol{\omega} \cdot \mathbf{L}",
            r"L_3 = I_{31} \omega_1 + I_{32} \omega_2 + I_{33} \omega_3",
        ),
    ),
)
"""Lexica with the lines of a note."""
