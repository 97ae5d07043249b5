"""A small evaluator for scalar LaTeX: the line itself, not a transcription, is put to the test."""
import re
from mpmath import mp, mpf, sin, cos, sqrt, log
TOK=re.compile(r'\\[A-Za-z]+|\\.|[0-9]|[A-Za-z]|[^\s]')
DROP={r'\,',r'\;',r'\!',r'\ ',r'\left',r'\right',r'\quad',r'\qquad','&'}
def toks(s): return [t for t in TOK.findall(re.sub(r'\\tag\{[^}]*\}|\\label\{[^}]*\}','',s)) if t not in DROP]
class Ev:
    def __init__(self,env): self.env=sorted(((toks(k),v) for k,v in env.items()),key=lambda q:-len(q[0]))
    def __call__(self,s):
        self.t=toks(s); self.i=0; v=self.expr()
        assert self.i==len(self.t),('left over',self.t[self.i:],s); return v
    def pk(self): return self.t[self.i] if self.i<len(self.t) else None
    def nx(self): self.i+=1; return self.t[self.i-1]
    def expr(self):
        v=mpf(0); s=1
        if self.pk() in('+','-'): s=-1 if self.nx()=='-' else 1
        v=s*self.term()
        while self.pk() in('+','-'): s=-1 if self.nx()=='-' else 1; v+=s*self.term()
        return v
    def term(self):
        v=self.fac()
        while self.pk() not in(None,'+','-',')',']','}',',','.','='):
            if self.pk()==r'\cdot': self.nx(); continue
            v*=self.fac()
        return v
    def grp(self):
        if self.pk()=='{':
            self.nx(); v=self.expr(); assert self.nx()=='}'; return v
        t=self.pk()
        if t.isdigit(): self.nx(); return mpf(t)
        return self.atom()
    def sym(self):
        for k,v in self.env:
            if self.t[self.i:self.i+len(k)]==k: self.i+=len(k); return v
        return None
    def atom(self):
        v=self.sym()
        if v is not None: return v
        t=self.nx()
        if t.isdigit():
            while self.pk() and (self.pk().isdigit() or (self.pk()=='.' and self.i+1<len(self.t) and self.t[self.i+1].isdigit())): t+=self.nx()
            return mpf(t)
        if t in('(','['): v=self.expr(); assert self.nx() in(')',']'); return v
        if t=='{': v=self.expr(); assert self.nx()=='}'; return v
        if t in(r'\frac',r'\tfrac',r'\dfrac'): a=self.grp(); b=self.grp(); return a/b
        if t==r'\sqrt': return sqrt(self.grp())
        if t in(r'\sin',r'\cos',r'\ln'):
            p=None
            if self.pk()=='^': self.nx(); p=self.grp()
            a=self.atom(); v={r'\sin':sin,r'\cos':cos,r'\ln':log}[t](a); return v if p is None else v**p
        raise ValueError((t,self.t[max(0,self.i-5):self.i+5]))
    def fac(self):
        v=self.atom()
        while self.pk()=='^': self.nx(); v=v**self.grp()
        return v
