import json, random
from mpmath import mp, mpf, matrix, cos, sin, sqrt, pi, log, tan, quad, norm, eye, expm
mp.dps=60
def rng(seed):
    r=random.Random(seed)
    return lambda a=0.3,b=1.7: mpf(r.randint(1,10**18))/10**18*(mpf(b)-mpf(a))+mpf(a)
H=mpf(10)**-20
def d(f,t):           # central 4th-order difference: error ~ H^4, rounding ~ 1e-40
    g=lambda s:f(t+s*H)
    return (g(-2)-8*g(-1)+8*g(1)-g(2))/(12*H)
def cross(a,b): return matrix([a[1]*b[2]-a[2]*b[1],a[2]*b[0]-a[0]*b[2],a[0]*b[1]-a[1]*b[0]])
def dot(a,b): return sum(a[i]*b[i] for i in range(3))
def hat(w): return matrix([[0,-w[2],w[1]],[w[2],0,-w[0]],[-w[1],w[0],0]])
def vee(S): return matrix([S[2,1],S[0,2],S[1,0]])
def mx(*xs):
    m=mpf(0)
    for x in xs:
        if isinstance(x,matrix): m=max([m]+[abs(v) for v in x])
        else: m=max(m,abs(x))
    return m
class Rec:
    def __init__(s,name,n): s.name=name;s.n=n;s.d={}
    def put(s,i,written=None,correction=None,others=None,only_if=None,general=None,remark=None):
        e={}
        for k,v in dict(written=written,correction=correction,general=general).items():
            if v is not None: e[k]=mp.nstr(mpf(v),5)
        if only_if is not None: e['only_if']=[mp.nstr(mpf(v),5) for v in only_if]
        if others is not None: e['others']=[mp.nstr(mpf(v),5) for v in others]
        if remark: e['remark']=remark
        s.d[str(i)]=e
    def save(s):
        assert sorted(map(int,s.d))==list(range(1,s.n+1)),sorted(map(int,s.d))
        json.dump(s.d,open('results_%s.json'%s.name,'w'),indent=1)
        for i in range(1,s.n+1): print(i,s.d[str(i)])
