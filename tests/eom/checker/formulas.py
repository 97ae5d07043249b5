"""Formulas in the spellings of many books, and their trees written by hand in the notation of `shape`.

Kane and Levinson; Hughes; Schaub and Junkins; Wertz; Goldstein; Wie; Markley and Crassidis; and
what notes and handouts do with LaTeX.
"""

KANE = [
    (
        r"{}^{N}\boldsymbol{\omega}^{B} = u_1 \mathbf{b}_1 + u_2 \mathbf{b}_2",
        "*omega{^B <N} = [[u{_1} *b{_1}] + [u{_2} *b{_2}]]",
    ),
    (
        r"{}^N\mathbf{v}^{P} = {}^N\mathbf{v}^{O} + {}^N\boldsymbol\omega^B \times \mathbf{p}^{OP}",
        "*v{^P <N} = [*v{^O <N} + [*omega{^B <N} x *p{^[O P]}]]",
    ),
    (
        r"\frac{{}^{A}d\mathbf{v}}{dt} = \frac{{}^{B}d\mathbf{v}}{dt} + {}^{A}\boldsymbol{\omega}^{B} \times \mathbf{v}",
        "D(*v)/t@A = [D(*v)/t@B + [*omega{^B <A} x *v]]",
    ),
    (
        r"{}^{A}\boldsymbol\alpha^{B} \triangleq \frac{{}^{A}d\,{}^{A}\boldsymbol\omega^{B}}{dt}",
        "*alpha{^B <A} := D(*omega{^B <A})/t@A",
    ),
    (
        r"\prescript{A}{}{\boldsymbol\omega}^{C} = \prescript{A}{}{\boldsymbol\omega}^{B} + \prescript{B}{}{\boldsymbol\omega}^{C}",
        "*omega{^C <A} = [*omega{^B <A} + *omega{^C <B}]",
    ),
    (r"F_r + F_r^* = 0 \quad (r = 1, \ldots, n)", "[F{_r} + F{_r ^!ast}] = 0 ~ (r = 1, ..., n)"),
    (
        r"F_r = \sum_{i=1}^{\nu} \mathbf{v}_r^{P_i} \cdot \mathbf{R}_i",
        "F{_r} = sum{_i = 1 ^nu}([*v{_r ^P{_i}} . *R{_i}])",
    ),
    (
        r"\mathbf{T}^* = -\boldsymbol\alpha\cdot\underline{\underline{I}} - \boldsymbol\omega\times\underline{\underline{I}}\cdot\boldsymbol\omega",
        "*T{^!ast} = [-[*alpha . underline(underline(I))] - [[*omega x underline(underline(I))] . *omega]]",
    ),
    (
        r"{}^A\mathbf{a}^P = \frac{^A d}{dt}\left({}^A\mathbf{v}^P\right)",
        "*a{^P <A} = D((*v{^P <A}))/t@A",
    ),
    (
        r"^{N}\!\mathbf{H}^{B/B^*} = \mathbf{I}^{B/B^*} \cdot {}^{N}\boldsymbol\omega^{B}",
        "*H{^[B / B{^!ast}] <N} = [*I{^[B / B{^!ast}]} . *omega{^B <N}]",
    ),
    (r"\dot{q}_1 = u_1 c_3 - u_2 s_3", "dot(q){_1} = [[u{_1} c{_3}] - [u{_2} s{_3}]]"),
]

