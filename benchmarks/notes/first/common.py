"""Shared by the oracles: finds the displays of a note, keeps the truth, writes truth_NAME.json."""
import json, re, random, os
from mpmath import mp, mpf
mp.dps = 50
HERE = os.path.dirname(os.path.abspath(__file__))
ENV = r'equation\*?|align\*?|gather\*?|multline\*?'
PAT = re.compile(r'\$\$(?P<a>.+?)\$\$|\\\[(?!\d)(?P<b>.+?)\\\]|\\begin\{(?P<env>' + ENV + r')\}(?P<c>.+?)\\end\{(?P=env)\}', re.S)

def displays(name):
    # "\\[2pt]" inside a formula is a line break, not the start of a display: mask it while searching
    text = open(os.path.join(HERE, name)).read()
    masked = text.replace('\\\\[', '\\\\\x00')
    out = []
    for m in PAT.finditer(masked):
        g = next(x for x in 'abc' if m.group(x) is not None)
        raw = text[m.start(g):m.end(g)]
        s = m.start(g) + len(raw) - len(raw.lstrip())
        latex = raw.strip()
        line = text.count('\n', 0, s) + 1
        out.append((line, line + latex.count('\n'), latex))
    return out

def rnd(lo=0.3, hi=2.0, sign=False):
    v = mpf(random.randint(1, 10**12)) / mpf(10**12) * (hi - lo) + lo
    return -v if sign and random.random() < .5 else v

class Note:
    def __init__(self, name):
        self.name = name; self.d = displays(name); self.e = {}; random.seed(name)
    def latex(self, k): return self.d[k-1][2]
    def _z(self, f, want, tol, what, n=4):
        worst = [abs(f()) for _ in range(n)]
        if want: assert max(worst) < tol, (self.name, what, 'should vanish', worst)
        else: assert min(worst) > mpf('1e-6'), (self.name, what, 'should not vanish', worst)
    def _base(self, k, verdict, **kw):
        assert k not in self.e
        line, end, latex = self.d[k-1]
        self.e[k] = dict(note=self.name, index=k, line=line, end_line=end, latex=latex, verdict=verdict,
                         assumptions=[], assumption_alternatives=[], stated_in_note=[], also_accept=[])
        self.e[k].update(kw)
    def definition(self, k, check=None, tol=mpf('1e-25'), **kw):
        if check: self._z(check, True, tol, k)
        self._base(k, 'definition', **kw)
    def holds(self, k, f, tol=mpf('1e-25'), **kw):
        self._z(f, True, tol, k); self._base(k, 'holds', **kw)
    def under(self, k, general, cases, corrected=None, tol=mpf('1e-25'), **kw):
        """general residual must not vanish; cases: residuals under the assumption and each alternative"""
        self._z(general, False, 0, k)
        for i, c in enumerate(cases): self._z(c, True, tol, (k, 'case', i))
        if corrected: self._z(corrected, True, tol, (k, 'general form'))
        assert len(cases) == 1 + len(kw.get('assumption_alternatives', [])), k
        self._base(k, 'holds_under', **kw)
    def wrong(self, k, written, repl, corrected, slip, others=(), special=(), tol=mpf('1e-25'), wrong_term=None, missing=None, part=None, remark=None, **kw):
        """repl=(old,new) turns the line into its correction; others=[(latex,residual)], special=[(text,residual)]"""
        L = self.latex(k); old, new = repl
        assert L.count(old) == 1, (self.name, k, old, L.count(old))
        wt = old if wrong_term is None else wrong_term
        assert wt in L and L.count(wt) == 1, (self.name, k, wt)
        self._z(written, False, 0, k); self._z(corrected, True, tol, (k, 'corrected'))
        for t, f in others: self._z(f, True, tol, (k, t))
        for t, f in special: self._z(f, True, tol, (k, 'special', t))
        d = dict(wrong_term=wt, missing_term=missing, wrong_part=part, correction=L.replace(old, new),
                 other_corrections=[t for t, _ in others], slip=slip, true_only_if=[t for t, _ in special])
        if remark: d['remark'] = remark
        d.update(kw); self._base(k, 'wrong', **d)
    def finish(self):
        assert sorted(self.e) == list(range(1, len(self.d)+1)), (sorted(self.e), len(self.d))
        out = [self.e[k] for k in sorted(self.e)]
        stem = self.name.split('.')[0]
        kept = [e for e in json.load(open(os.path.join(HERE, 'truth.json'))) if e['note'].split('.')[0] == stem]
        assert [e['verdict'] for e in kept] == [e['verdict'] for e in out], stem
        from collections import Counter
        print(self.name, len(out), dict(Counter(x['verdict'] for x in out)), 'OK')
