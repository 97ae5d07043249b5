"""Small library for the oracles of these notes: moving frames, particle models, high-order differences."""
import random
from mpmath import mp, mpf, mpc, matrix, cos, sin, tan, sqrt, pi, exp, expm, eye, quad, atan2, ellipk, findroot, acos, arg
mp.dps=140
def rng(seed):
    r=random.Random(seed)
    return lambda a=0.4,b=1.6: mpf(r.randint(1,10**20))/10**20*(mpf(b)-mpf(a))+mpf(a)
def D(f,t,h=mpf(10)**-9):   # 10th order central difference, error ~ h^10
    c=[mpf(5)/6,-mpf(5)/21,mpf(5)/84,-mpf(5)/504,mpf(1)/1260]
    s=c[0]*(f(t+h)-f(t-h))
    for k in range(1,5): s=s+c[k]*(f(t+(k+1)*h)-f(t-(k+1)*h))
    return s/h
def V(*a): return matrix(list(a))
def X(a,b): return V(a[1]*b[2]-a[2]*b[1],a[2]*b[0]-a[0]*b[2],a[0]*b[1]-a[1]*b[0])
def dot(a,b): return sum(a[i]*b[i] for i in range(3))
def nm(a): return sqrt(dot(a,a))
def vee(S): return V((S[2,1]-S[1,2])/2,(S[0,2]-S[2,0])/2,(S[1,0]-S[0,1])/2)
def S(l):
    s=l[0]
    for x in l[1:]: s=s+x
    return s
def pol(c,t): return c[0]+t*(c[1]+t*(c[2]+t*c[3]))
def Rx(a): return matrix([[1,0,0],[0,cos(a),-sin(a)],[0,sin(a),cos(a)]])
def Ry(a): return matrix([[cos(a),0,sin(a)],[0,1,0],[-sin(a),0,cos(a)]])
def Rz(a): return matrix([[cos(a),-sin(a),0],[sin(a),cos(a),0],[0,0,1]])
def mx(*xs):
    m=mpf(0)
    for x in xs:
        m=max([m]+[abs(v) for v in x]) if isinstance(x,matrix) else max(m,abs(x))
    return m
def inertia(rs,ms):
    I=matrix(3,3)
    for x,w in zip(rs,ms):
        for i in range(3):
            for j in range(3): I[i,j]+=w*((dot(x,x) if i==j else 0)-x[i]*x[j])
    return I
class Rec:
    def __init__(s,name,n): s.name,s.n,s.d=name,n,{}
    def put(s,i,written,correction=None,only_if=None,general=None,others=None,remark=None):
        f=lambda v:mp.nstr(mpf(abs(v)),5)
        e=dict(written=f(written))
        if correction is not None: e['correction']=f(correction)
        if general is not None: e['general']=f(general)
        if only_if is not None: e['only_if']=[f(v) for v in only_if]
        if others is not None: e['others']=[f(v) for v in others]
        if remark: e['remark']=remark
        assert str(i) not in s.d; s.d[str(i)]=e
    def save(s):
        assert sorted(map(int,s.d))==list(range(1,s.n+1)),sorted(map(int,s.d))
        for i in range(1,s.n+1):
            e=s.d[str(i)]; w='HOLDS' if float(e['written'])<1e-30 else 'FAILS'
            print('%3d as written %s'%(i,w),e)