SCHAUB = [
    (
        r"\boldsymbol{\omega}_{B/N} = \dot\theta \hat{\mathbf b}_3",
        "*omega{_[B / N]} = [dot(theta) hat(*b){_3}]",
    ),
    (r"[\dot{C}] = -[\tilde{\boldsymbol\omega}][C]", "[dot(C)] = [-[[tilde(*omega)] [C]]]"),
    (
        r"\frac{{}^{\mathcal N}\mathrm{d}}{\mathrm{d}t}(\mathbf{x}) = \frac{{}^{\mathcal B}\mathrm{d}}{\mathrm{d}t}(\mathbf{x}) + \boldsymbol\omega_{\mathcal{B}/\mathcal{N}}\times\mathbf{x}",
        "D((*x))/t@cal:N = [D((*x))/t@cal:B + [*omega{_[cal:B / cal:N]} x *x]]",
    ),
    (
        r"[I]\dot{\boldsymbol\omega} = -[\tilde{\boldsymbol\omega}][I]\boldsymbol\omega + \mathbf{L}_c",
        "[[I] dot(*omega)] = [-[[tilde(*omega)] [I] *omega] + *L{_c}]",
    ),
    (
        r"{}^{\mathcal B}\boldsymbol{\omega} = \begin{pmatrix} -s_2 & 0 & 1 \\ s_3 c_2 & c_3 & 0 \\ c_3 c_2 & -s_3 & 0 \end{pmatrix} \begin{pmatrix} \dot\theta_1\\ \dot\theta_2\\ \dot\theta_3 \end{pmatrix}",
        (
            "*omega{<cal:B} = [pmatrix([-s{_2}] & 0 & 1 // [s{_3} c{_2}] & c{_3} & 0 // [c{_3} c{_2}] & [-s{_3}] & 0) "
            "pmatrix(dot(theta){_1} // dot(theta){_2} // dot(theta){_3})]"
        ),
    ),
    (
        r"[C] = \left(1-\boldsymbol\sigma^T\boldsymbol\sigma\right)[I_{3\times 3}] + 2\boldsymbol\sigma\boldsymbol\sigma^T - 2[\tilde{\boldsymbol\sigma}]",
        "[C] = [[([1 - [*sigma{^T} *sigma]]) [I{_[3 x 3]}]] + [2 *sigma *sigma{^T}] - [2 [tilde(*sigma)]]]",
    ),
    (
        r"\dot{\boldsymbol\sigma} = \tfrac14 \left[(1-\sigma^2)[I] + 2[\tilde{\boldsymbol\sigma}] + 2\boldsymbol\sigma\boldsymbol\sigma^T\right]{}^{\mathcal B}\boldsymbol\omega",
        "dot(*sigma) = [frac(1, 4) [[[([1 - sigma{^2}]) [I]] + [2 [tilde(*sigma)]] + [2 *sigma *sigma{^T}]]] *omega{<cal:B}]",
    ),
    (
        r"T = \frac12 M \dot{\mathbf R}_c\cdot\dot{\mathbf R}_c + \frac12\int_B \dot{\mathbf r}\cdot\dot{\mathbf r}\,\mathrm{d}m",
        "T = [[[frac(1, 2) M dot(*R){_c}] . dot(*R){_c}] + [frac(1, 2) int{_B}([dot(*r) . dot(*r)]; m)]]",
    ),
    (r"[BN] = [BF][FN]", "[[B N]] = [[[B F]] [[F N]]]"),
    (
        r"\mathbf{L}_G = \frac{3\mu}{R_c^5}\,\mathbf{R}_c\times[I]\mathbf{R}_c",
        "*L{_G} = [[frac([3 mu], R{_c ^5}) *R{_c}] x [[I] *R{_c}]]",
    ),
]

