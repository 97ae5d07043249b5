r"""What the commands of LaTeX and the characters of Unicode are to the reader, as tables.

Sources: The LaTeX2e sources; the packages amsmath, mathtools, physics, mathabx, tensor.
"""

from __future__ import annotations


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


def _pairs(text: str) -> dict[str, str]:
    """Return a mapping from ``command:name`` words; a bare word is its own name."""
    parts = [w.partition("=>") for w in text.split()]
    return {left: right or left for left, _, right in parts}


SYMBOLS = _words(
    "alpha beta gamma delta epsilon varepsilon zeta eta theta vartheta iota kappa lambda mu nu xi "
    "omicron pi varpi rho varrho sigma varsigma tau upsilon phi varphi chi psi omega Gamma Delta "
    "Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega Alpha Beta Epsilon Zeta Eta Iota Kappa Mu Nu "
    "Omicron Rho Tau Chi digamma ell hbar nabla infty emptyset varnothing Re Im wp aleph imath "
    "jmath top bot bullet degree angle triangle square Box diamond clubsuit odotsign earth sun "
    "varDelta varGamma varOmega varTheta varPhi varPsi varLambda varSigma complement"
)
"""Commands that are symbols by their own name."""

SYMBOL_ALIASES = _pairs(
    "intercal=>top Earth=>earth Sun=>sun astrosun=>sun thicksim=>sim grad=>nabla qedsymbol=>Box"
)

SCRIPT_MARKS = _pairs(
    "times bullet circ=>circ ast=>ast star prime dagger ddagger cross=>times wedge=>wedge "
    "cdot=>cdot diamond=>diamond perp=>perp parallel=>parallel otimes=>otimes oplus=>oplus "
    "ominus=>ominus odot=>odot sim=>sim triangle=>triangle backprime=>prime degree=>circ "
    "vee=>vee land=>wedge pm=>pm mp=>mp"
)
"""Commands that stand in a script as a mark: names of `Marks`."""
SCRIPT_CHARACTERS = {
    "*": "ast",
    "+": "+",
    "-": "-",
    "'": "prime",
    "~": "sim",
    "|": "|",
    "=": "=",
    "!": "!",
}

FUNCTIONS = _words(
    "sin cos tan cot sec csc sinh cosh tanh coth arcsin arccos arctan exp ln log lg det dim ker "
    "max min sup inf lim limsup liminf arg gcd deg hom Pr tr trace rank diag skew sgn sign atan2 "
    "asin acos atan adj vex vec mod div curl rot sech csch arccot sinc atan Tr Diag blkdiag "
    "Skew cross unskew"
)
"""Functions by command, or by an upright name in front of an argument."""
FUNCTION_ALIASES = _pairs("arctg=>arctan tg=>tan ctg=>cot sh=>sinh ch=>cosh th=>tanh trace=>tr")
COMMAND_FUNCTIONS = FUNCTIONS - _words(
    "vec div rot skew sign mod cross dim deg arg hom trace rank diag sgn atan2 asin acos atan adj "
    "vex curl tr sech csch arccot sinc Tr Diag blkdiag Skew unskew"
) | _words("tr Tr arg dim deg hom")

FONTS = _pairs(
    "mathbf=>bold boldsymbol=>bold bm=>bold pmb=>bold mathbfit=>bold symbf=>bold symbfit=>bold "
    "vb=>bold vectorbold=>bold mathrm=>roman symrm=>roman mathup=>roman mathcal=>calligraphic "
    "mathscr=>calligraphic symcal=>calligraphic mathbb=>blackboard mathds=>blackboard mathsf=>sans "
    "mathsfbf=>bold mathfrak=>fraktur mathtt=>typewriter"
) | {"mathit": "", "mathnormal": ""}
SWITCHES = _pairs(
    "bf=>bold bfseries=>bold rm=>roman cal=>calligraphic sf=>sans tt=>typewriter boldmath=>bold"
) | {"it": ""}
"""Fonts that hold to the end of a group."""

ACCENTS = _pairs(
    "vec hat bar tilde dot ddot dddot ddddot underline check breve acute grave mathring=>ring "
    "widehat=>hat widetilde=>tilde overline=>bar overrightarrow=>vec overleftarrow=>underarrow "
    "overrightharpoon=>harpoon overleftrightarrow=>double_bar utilde=>undertilde "
    "undertilde=>undertilde underrightarrow=>underarrow widebar=>bar underbar=>underline "
    "ring=>ring accentset=>ring vv=>vec va=>vec vu=>hat"
)

RELATION_COMMANDS = _pairs(
    "triangleq=>:= coloneqq=>:= coloneq=>:= defeq=>:= eqdef=>:= doteq=>:= vcentcolon=>:= "
    "equiv approx simeq cong sim propto neq=>!= ne=>!= lt=>< gt=>> le=><= leq=><= leqslant=><= "
    "ge=>>= geq=>>= geqslant=>>= ll=><< gg=>>> in notin subset subseteq=>subset parallel perp to "
    "rightarrow=>to longrightarrow=>to leftarrow=>from longleftarrow=>from gets=>from mapsto "
    "leftrightarrow=>between longmapsto=>mapsto approxeq=>approx thickapprox=>approx eq=>= "
    "varpropto=>propto"
) | {"eqqcolon": "=:"}
RELATION_CHARACTERS = {"=": "=", "<": "<", ">": ">"}

