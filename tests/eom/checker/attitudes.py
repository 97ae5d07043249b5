"""True statements on attitude from textbooks, each in the notation of a preset, with their sources.

Hughes: Spacecraft Attitude Dynamics (1986). Schaub and Junkins: Analytical Mechanics of Space Systems,
2nd ed. (2009). Kane, Likins, Levinson: Spacecraft Dynamics (1983). Shuster: J. Astronaut. Sci. 41 (1993).
"""

ANGLES = r"""
'\psi' = "turn_angle 1 321 B I"
'\theta' = "turn_angle 2 321 B I"
'\phi' = "turn_angle 3 321 B I"
"""

HUGHES = r"""
preset = "hughes"
[symbols]
'\theta_{<k>}' = "turn_angle <k> space123 B I"
'\alpha' = "free_angle alpha"
'\mathbf{C}_{bi}' = "rotation B I"
"""

SCHAUB = 'preset = "schaub-junkins"\n[symbols]' + ANGLES

KANE = r"""
preset = "kane"
[symbols]
'\theta_{<k>}' = "turn_angle <k> body313 B I"
'\theta' = "principal_angle B I"
"""

ARROW = 'preset = "arrow-tilde"\n[symbols]\n' + ANGLES

SUPERSCRIPT = r"""
preset = "left-superscript"
[symbols]
'\alpha' = "turn_angle 1 232 B A"
'\beta' = "turn_angle 2 232 B A"
'\gamma' = "turn_angle 3 232 B A"
'\sigma' = "free_angle sigma"
"""

UNDERLINE = r"""
preset = "underline-bullet"
[symbols]
'\underline{\omega}' = "angular_velocity B I in B"
'\underline{C}' = "rotation B I"
'\underline{a}' = "principal_axis B I in B"
'\phi' = "principal_angle B I"
"""

BOLD = r"""
preset = "physics-bold"
[symbols]
'\alpha' = "turn_angle 1 313 B I"
'\beta' = "turn_angle 2 313 B I"
'\gamma' = "turn_angle 3 313 B I"
'R' = "rotation I B"
'R_z' = "active_turn 3"
'R_x' = "active_turn 1"
'\mathsf{q}' = "quaternion_last B I"
'\mathbf{q}' = "euler_vector B I in B"
"""