HUGHES = [
    (r"\underset{\rightarrow}{\omega}^{\times}", "over(omega, ? to ?){^!times}"),
    (
        r"\mathbf{C}_{21} = \mathbf{1} - \mathbf{a}^\times \sin\phi + \mathbf{a}^\times\mathbf{a}^\times(1-\cos\phi)",
        "*C{_21} = [*1 - [*a{^!times} sin phi] + [*a{^!times} *a{^!times} ([1 - cos phi])]]",
    ),
    (
        r"\dot{\boldsymbol\varepsilon} = \tfrac{1}{2}(\boldsymbol\varepsilon^\times + \eta\mathbf{1})\boldsymbol\omega, \quad \dot\eta = -\tfrac12\boldsymbol\varepsilon^{T}\boldsymbol\omega",
        (
            "dot(*varepsilon) = [frac(1, 2) ([*varepsilon{^!times} + [eta *1]]) *omega], "
            "dot(eta) = [-[frac(1, 2) *varepsilon{^T} *omega]]"
        ),
    ),
    (
        r"\mathbf{J} = -\int_{\mathcal V} \mathbf{r}^\times\mathbf{r}^\times\,dm = \int_{\mathcal V}(\mathbf{r}^{\mathsf T}\mathbf{r}\mathbf{1} - \mathbf{r}\mathbf{r}^{\mathsf T})\,\mathrm{d}m",
        (
            "*J = [-int{_cal:V}([*r{^!times} *r{^!times}]; m)] = "
            "int{_cal:V}(([[*r{^sans:T} *r *1] - [*r *r{^sans:T}]]); m)"
        ),
    ),
    (
        r"\underline{v}^{\bullet} = \underline{v}^{\circ} + \underline{\omega}\times\underline{v}",
        "underline(v){^!bullet} = [underline(v){^!circ} + [underline(omega) x underline(v)]]",
    ),
    (
        r"\overset{\bullet}{\mathbf{h}} = \overset{\circ}{\mathbf{h}} + \boldsymbol{\omega}\times\mathbf{h}",
        "bullet(*h) = [circle(*h) + [*omega x *h]]",
    ),
    (r"\mathcal{F}_b = \mathbf{C}_{ba}\mathcal{F}_a", "cal:F{_b} = [*C{_[b a]} cal:F{_a}]"),
    (
        r"I_{xx} = \iiint_V \rho\,(y^2+z^2)\,dx\,dy\,dz",
        "I{_[x x]} = iiint{_V}([rho ([y{^2} + z{^2}])]; x y z)",
    ),
    (
        r"\mathbf{h} = \mathbf{I}\boldsymbol\omega + \mathbf{a}h_s",
        "*h = [[*I *omega] + [*a h{_s}]]",
    ),
    (
        r"\vec{\mathbf g}_c = 3\frac{\mu}{R^3}\,\hat{\mathbf c}_3\times\mathbf{I}\cdot\hat{\mathbf c}_3",
        "vec(*g){_c} = [[[3 frac(mu, R{^3}) hat(*c){_3}] x *I] . hat(*c){_3}]",
    ),
]

GOLDSTEIN = [
    (
        r"\left(\frac{d\mathbf{G}}{dt}\right)_{\text{space}} = \left(\frac{d\mathbf{G}}{dt}\right)_{\text{body}} + \boldsymbol\omega\times\mathbf{G}",
        "D(*G)/t@'space' = [D(*G)/t@'body' + [*omega x *G]]",
    ),
    (
        r"\left.\frac{d\mathbf r}{dt}\right|_{s} = \left.\frac{d\mathbf r}{dt}\right|_{r} + \boldsymbol\omega\times\mathbf{r}",
        "D(*r)/t@s = [D(*r)/t@r + [*omega x *r]]",
    ),
    (r"\left(\frac{d}{dt}\right)_{s}\mathbf{r}", "D(*r)/t@s"),
    (
        r"\frac{d}{dt}\left(\frac{\partial L}{\partial \dot q_j}\right) - \frac{\partial L}{\partial q_j} = 0, \qquad j=1,2,\ldots,n",
        "[D((P(L)/dot(q){_j}))/t - P(L)/q{_j}] = 0, j = 1, 2, ..., n",
    ),
    (
        r"\frac{\mathrm{d}}{\mathrm{d}t}\frac{\partial T}{\partial\dot\theta} = Q_\theta",
        "D(P(T)/dot(theta))/t = Q{_theta}",
    ),
    (
        r"I_1\dot\omega_1 - \omega_2\omega_3(I_2-I_3) = N_1",
        "[[I{_1} dot(omega){_1}] - [omega{_2} omega{_3} ([I{_2} - I{_3}])]] = N{_1}",
    ),
    (r"\mathbf{L} = m_i(\mathbf{r}_i\times\mathbf{v}_i)", "*L = [m{_i} ([*r{_i} x *v{_i}])]"),
    (
        r"I_{jk} = \int_V \rho(\mathbf{r})(r^2\delta_{jk} - x_j x_k)\,dV",
        "I{_[j k]} = int{_V}([rho (*r) ([[r{^2} delta{_[j k]}] - [x{_j} x{_k}]])]; V)",
    ),
    (
        r"E' = \tfrac12 I_1\dot\theta^2 + \frac{(b-a\cos\theta)^2}{2I_1\sin^2\theta} + Mgl\cos\theta",
        "E{^!prime} = [[frac(1, 2) I{_1} dot(theta){^2}] + frac(([b - [a cos theta]]){^2}, [2 I{_1} sin{^2} theta]) + [M g l cos theta]]",
    ),
    (r"\dot{\mathbf p} = -\nabla V", "dot(*p) = [-[nabla V]]"),
    (r"m\,d\mathbf{v}/dt = \mathbf{F}", "[m D(*v)/t] = *F"),
    (
        r"\delta W = \sum_i \mathbf{F}_i\cdot\delta\mathbf{r}_i",
        "[delta W] = sum{_i}([*F{_i} . [delta *r{_i}]])",
    ),
    (r"\int_{t_1}^{t_2} L\,dt", "int{_t{_1} ^t{_2}}(L; t)"),
    (
        r"V = -\frac{GM}{r}\left[1 - \sum_{n=2}^{\infty} J_n\left(\frac{a}{r}\right)^n P_n(\sin\theta)\right]",
        "V = [-[frac([G M], r) [[1 - sum{_n = 2 ^infty}([J{_n} (frac(a, r)){^n} P{_n} (sin theta)])]]]]",
    ),
]

