"""Small helper of the oracles: jets (truncated Taylor series in time), random numbers, book-keeping against truth.json."""
import json, random
import numpy as np
from mpmath import mp, mpf
import mpmath
mp.dps=50
TOL=mpf(10)**-30
ORD=5
class Jet:
    __slots__=('c',)
    def __init__(s,c): s.c=[mpf(x) for x in c][:ORD]+[mpf(0)]*max(0,ORD-len(c))
    @staticmethod
    def of(x): return x if isinstance(x,Jet) else Jet([x])
    def __add__(s,o): o=Jet.of(o); return Jet([a+b for a,b in zip(s.c,o.c)])
    __radd__=__add__
    def __neg__(s): return Jet([-a for a in s.c])
    def __sub__(s,o): return s+(-Jet.of(o))
    def __rsub__(s,o): return Jet.of(o)-s
    def __mul__(s,o):
        if not isinstance(o,Jet): return Jet([a*o for a in s.c])
        return Jet([mp.fsum(s.c[i]*o.c[k-i] for i in range(k+1)) for k in range(ORD)])
    __rmul__=__mul__
    def inv(s):
        r=[1/s.c[0]]
        for k in range(1,ORD): r.append(-mp.fsum(s.c[i]*r[k-i] for i in range(1,k+1))/s.c[0])
        return Jet(r)
    def __truediv__(s,o): return s*Jet.of(o).inv() if isinstance(o,Jet) else s*(mpf(1)/o)
    def __rtruediv__(s,o): return Jet.of(o)*s.inv()
    def __pow__(s,n):
        r=Jet([1])
        for _ in range(abs(n)): r=r*s
        return r if n>=0 else r.inv()
    def d(s): return Jet([(k+1)*s.c[k+1] for k in range(ORD-1)]+[0])   # last coefficient lost: never used
    def at(s): return s.c[0]
def _comp(x,f0,df):   # y with y' = df(y, x) * x'
    raise NotImplementedError
def sincos(x):
    s=[mp.sin(x.c[0])]; c=[mp.cos(x.c[0])]
    for k in range(1,ORD):
        s.append(mp.fsum(i*x.c[i]*c[k-i] for i in range(1,k+1))/k)
        c.append(-mp.fsum(i*x.c[i]*s[k-i] for i in range(1,k+1))/k)
    return Jet(s),Jet(c)
def sin(x): return sincos(x)[0] if isinstance(x,Jet) else mp.sin(x)
def cos(x): return sincos(x)[1] if isinstance(x,Jet) else mp.cos(x)
def sqrt(x):
    if not isinstance(x,Jet): return mp.sqrt(x)
    r=[mp.sqrt(x.c[0])]
    for k in range(1,ORD): r.append((x.c[k]-mp.fsum(r[i]*r[k-i] for i in range(1,k)))/(2*r[0]))
    return Jet(r)
def atan(x):
    if not isinstance(x,Jet): return mp.atan(x)
    g=x.d()/(1+x*x); return Jet([mp.atan(x.c[0])]+[g.c[k-1]/k for k in range(1,ORD)])
def D(a):  # time derivative, elementwise
    if isinstance(a,np.ndarray): 
        out=np.empty(a.shape,dtype=object)
        for i in np.ndindex(a.shape): out[i]=Jet.of(a[i]).d()
        return out
    return Jet.of(a).d()
def V(a):  # value at t = 0
    if isinstance(a,np.ndarray):
        out=np.empty(a.shape,dtype=object)
        for i in np.ndindex(a.shape): out[i]=a[i].at() if isinstance(a[i],Jet) else mpf(a[i])
        return out
    return a.at() if isinstance(a,Jet) else mpf(a)
def A(x): return np.array(x,dtype=object)
def cross(a,b): return A([a[1]*b[2]-a[2]*b[1],a[2]*b[0]-a[0]*b[2],a[0]*b[1]-a[1]*b[0]])
def skew(a): return A([[0*a[0],-a[2],a[1]],[a[2],0*a[0],-a[0]],[-a[1],a[0],0*a[0]]])
def dot(a,b): return sum(x*y for x,y in zip(a,b))
def eye(n=3): return A([[mpf(int(i==j)) for j in range(n)] for i in range(n)])
def norm(a): return mp.sqrt(sum(x*x for x in a))
def unit(a):
    n=sqrt(sum(x*x for x in a)); return A([x/n for x in a])