TRUE: list[tuple[str, str, str]] = [
    # elementary rotations and sequences
    (
        "Hughes, sect. 2.1",
        HUGHES,
        (
            r"\mathbf{C}_3(\alpha) = \begin{bmatrix}\cos\alpha & \sin\alpha & 0\\"
            r" -\sin\alpha & \cos\alpha & 0\\ 0 & 0 & 1\end{bmatrix}"
        ),
    ),
    (
        "Hughes, sect. 2.1",
        HUGHES,
        (
            r"\mathbf{C}_2(\alpha) = \begin{bmatrix}\cos\alpha & 0 & -\sin\alpha\\"
            r" 0 & 1 & 0\\ \sin\alpha & 0 & \cos\alpha\end{bmatrix}"
        ),
    ),
    (
        "Hughes, sect. 2.1",
        HUGHES,
        r"\mathbf{C}_{bi} = \mathbf{C}_1(\theta_1)\mathbf{C}_2(\theta_2)\mathbf{C}_3(\theta_3)",
    ),
    (
        "Hughes, sect. 2.3",
        HUGHES,
        (
            r"\begin{bmatrix}\omega_1\\ \omega_2\\ \omega_3\end{bmatrix} = \begin{bmatrix}1 & 0 & -s_2\\"
            r" 0 & c_1 & s_1 c_2\\ 0 & -s_1 & c_1 c_2\end{bmatrix}"
            r"\begin{bmatrix}\dot\theta_1\\ \dot\theta_2\\ \dot\theta_3\end{bmatrix}"
        ),
    ),
    (
        "Schaub and Junkins, sect. 3.3",
        SCHAUB,
        r"[BN] = [M_1(\phi)][M_2(\theta)][M_3(\psi)]",
    ),
    (
        "Schaub and Junkins, sect. 3.3",
        SCHAUB,
        (
            r"[C] = \begin{bmatrix} c\theta c\psi & c\theta s\psi & -s\theta\\"
            r" s\phi s\theta c\psi - c\phi s\psi & s\phi s\theta s\psi + c\phi c\psi & s\phi c\theta\\"
            r" c\phi s\theta c\psi + s\phi s\psi & c\phi s\theta s\psi - s\phi c\psi & c\phi c\theta"
            r"\end{bmatrix}"
        ),
    ),
    ("Schaub and Junkins, sect. 3.3", SCHAUB, r"C_{13} = -\sin\theta"),
    ("Schaub and Junkins, sect. 3.3", SCHAUB, r"\tan\psi = \frac{C_{12}}{C_{11}}"),
    ("Schaub and Junkins, sect. 3.3", SCHAUB, r"\tan\phi = \frac{C_{23}}{C_{33}}"),
    (
        "Schaub and Junkins, sect. 3.3",
        SCHAUB,
        (
            r"\begin{pmatrix}\omega_1\\ \omega_2\\ \omega_3\end{pmatrix} = \begin{bmatrix}"
            r" -\sin\theta & 0 & 1\\ \sin\phi\cos\theta & \cos\phi & 0\\ \cos\phi\cos\theta & -\sin\phi & 0"
            r"\end{bmatrix}\begin{pmatrix}\dot\psi\\ \dot\theta\\ \dot\phi\end{pmatrix}"
        ),
    ),
    (
        "Schaub and Junkins, sect. 3.3",
        SCHAUB,
        (
            r"\begin{pmatrix}\dot\psi\\ \dot\theta\\ \dot\phi\end{pmatrix} = \frac{1}{\cos\theta}"
            r"\begin{bmatrix} 0 & \sin\phi & \cos\phi\\ 0 & \cos\phi\cos\theta & -\sin\phi\cos\theta\\"
            r" \cos\theta & \sin\phi\sin\theta & \cos\phi\sin\theta\end{bmatrix}"
            r"\begin{pmatrix}\omega_1\\ \omega_2\\ \omega_3\end{pmatrix}"
        ),
    ),
    (
        "Schaub and Junkins, sect. 3.3, determinant",
        SCHAUB,
        (
            r"\det\begin{bmatrix} -\sin\theta & 0 & 1\\ \sin\phi\cos\theta & \cos\phi & 0\\"
            r" \cos\phi\cos\theta & -\sin\phi & 0\end{bmatrix} = -\cos\theta"
        ),
    ),
    (
        "Kane, Likins, Levinson, table in appendix I, body-three 3-1-3",
        KANE,
        r"\omega_1 = \dot\theta_1\sin\theta_2\sin\theta_3 + \dot\theta_2\cos\theta_3",
    ),
    (
        "Kane, Likins, Levinson, appendix II",
        KANE,
        r"\dot\theta_1 = \frac{\omega_1 s_3 + \omega_2 c_3}{s_2}",
    ),
    (
        "Kane, Likins, Levinson, appendix I",
        KANE,
        (
            r"C = \begin{bmatrix} c_1 c_3 - s_1 c_2 s_3 & -c_1 s_3 - s_1 c_2 c_3 & s_1 s_2\\"
            r" s_1 c_3 + c_1 c_2 s_3 & -s_1 s_3 + c_1 c_2 c_3 & -c_1 s_2\\ s_2 s_3 & s_2 c_3 & c_2"
            r"\end{bmatrix}"
        ),
    ),
    (
        "the sum of three turns",
        ARROW,
        (
            r"\vec\omega = \dot\psi\hat n_3 + \dot\theta(\cos\phi\,\hat b_2 - \sin\phi\,\hat b_3)"
            r" + \dot\phi\hat b_1"
        ),
    ),
    ("the first turn alone", ARROW, r"C_{BI} C_3(\psi)^T = C_1(\phi) C_2(\theta)"),
    (
        "a sequence from an intermediate frame",
        SUPERSCRIPT,
        r"{}^{\mathcal B}C^{\mathcal A} = C_2(\gamma) C_3(\beta) C_2(\alpha)",
    ),
    (
        "rates of 2-3-2 from A",
        SUPERSCRIPT,
        (
            r"{}^{\mathcal A}\boldsymbol\omega^{\mathcal B}\cdot\mathbf b_2"
            r" = \dot\gamma + \dot\alpha\cos\beta"
        ),
    ),
    (
        "addition of angular velocities (Kane and Levinson, sect. 2.4)",
        SUPERSCRIPT,
        (
            r"{}^{\mathcal I}\boldsymbol\omega^{\mathcal B} = {}^{\mathcal I}\boldsymbol\omega^{\mathcal A}"
            r" + {}^{\mathcal A}\boldsymbol\omega^{\mathcal B}"
        ),
    ),
    ("two turns about one axis", SUPERSCRIPT, r"C_3(\sigma) C_3(\sigma) = C_3(2\sigma)"),
    ("the inverse turn", SUPERSCRIPT, r"C_1(\sigma)^T = C_1(-\sigma)"),
    ("Goldstein, sect. 4.4, active", BOLD, r"R = R_z(\alpha)R_x(\beta)R_z(\gamma)"),
    ("Goldstein, sect. 4.9", BOLD, r"\omega_3 = \dot\alpha\cos\beta + \dot\gamma"),
    # the matrix itself
    (
        "Hughes, sect. 2.3 (Poisson)",
        HUGHES,
        r"\dot{\mathbf{C}}_{bi} = -\boldsymbol\omega^\times\mathbf{C}_{bi}",
    ),
    ("Hughes, sect. 2.1", HUGHES, r"\mathbf{C}_{bi}\mathbf{C}_{bi}^T = \mathbf{1}"),
    ("Hughes, sect. 2.1", HUGHES, r"\det\mathbf{C}_{bi} = 1"),
    ("Hughes, sect. 2.2", HUGHES, r"\cos\phi = \tfrac12(\operatorname{tr}\mathbf{C} - 1)"),
    (
        "Hughes, sect. 2.2 (Euler, Rodrigues)",
        HUGHES,
        (
            r"\mathbf{C} = \cos\phi\,\mathbf{1} + (1 - \cos\phi)\mathbf{a}\mathbf{a}^T"
            r" - \sin\phi\,\mathbf{a}^\times"
        ),
    ),
    ("Hughes, sect. 2.2", HUGHES, r"\mathbf{C}\mathbf{a} = \mathbf{a}"),
    ("Hughes, sect. 2.2", HUGHES, r"a_1 = \frac{C_{23} - C_{32}}{2\sin\phi}"),
    ("Hughes, sect. 2.3", HUGHES, r"\dot\phi = \mathbf{a}^T\boldsymbol\omega"),
    (
        "Hughes, sect. 2.3",
        HUGHES,
        (
            r"\dot{\mathbf{a}} = \tfrac12(\mathbf{a}^\times - \cot\tfrac{\phi}{2}"
            r"\mathbf{a}^\times\mathbf{a}^\times)\boldsymbol\omega"
        ),
    ),
    (
        "Hughes, sect. 2.3",
        HUGHES,
        (
            r"\boldsymbol\omega = \dot\phi\mathbf{a} - (1 - \cos\phi)\mathbf{a}^\times\dot{\mathbf{a}}"
            r" + \sin\phi\,\dot{\mathbf{a}}"
        ),
    ),
    ("Schaub and Junkins, sect. 3.2", SCHAUB, r"[\dot C] = -[\tilde{\boldsymbol\omega}][C]"),
    ("Schaub and Junkins, sect. 3.4", SCHAUB, r"\cos\Phi = \frac12(C_{11} + C_{22} + C_{33} - 1)"),
    ("Schaub and Junkins, sect. 3.2", SCHAUB, r"[BA][AN] = [BN]"),
    (
        "in the other direction",
        UNDERLINE,
        r"\dot{\underline{C}}_{IB} = \underline{C}_{IB}\underline{\omega}^\times",
    ),
    (
        "through the angle's half",
        UNDERLINE,
        (
            r"\underline{C} = \underline{\mathbf{1}} - \sin\phi\,\underline{a}^\times"
            r" + 2\sin^2\tfrac{\phi}{2}\,\underline{a}^\times\underline{a}^\times"
        ),
    ),
    ("active (Rodrigues, 1840)", BOLD, r"\operatorname{tr} R = 1 + 2\cos\Phi"),
    (
        "active",
        BOLD,
        (
            r"R = \mathbf{1}\cos\Phi + (1 - \cos\Phi)\hat{\mathbf n}\hat{\mathbf n}^T"
            r" + \sin\Phi[\hat{\mathbf n}]_\times"
        ),
    ),
    # Euler parameters
    (
        "Hughes, sect. 2.2",
        HUGHES,
        (
            r"\mathbf{C} = (\eta^2 - \boldsymbol\epsilon^T\boldsymbol\epsilon)\mathbf{1}"
            r" + 2\boldsymbol\epsilon\boldsymbol\epsilon^T - 2\eta\boldsymbol\epsilon^\times"
        ),
    ),
    ("Hughes, sect. 2.2", HUGHES, r"\boldsymbol\epsilon^T\boldsymbol\epsilon + \eta^2 = 1"),
    ("Hughes, sect. 2.2", HUGHES, r"\boldsymbol\epsilon = \mathbf{a}\sin\tfrac{\phi}{2}"),
    ("Hughes, sect. 2.2", HUGHES, r"\eta = \cos\tfrac{\phi}{2}"),
    (
        "Hughes, sect. 2.3",
        HUGHES,
        (
            r"\dot{\boldsymbol\epsilon} = \tfrac12(\boldsymbol\epsilon^\times + \eta\mathbf{1})"
            r"\boldsymbol\omega"
        ),
    ),
    ("Hughes, sect. 2.3", HUGHES, r"\dot\eta = -\tfrac12\boldsymbol\epsilon^T\boldsymbol\omega"),
    (
        "Hughes, sect. 2.3",
        HUGHES,
        (
            r"\boldsymbol\omega = 2(\eta\dot{\boldsymbol\epsilon} - \dot\eta\boldsymbol\epsilon)"
            r" - 2\boldsymbol\epsilon^\times\dot{\boldsymbol\epsilon}"
        ),
    ),
    (
        "Hughes, sect. 2.3, in one column",
        HUGHES,
        (
            r"\begin{bmatrix}\dot{\boldsymbol\epsilon}\\ \dot\eta\end{bmatrix} = \frac12\begin{bmatrix}"
            r"-\boldsymbol\omega^\times & \boldsymbol\omega\\ -\boldsymbol\omega^T & 0\end{bmatrix}"
            r"\begin{bmatrix}\boldsymbol\epsilon\\ \eta\end{bmatrix}"
        ),
    ),
    ("Schaub and Junkins, sect. 3.5", SCHAUB, r"\beta_0^2 + \beta_1^2 + \beta_2^2 + \beta_3^2 = 1"),
    ("Schaub and Junkins, sect. 3.5", SCHAUB, r"|\boldsymbol\beta| = 1"),
    (
        "Schaub and Junkins, sect. 3.5",
        SCHAUB,
        (
            r"[C] = \begin{bmatrix} \beta_0^2+\beta_1^2-\beta_2^2-\beta_3^2 &"
            r" 2(\beta_1\beta_2+\beta_0\beta_3) & 2(\beta_1\beta_3-\beta_0\beta_2)\\"
            r" 2(\beta_1\beta_2-\beta_0\beta_3) & \beta_0^2-\beta_1^2+\beta_2^2-\beta_3^2 &"
            r" 2(\beta_2\beta_3+\beta_0\beta_1)\\ 2(\beta_1\beta_3+\beta_0\beta_2) &"
            r" 2(\beta_2\beta_3-\beta_0\beta_1) & \beta_0^2-\beta_1^2-\beta_2^2+\beta_3^2\end{bmatrix}"
        ),
    ),
    ("Schaub and Junkins, sect. 3.5", SCHAUB, r"\beta_1 = \frac{C_{23} - C_{32}}{4\beta_0}"),
    (
        "Schaub and Junkins, sect. 3.5, 4 x 4",
        SCHAUB,
        (
            r"\begin{pmatrix}\dot\beta_0\\ \dot\beta_1\\ \dot\beta_2\\ \dot\beta_3\end{pmatrix} = \frac12"
            r"\begin{bmatrix}\beta_0&-\beta_1&-\beta_2&-\beta_3\\ \beta_1&\beta_0&-\beta_3&\beta_2\\"
            r"\beta_2&\beta_3&\beta_0&-\beta_1\\ \beta_3&-\beta_2&\beta_1&\beta_0\end{bmatrix}"
            r"\begin{pmatrix}0\\ \omega_1\\ \omega_2\\ \omega_3\end{pmatrix}"
        ),
    ),
    (
        "Schaub and Junkins, sect. 3.5",
        SCHAUB,
        (
            r"\dot{\boldsymbol\beta} = \frac12\begin{bmatrix}0&-\omega_1&-\omega_2&-\omega_3\\"
            r"\omega_1&0&\omega_3&-\omega_2\\ \omega_2&-\omega_3&0&\omega_1\\"
            r"\omega_3&\omega_2&-\omega_1&0\end{bmatrix}\boldsymbol\beta"
        ),
    ),
    (
        "Schaub and Junkins, sect. 3.5",
        SCHAUB,
        (
            r"\dot{\boldsymbol\beta} = \frac12\begin{bmatrix}-\beta_1&-\beta_2&-\beta_3\\"
            r"\beta_0&-\beta_3&\beta_2\\ \beta_3&\beta_0&-\beta_1\\ -\beta_2&\beta_1&\beta_0\end{bmatrix}"
            r"\boldsymbol\omega"
        ),
    ),
    (
        "from the angles of 3-2-1",
        SCHAUB,
        (
            r"\beta_0 = \cos\frac{\psi}{2}\cos\frac{\theta}{2}\cos\frac{\phi}{2}"
            r" + \sin\frac{\psi}{2}\sin\frac{\theta}{2}\sin\frac{\phi}{2}"
        ),
    ),
    (
        "Shuster, scalar last",
        BOLD,
        (
            r"\dot{\mathsf{q}} = \frac12\begin{bmatrix}0&\omega_3&-\omega_2&\omega_1\\"
            r"-\omega_3&0&\omega_1&\omega_2\\ \omega_2&-\omega_1&0&\omega_3\\"
            r"-\omega_1&-\omega_2&-\omega_3&0\end{bmatrix}\mathsf{q}"
        ),
    ),
    ("a unit column", BOLD, r"\mathsf{q}^T\dot{\mathsf{q}} = 0"),
    (
        "active",
        BOLD,
        (
            r"R = (q_0^2 - \mathbf{q}^T\mathbf{q})\mathbf{1} + 2\mathbf{q}\mathbf{q}^T"
            r" + 2q_0[\mathbf{q}]_\times"
        ),
    ),
    (
        "Kane, Likins, Levinson, sect. 1.3",
        KANE,
        r"\boldsymbol\epsilon = \boldsymbol\lambda\sin\frac{\theta}{2}",
    ),
    ("Kane, Likins, Levinson, sect. 1.3", KANE, r"\epsilon_4 = \cos\frac{\theta}{2}"),
    (
        "Kane, Likins, Levinson, sect. 1.3",
        KANE,
        r"C_{12} = 2(\epsilon_1\epsilon_2 - \epsilon_3\epsilon_4)",
    ),
    (
        "Kane, Likins, Levinson, sect. 1.13",
        KANE,
        (
            r"\omega_1 = 2(\dot\epsilon_1\epsilon_4 + \dot\epsilon_2\epsilon_3 - \dot\epsilon_3\epsilon_2"
            r" - \dot\epsilon_4\epsilon_1)"
        ),
    ),
    # Rodrigues parameters
    ("Hughes, sect. 2.2", HUGHES, r"\mathbf{p} = \mathbf{a}\tan\tfrac{\phi}{2}"),
    (
        "Hughes, sect. 2.2",
        HUGHES,
        (
            r"\mathbf{C} = \frac{(1 - \mathbf{p}^T\mathbf{p})\mathbf{1} + 2\mathbf{p}\mathbf{p}^T"
            r" - 2\mathbf{p}^\times}{1 + \mathbf{p}^T\mathbf{p}}"
        ),
    ),
    (
        "Hughes, sect. 2.3",
        HUGHES,
        (
            r"\dot{\mathbf{p}} = \tfrac12(\mathbf{1} + \mathbf{p}^\times + \mathbf{p}\mathbf{p}^T)"
            r"\boldsymbol\omega"
        ),
    ),
    (
        "Cayley (Schaub and Junkins, sect. 3.6)",
        SCHAUB,
        r"[C] = ([I_{3\times3}] - [\tilde{\mathbf q}])([I_{3\times3}] + [\tilde{\mathbf q}])^{-1}",
    ),
    ("Schaub and Junkins, sect. 3.6", SCHAUB, r"q_1 = \frac{\beta_1}{\beta_0}"),
    (
        "Schaub and Junkins, sect. 3.6",
        SCHAUB,
        r"\boldsymbol\omega = \frac{2}{1 + q^2}([I_{3\times3}] - [\tilde{\mathbf q}])\dot{\mathbf q}",
    ),
    (
        "Kane, Likins, Levinson, sect. 1.14",
        KANE,
        (
            r"\omega_1 = \frac{2(\dot\rho_1 + \dot\rho_2\rho_3 - \dot\rho_3\rho_2)}"
            r"{1 + \rho_1^2 + \rho_2^2 + \rho_3^2}"
        ),
    ),
    ("Schaub and Junkins, sect. 3.7", SCHAUB, r"\sigma_2 = \frac{\beta_2}{1 + \beta_0}"),
    (
        "Schaub and Junkins, sect. 3.7",
        SCHAUB,
        r"\boldsymbol\sigma = \hat{\mathbf e}\tan\frac{\Phi}{4}",
    ),
    (
        "Schaub and Junkins, sect. 3.7",
        SCHAUB,
        r"\boldsymbol\sigma^S = -\frac{\boldsymbol\sigma}{\sigma^2}",
    ),
    (
        "Schaub and Junkins, sect. 3.7",
        SCHAUB,
        (
            r"[C] = [I_{3\times3}] + \frac{8[\tilde{\boldsymbol\sigma}]^2"
            r" - 4(1 - \sigma^2)[\tilde{\boldsymbol\sigma}]}{(1 + \sigma^2)^2}"
        ),
    ),
    (
        "Schaub and Junkins, sect. 3.7",
        SCHAUB,
        (
            r"\dot{\boldsymbol\sigma} = \frac14[(1 - \sigma^2)[I_{3\times3}] + 2[\tilde{\boldsymbol\sigma}]"
            r" + 2\boldsymbol\sigma\boldsymbol\sigma^T]\boldsymbol\omega"
        ),
    ),
]
"""Source, lexicon, statement."""