WIE_WERTZ = [
    (r"\vec{H} = \hat{I}\cdot\vec\omega", "vec(H) = [hat(I) . vec(omega)]"),
    (r"\left\{\frac{d\vec H}{dt}\right\}_N = \vec M", "{D(vec(H))/t}{_N} = vec(M)"),
    (
        r"\dot{q}_4 = -\tfrac{1}{2}\boldsymbol\omega^T\mathbf{q}",
        "dot(q){_4} = [-[frac(1, 2) *omega{^T} *q]]",
    ),
    (
        r"\dot{\bar q} = \frac12 \Omega(\bar\omega)\bar q",
        "dot(bar(q)) = [frac(1, 2) Omega (bar(omega)) bar(q)]",
    ),
    (
        r"\mathbf{q}\otimes\mathbf{p} = \begin{bmatrix} q_4\mathbf{p} + p_4\mathbf{q} - \mathbf{q}\times\mathbf{p} \\ q_4p_4 - \mathbf{q}\cdot\mathbf{p}\end{bmatrix}",
        "[*q (x) *p] = bmatrix([[q{_4} *p] + [p{_4} *q] - [*q x *p]] // [[q{_4} p{_4}] - [*q . *p]])",
    ),
    (
        r"C^{B/A} = C_1(\theta_1) C_2(\theta_2) C_3(\theta_3)",
        "C{^[B / A]} = [C{_1} (theta{_1}) C{_2} (theta{_2}) C{_3} (theta{_3})]",
    ),
    (
        r"A = \cos\Phi\, I + (1-\cos\Phi)\hat e\hat e^T - \sin\Phi[\hat e\times]",
        "A = [[cos Phi I] + [([1 - cos Phi]) hat(e) hat(e){^T}] - [sin Phi [[hat(e) cross]]]]",
    ),
    (r"\operatorname{tr} A = 1 + 2\cos\Phi", "tr A = [1 + [2 cos Phi]]"),
    (r"\det\left(\lambda \mathbf{1} - \mathbf{J}\right) = 0", "det ([[lambda *1] - *J]) = 0"),
    (
        r"\mathbf{A}^{-1} = \mathbf{A}^{\top}, \; \|\mathbf{A}\mathbf{x}\| = \|\mathbf{x}\|",
        "*A{^[-1]} = *A{^top}, ||[*A *x]|| = ||*x||",
    ),
    (
        r"[\mathbf{a}]_\times \mathbf{b} = S(\mathbf{a})\mathbf{b} = \mathbf{a}\times\mathbf{b}",
        "[[*a]{_!times} *b] = [S (*a) *b] = [*a x *b]",
    ),
    (r"R = R_z(\psi)R_y(\theta)R_x(\phi)", "R = [R{_z} (psi) R{_y} (theta) R{_x} (phi)]"),
    (r"^{A}_{B}R\,{}^{B}p", "[R{,B <A} p{<B}]"),
    (
        r"\sqrt{q_1^2+q_2^2+q_3^2+q_4^2} = 1",
        "root([q{_1 ^2} + q{_2 ^2} + q{_3 ^2} + q{_4 ^2}]) = 1",
    ),
    (r"\theta = \operatorname{atan2}(R_{21}, R_{11})", "theta = atan2 (R{_21}, R{_11})"),
    (
        r"\omega_p = \frac{I_3\,\omega_3}{(I_1 - I_3)\cos\theta}",
        "omega{_p} = frac([I{_3} omega{_3}], [([I{_1} - I{_3}]) cos theta])",
    ),
    (
        r"\dot\theta \ll \omega_s, \quad I_3 > I_1 \ge I_2 \neq 0",
        "dot(theta) << omega{_s}, I{_3} > I{_1} >= I{_2} != 0",
    ),
]