ARROW_COMMANDS = _pairs(
    "Rightarrow=>implies implies Longrightarrow=>implies Leftrightarrow=>equivalent "
    "Longleftrightarrow=>equivalent iff=>equivalent therefore because Rrightarrow=>implies"
) | {
    "Leftarrow": "implied by",
    "impliedby": "implied by",
    "Longleftarrow": "implied by",
    "hookrightarrow": "leads to",
    "leadsto": "leads to",
    "rightsquigarrow": "leads to",
}

PRODUCT_COMMANDS = _pairs(
    "cdot=>dot vdot=>dot cdotp=>dot times=>cross cross cp=>cross crossproduct=>cross "
    "dotproduct=>dot wedge land=>wedge otimes=>tensor odot=>circledot circ=>circle ast=>asterisk "
    "star div=>divided oplus=>circledplus ominus=>circledminus"
) | {"boxtimes": "direct cross", "colon": "double dot"}
PRODUCT_CHARACTERS = {"*": "asterisk", ":": "double dot"}
LOOSE_PRODUCTS = frozenset({"dot", "double dot"})
"""Operators that bind less than a cross."""

SUM_SIGNS = {"+": "+", "-": "-"}
SUM_COMMANDS = {"pm": "±", "mp": "∓"}

BIG_OPERATORS = _pairs("sum prod bigoplus bigotimes bigcup bigcap coprod bigwedge bigsum=>sum")
INTEGRALS = _pairs("int iint iiint oint idotsint=>iiint oiint=>oint intop=>int iiiint=>iiint")

SPACES = _words(", : ; ! > enspace thinspace medspace thickspace negthinspace negmedspace space /")
QUADS = _words("quad qquad hfill hfil par newline linebreak nobreakspace enskip")
IGNORED = _words(
    "displaystyle textstyle scriptstyle scriptscriptstyle limits nolimits nonumber notag allowbreak "
    "nobreak hline toprule midrule bottomrule centering noindent null relax mathstrut strut "
    "mathord mathbin mathrel mathopen mathclose mathpunct mathinner smash mathop hskip "
    "displaylimits protect ensuremath footnotesize small normalsize large Large scriptsize "
    "qedhere bigskip medskip smallskip checkmark blacksquare qed"
)
"""Commands that change how things look and not what stands there."""
IGNORED_WITH_ARGUMENT = _words(
    "hspace vspace label color phantom hphantom vphantom kern mspace rule vskip cellcolor rowcolor "
    "raisebox setlength arraystretch cline extracolsep pagebreak"
)
"""Spacing and colour with one argument in braces, which is not shown."""
TRANSPARENT_SECOND = _words("textcolor colorbox href mathcolor scalebox raisebox class cssId style")
"""Commands whose second argument is shown."""

TEXTS = _words(
    "text mbox textrm textit textbf textnormal intertext shortintertext hbox textsf texttt fbox "
    "textup emph textsc makebox qq"
)
"""Commands whose argument is text."""

DOTS = _pairs(
    "cdots ldots=>cdots dots=>cdots dotsc=>cdots dotsb=>cdots dotsm=>cdots dotsi=>cdots "
    "vdots ddots hdots=>cdots dotso=>cdots iddots=>ddots"
)

FRACTIONS = _words("frac dfrac tfrac cfrac nicefrac sfrac flatfrac")
DELIMITERS = _pairs(
    "lvert=>| rvert=>| vert=>| lVert=>|| rVert=>|| Vert=>|| |=>|| { } lbrace=>{ rbrace=>} langle=>< "
    "rangle=>> lbrack=>[ rbrack=>] lfloor=>⌊ rfloor=>⌋ lceil=>⌈ rceil=>⌉ lparen=>( rparen=>)"
)
PAIRS = {"(": ")", "[": "]", "{": "}", "<": ">", "|": "|", "||": "||", "⌊": "⌋", "⌈": "⌉"}
SIZES = _words(
    "big Big bigg Bigg bigl Bigl biggl Biggl bigr Bigr biggr Biggr bigm Bigm biggm Biggm"
)

MATRICES = _words(
    "matrix bmatrix pmatrix vmatrix Vmatrix Bmatrix array smallmatrix psmallmatrix bsmallmatrix "
    "vsmallmatrix tabular bNiceMatrix pNiceMatrix bNiceArray pNiceArray"
)
CASES = _pairs("cases=>left dcases=>left rcases=>right drcases=>right numcases=>left")
ALIGNMENTS = _words(
    "aligned alignedat split gathered multlined align alignat flalign gather multline equation "
    "eqnarray displaymath math subequations empheq dmath"
)
WITH_SPECIFICATION = _words(
    "array tabular alignedat alignat bNiceArray pNiceArray numcases empheq xalignat"
)
"""Environments with an argument in braces."""
DISPLAYS = _words(
    "equation align alignat flalign gather multline eqnarray displaymath dmath xalignat"
)
"""Environments that are displays by themselves."""