def inv(M): 
    n=M.shape[0]; r=mp.matrix([[M[i,j] for j in range(n)] for i in range(n)])**-1
    return A([[r[i,j] for j in range(n)] for i in range(n)])
def det(M): return mp.det(mp.matrix([[x for x in row] for row in M]))
def solve(M,b):
    x=mp.lu_solve(mp.matrix([[y for y in r] for r in M]),mp.matrix(list(b))); return A([x[i] for i in range(len(b))])
rng=random.Random(20261)
def rnd(a=-1,b=1): return mpf(a)+(mpf(b)-mpf(a))*mpf(rng.randrange(10**15))/mpf(10**15)
def rvec(n=3,a=-1,b=1): return A([rnd(a,b) for _ in range(n)])
def rjet(a=-1,b=1): return Jet([rnd(a,b)]+[rnd(-1,1) for _ in range(ORD-1)])
def EPS(i,j,k): return mpf((i-j)*(j-k)*(k-i))/2
def rot_about(n,x):  # active rotation about the unit vector n (numbers) by the angle x, from its geometry
    n=A(n)
    def f(v):
        par=n*dot(n,v); per=v-par
        return par+per*cos(x)+cross(n,per)*sin(x)
    return f
def flat(x):
    if isinstance(x,np.ndarray): return [V(y) for y in x.ravel()]
    if isinstance(x,(list,tuple)): return [z for y in x for z in flat(y)]
    return [V(x)]
def eq(a,b):
    """relative difference of two sides (numbers, jets at t=0 or arrays)"""
    a,b=flat(a),flat(b); assert len(a)==len(b),(len(a),len(b))
    sc=max([abs(x) for x in a+b]+[mpf(10)**-20])
    return max(abs(x-y) for x,y in zip(a,b))/sc
class Orc:
    def __init__(s,note):
        s.note=note
        s.t=[e for e in json.load(open('truth.json')) if e['note']==note]
        s.seen={}
    def e(s,k): return s.t[k-1]
    def z(s,r): return all(abs(x)<TOL for x in r)
    def rec(s,k,written,corrected=None,others=(),under=None,alts=(),general=None,special=(),bad=None):
        """every argument: list of residuals of the parts of the display on one random model.
        bad: set of the parts that must fail (all other parts must hold); default: at least one part fails."""
        e=s.e(k); v=e['verdict']
        written=list(written)
        if v in('holds','definition'):
            assert s.z(written),(s.note,k,v,written)
        elif v=='wrong':
            f={i for i,x in enumerate(written) if abs(x)>mpf('1e-6')}
            g={i for i,x in enumerate(written) if abs(x)<TOL}
            assert f and len(f)+len(g)==len(written),(s.note,k,written)
            if bad is not None: assert f==set(bad),(s.note,k,f,bad)
            assert corrected is not None and s.z(corrected),(s.note,k,'correction',corrected)
            assert len(others)==len(e['other_corrections']),(s.note,k,'others')
            for o in others: assert s.z(o),(s.note,k,'other',o)
            for o in special: assert s.z(o),(s.note,k,'special',o)
        else:
            f={i for i,x in enumerate(written) if abs(x)>mpf('1e-8')}
            assert f,(s.note,k,'should fail in general',written)
            if bad is not None: assert f==set(bad)
            assert under is not None and s.z(under),(s.note,k,'under',under)
            for o in alts: assert s.z(o),(s.note,k,'alt',o)
            assert general is not None and s.z(general),(s.note,k,'general',general)
        s.seen[k]=s.seen.get(k,0)+1
    def definition(s,k):
        assert s.e(k)['verdict']=='definition',(s.note,k); s.seen[k]=s.seen.get(k,0)+1
    def done(s):
        miss=[e['index'] for e in s.t if e['index'] not in s.seen]
        assert not miss,(s.note,'not covered',miss)
        import collections
        print(s.note,'all',len(s.t),'displays agree with truth:',dict(collections.Counter(e['verdict'] for e in s.t)),'checks',sum(s.seen.values()))