HANDOUTS = [
    (r"\vec H{}' = \vec M", "vec(H){^!prime} = vec(M)"),
    (r"\Bigl.\frac{a}{b}\Bigr|_{x=0} = c", "at(frac(a, b){_x = 0}) = c"),
    (r"(m \text{ the mass (of }B)) = n", "(m ' the mass (of ' B) = n"),
    (r"\frac{\partial^2 T}{\partial\dot q_2^2} = n", "P2(T)/dot(q){_2} = n"),
    (
        r"I_{ij} = \begin{cases} \frac{2}{5}MR^2 & i = j \\ 0 & \text{otherwise} \end{cases}",
        "I{_[i j]} = cases([frac(2, 5) M R{^2}] & i = j // 0 & 'otherwise')",
    ),
    (
        r"\begin{aligned} \mathbf{v} &= \dot{\mathbf r} \\ &= \dot r\,\mathbf{e}_r \\ &\quad + r\dot\theta\,\mathbf{e}_\theta \end{aligned}",
        "*v = dot(*r) // ? = [[dot(r) *e{_r}] + [r dot(theta) *e{_theta}]]",
    ),
    (r"{\bf H}_G = {\bf I}_G \cdot {\bf \omega}", "*H{_G} = [*I{_G} . *omega]"),
    (r"\omega × (ω × r) − 2 ω × ṙ", "[[omega x ([omega x r])] - [[2 omega] x dot(r)]]"),
    (r"\dv{\vec{p}}{t} = \vec{F}", "D(vec(p))/t = vec(F)"),
    (r"\pdv{L}{q} - \dv{t} p = 0", "[P(L)/q - D(p)/t] = 0"),
    (
        r"x'' + 2\zeta\omega_n x' + \omega_n^2 x = 0",
        "[x{^!prime!prime} + [2 zeta omega{_n} x{^!prime}] + [omega{_n ^2} x]] = 0",
    ),
    (
        r"\vec a \cdot (\vec b \times \vec c) = \begin{vmatrix} a_1 & a_2 & a_3 \\ b_1 & b_2 & b_3 \\ c_1 & c_2 & c_3 \end{vmatrix}",
        "[vec(a) . ([vec(b) x vec(c)])] = vmatrix(a{_1} & a{_2} & a{_3} // b{_1} & b{_2} & b{_3} // c{_1} & c{_2} & c{_3})",
    ),
    (
        r"\overline{\overline{\mathbf{I}}} = \sum_i I_i \mathbf{e}_i \otimes \mathbf{e}_i",
        "bar(bar(*I)) = sum{_i}([[I{_i} *e{_i}] (x) *e{_i}])",
    ),
    (
        r"\therefore\; \ddot\theta + \frac{g}{l}\sin\theta = 0 \tag{7}",
        "? therefore [ddot(theta) + [frac(g, l) sin theta]] = 0",
    ),
    (
        r"\left\{\begin{array}{l} \dot x = v \\ \dot v = -x \end{array}\right.",
        "cases(dot(x) = v // dot(v) = [-x])",
    ),
    (
        r"\overbrace{m\ddot{\vec r}}^{\text{inertia}} = \vec F",
        "overbrace([m ddot(vec(r))]; 'inertia') = vec(F)",
    ),
    (r"\cancelto{0}{\vec\omega\times\vec\omega}", "struck([vec(omega) x vec(omega)])"),
    (r"\mathbf{r}_{CM} := \frac1M\int\mathbf{r}\,dm", "*r{_[C M]} := [frac(1, M) int(*r; m)]"),
    (r"\int\!\!\int\!\!\int \rho\, dx\,dy\,dz", "int(int(int(rho; x); y); z)"),
    (r"\oint \vec F\cdot d\vec r = 0", "oint([vec(F) dot]; vec(r)) = 0"),
    (
        r"s\theta = \sin\theta,\ c\theta = \cos\theta",
        "[s theta] = sin theta, [c theta] = cos theta",
    ),
    (
        r"\cos\omega t\,\hat{i} + \sin 2\theta\,\hat j",
        "[[cos [omega t] hat(i)] + [sin [2 theta] hat(j)]]",
    ),
    (
        r"\vec\omega = \text{const} \iff \vec M = 0 \text{ and } \omega_2 = 0",
        "vec(omega) = 'const' equivalent vec(M) = 0 ' and ' omega{_2} = 0",
    ),
    (r"\mathbf F \overset{!}{=} \mathbf 0, \quad a \stackrel{\text{def}}{=} b", "*F = *0, a := b"),
    (
        r"-\sigma \le x \le \sigma \text{ for all } x \in B",
        "[-sigma] <= x <= sigma ' for all ' x in B",
    ),
    (
        r"\left(\vec a + \vec b \right. \\ \left. {} + \vec c\right) \times \vec d = 0",
        "[([vec(a) + vec(b) + vec(c)]) x vec(d)] = 0",
    ),
    (
        r"I_1 \ddot\theta \pm k\theta = \mp c\dot\theta",
        "[[I{_1} ddot(theta)] ± [k theta]] = [∓[c dot(theta)]]",
    ),
    (r"T = 1/2\, m v^2", "T = [[1 / 2] m v{^2}]"),
    (r"d\mathbf{L}/dt = \mathbf{N}", "D(*L)/t = *N"),
    (
        r"\frac{d^2\theta}{dt^2} + \omega_0^2\,\theta = 0",
        "[D2(theta)/t + [omega{_0 ^2} theta]] = 0",
    ),
]