CHARACTERS = _pairs(
    "α=>alpha β=>beta γ=>gamma δ=>delta ε=>epsilon ζ=>zeta η=>eta θ=>theta ι=>iota κ=>kappa "
    "λ=>lambda μ=>mu ν=>nu ξ=>xi ο=>omicron π=>pi ρ=>rho σ=>sigma τ=>tau υ=>upsilon φ=>phi χ=>chi "
    "ψ=>psi ω=>omega Α=>Alpha Β=>Beta Γ=>Gamma Δ=>Delta Ε=>Epsilon Ζ=>Zeta Η=>Eta Θ=>Theta Ι=>Iota "
    "Κ=>Kappa Λ=>Lambda Μ=>Mu Ν=>Nu Ξ=>Xi Ο=>Omicron Π=>Pi Ρ=>Rho Σ=>Sigma Τ=>Tau Υ=>Upsilon Φ=>Phi "
    "Χ=>Chi Ψ=>Psi Ω=>Omega ς=>varsigma ϕ=>phi ϑ=>vartheta ϵ=>epsilon ϱ=>varrho ×=>times ·=>cdot "
    "⋅=>cdot ∙=>cdot •=>bullet ±=>pm ∓=>mp ≈=>approx ≠=>neq ≤=>leq ≥=>geq ≡=>equiv ≜=>triangleq "
    "≔=>triangleq →=>to ⇒=>Rightarrow ⟹=>Rightarrow ⇔=>Leftrightarrow ⟺=>iff ←=>leftarrow ↦=>mapsto "
    "∴=>therefore ∵=>because ∫=>int ∬=>iint ∭=>iiint ∮=>oint ∑=>sum ∏=>prod ∂=>partial ∇=>nabla "
    "√=>sqrt ∞=>infty ∈=>in ⊗=>otimes ⊙=>odot ∘=>circ ○=>circ ◦=>circ ⊤=>top ∧=>wedge ⟂=>perp "
    "⊥=>perp ∥=>parallel ∝=>propto ∼=>sim ≃=>simeq ≪=>ll ≫=>gg …=>dots ⋯=>cdots ⋮=>vdots ⋱=>ddots "
    "ℓ=>ell ℏ=>hbar ∀=>forall ∃=>exists ⟨=>langle ⟩=>rangle ‖=>Vert ∗=>ast ⋆=>star ⊕=>oplus"
)
"""A character that is a command."""
PLAIN_CHARACTERS = {
    "−": "-",
    "–": "-",
    "∕": "/",
    "⁄": "/",
    "′": "'",
    "’": "'",
    "‘": "'",
    "″": "''",
    "\u00a0": " ",
    "\u2009": " ",
    "\u202f": " ",
    "\u2002": " ",
    "\u2003": " ",
    "\u200b": " ",
    "\ufeff": " ",
    "\u2061": " ",
    "\u2062": " ",
    "\ufe0f": " ",
    "＝": "=",
    "（": "(",
    "）": ")",
    "∣": "|",
}
"""A character that stands for others on the keyboard."""
SUPERSCRIPTS = dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻ᵀⁿⁱ", "0123456789+-Tni", strict=True))
SUBSCRIPTS = dict(zip("₀₁₂₃₄₅₆₇₈₉₊₋ₐₑᵢⱼₖₙₓ", "0123456789+-aeijknx", strict=True))
COMBINING = _pairs(
    "\u0307=>dot \u0308=>ddot \u20db=>dddot \u20d7=>vec \u0302=>hat \u0303=>tilde \u0304=>bar "
    "\u0305=>bar \u0332=>underline \u0331=>underline \u030a=>ring \u030c=>check \u0306=>breve "
    "\u0301=>acute \u0300=>grave"
)

KNOWN = frozenset().union(
    *(SYMBOLS, SYMBOL_ALIASES, SCRIPT_MARKS, COMMAND_FUNCTIONS, FUNCTION_ALIASES, FONTS, SWITCHES),
    *(ACCENTS, RELATION_COMMANDS, ARROW_COMMANDS, PRODUCT_COMMANDS, SUM_COMMANDS, BIG_OPERATORS),
    *(INTEGRALS, SPACES, QUADS, IGNORED, IGNORED_WITH_ARGUMENT, TRANSPARENT_SECOND, TEXTS, DOTS),
    *(FRACTIONS, DELIMITERS, SIZES),
    _words(
        "left right middle begin end sqrt boxed prescript leftidx sideset partial cancel cancelto "
        "bcancel xcancel underbrace overbrace overset underset stackrel substack abs norm qty dv pdv "
        "dd not over forall SI num ang si unit eqno leqno exists operatorname tag label xrightarrow"
    ),
)
"""All commands that the reader knows."""