_SWAPS = (
    (r"\sin", r"\cos"),
    (r"\cos", r"\sin"),
    (r"\tan", r"\cot"),
    (r"s\theta", r"c\theta"),
    (r"c\psi", r"s\psi"),
    ("s_", "c_"),
    ("c_", "s_"),
    ("_1", "_2"),
    ("_3", "_1"),
    ("_{13}", "_{31}"),
    ("_{23}", "_{32}"),
    (r"(\psi)", r"(-\psi)"),
    (r"\frac12", r"\frac14"),
    (r"\tfrac12", ""),
    ("4", "2"),
    ("BN", "NB"),
    (r"\dot", ""),
    ("_{BI}", "_{IB}"),
    ("_0", "_1"),
    ("^T", ""),
)


def mutants(text):
    """Yield the statement with one slip: a sign, sine for cosine, an index, a factor, a frame, a dot."""
    for k, c in enumerate(text):
        if c in "+-":
            yield f"{text[:k]}{'-' if c == '+' else '+'}{text[k + 1 :]}"
    for old, new in _SWAPS:
        start = text.find(old)
        while start >= 0:
            before, after = text[:start][-1:], text[start + len(old) :]
            split = old[0].isalpha() and (before.isalpha() or before == "\\")
            if not split and not (new == "" and after[:1].isalpha()):
                yield f"{text[:start]}{new}{after}"
            start = text.find(old, start + 1)


STILL_TRUE = {
    "Schaub and Junkins, sect. 3.3, determinant": 2,
    "Schaub and Junkins, sect. 3.5, 4 x 4": 3,
}
"""How many slips change only what a zero multiplies: the first entry of the first row, or a column."""