BOOKS = {
    "Kane": KANE,
    "Schaub and Junkins": SCHAUB,
    "Hughes": HUGHES,
    "Goldstein": GOLDSTEIN,
    "Wie, Wertz": WIE_WERTZ,
    "handouts": HANDOUTS,
}

SCANS = [
    (
        r"= \int_B \vec{R}_C \times \dot{\vec r} \, dm + \int_B \vec{r} \, dm \times \vec{R}_C",
        "? = [int{_B}([vec(R){_C} x dot(vec(r))]; m) + [int{_B}(vec(r); m) x vec(R){_C}]]",
    ),
    (r"\Rightarrow \int_B \vec{r} \, dm = 0", "? implies int{_B}(vec(r); m) = 0"),
    (
        r"\frac{^I d\vec{r}}{dt} = \frac{^B d\vec{r}}{dt} + \vec{\omega} \times \vec{r} \quad \vec{\omega} \text{ is the rotation}",
        "D(vec(r))/t@I = [D(vec(r))/t@B + [vec(omega) x vec(r)]] ~ vec(omega) ' is the rotation'",
    ),
    (
        r"\vec{H}_C = \left( \int_B -[\vec{r}] [\vec{r}] dm \right) \vec{\omega}",
        "vec(H){_C} = [(int{_B}([-[[vec(r)] [vec(r)]]]; m)) vec(omega)]",
    ),
    (
        r"[C] = \begin{bmatrix} \vec{v}_1^T \\ \vec{v}_2^T \end{bmatrix} \quad (\vec{v}_1, \vec{v}_2) = \text{eigenvectors}",
        "[C] = bmatrix(vec(v){_1 ^T} // vec(v){_2 ^T}) ~ (vec(v){_1}, vec(v){_2}) = 'eigenvectors'",
    ),
    (
        r"T = \frac{1}{2} \int_B dm \dot{\vec{R}}_C \cdot \dot{\vec{R}}_C",
        "T = [[frac(1, 2) int{_B}(; m) dot(vec(R)){_C}] . dot(vec(R)){_C}]",
    ),
    (
        r"T = \frac{1}{2} \vec{\omega} \cdot \underbrace{\int_B \vec{r} \times (\vec{\omega} \times \vec{r}) dm}_{\vec{H}_C}",
        "T = [[frac(1, 2) vec(omega)] . underbrace(int{_B}([vec(r) x ([vec(omega) x vec(r)])]; m); vec(H){_C})]",
    ),
    (
        r"{}^{\mathcal{I}}\frac{\mathrm{d}}{\mathrm{d}t}{}^{\mathcal{I}}\mathbf{h}_{G} = \mathbb{I}_{G} \cdot {}^{\mathcal{B}}\frac{\mathrm{d}}{\mathrm{d}t}{}^{\mathcal{I}}\boldsymbol{\omega}^{\mathcal{B}}",
        "D(*h{_G <cal:I})/t@cal:I = [bb:I{_G} . D(*omega{^cal:B <cal:I})/t@cal:B]",
    ),
    (
        r"\begin{bmatrix} {}^{\mathcal{I}}\boldsymbol{\omega}^{\mathcal{B}}\times \end{bmatrix}_{\mathcal{B}}",
        "bmatrix([*omega{^cal:B <cal:I} cross]){_cal:B}",
    ),
    (
        r"\dot{\theta} \mathbf{b}_1 + \dot{\psi} \sin \theta \mathbf{b}_2",
        "[[dot(theta) *b{_1}] + [dot(psi) sin theta *b{_2}]]",
    ),
    (
        r"I_{2} \frac{\mathrm{d}}{\mathrm{d}t} \left(\Omega + \dot{\psi}\sin\theta\right) = 0",
        "[I{_2} D(([Omega + [dot(psi) sin theta]]))/t] = 0",
    ),
    (
        r"m\underline{\rho} \times (\underline{r}_O + \underline{\rho})^\bullet",
        "[[m underline(rho)] x ([underline(r){_O} + underline(rho)]){^!bullet}]",
    ),
    (
        r"\underline{f}_i + \sum_{j=1}^N \underline{f}_{ij} = m_i \ddot{\underline{r}}_i \quad (3.5)",
        "[underline(f){_i} + sum{_j = 1 ^N}(underline(f){_[i j]})] = [m{_i} ddot(underline(r)){_i}] ~ (3.5)",
    ),
    (
        r"\underline{r}_\bullet \triangleq \frac{\sum_{i=1}^N m_i \underline{r}_i}{m}",
        "underline(r){_!bullet} := frac(sum{_i = 1 ^N}([m{_i} underline(r){_i}]), m)",
    ),
    (
        r"\sum_{i=1}^N m_i (\underline{\rho}_i \times \underline{\rho}_i^{\bullet\bullet}) - \underline{c}_O \times \underline{r}_O^{\bullet\bullet}",
        "[sum{_i = 1 ^N}([m{_i} ([underline(rho){_i} x underline(rho){_i ^!bullet!bullet}])]) - [underline(c){_O} x underline(r){_O ^!bullet!bullet}]]",
    ),
    (
        r"\underline{\mathbf{p}}^\bullet \triangleq \iiint_V \underline{\mathbf{r}}^{\bullet\bullet} \sigma(\underline{\rho}) dV",
        "underline(*p){^!bullet} := iiint{_V}([underline(*r){^!bullet!bullet} sigma (underline(rho))]; V)",
    ),
    (
        r"\mathbf{J}_B = - \int_m (\mathbf{C}_{BA} \underline{\rho}_A)^{\times} (\mathbf{C}_{BA} \underline{\rho}_A)^{\times} dm",
        "*J{_B} = [-int{_m}([([*C{_[B A]} underline(rho){_A}]){^!times} ([*C{_[B A]} underline(rho){_A}]){^!times}]; m)]",
    ),
    (
        r"\mathbf{E}^{-1} \mathbf{J}_B \mathbf{E} = \mathbf{\Lambda} \equiv \mathbf{J}_P",
        "[*E{^[-1]} *J{_B} *E] = *Lambda equiv *J{_P}",
    ),
    (r"dm = \sigma(\underline{\rho})dV", "d(m) = [sigma (underline(rho)) d(V)]"),
    (r"(\cdot)^\bullet", "(_){^!bullet}"),
    (r"|\vec{H}_C| = \text{constant}", "|vec(H){_C}| = 'constant'"),
    (
        r"\mathbf{M}: \text{ This is } \mathbf{not} \text{ a typo}",
        "*M : ' This is ' *not ' a typo'",
    ),
    (r"(\psi, \theta, \phi)^{\mathcal{I}}_{\mathcal{B}}", "(psi, theta, phi){_cal:B ^cal:I}"),
    (r"\mathbf{x}^T \mathbf{J} \mathbf{x} > 0", "[*x{^T} *J *x] > 0"),
    (r"N \rightarrow \infty", "N to infty"),
]
"""What scanned lecture notes hold, as it was read by eye."""
