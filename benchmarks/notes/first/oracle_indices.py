from common import *; from vec import *
from mpmath import mp, mpf, sin, cos, sqrt, pi
import sympy as S, itertools
N=Note('indices.tex')
r3=range(3); dl=lambda i,j: mpf(i==j)
EPS={}
for p in itertools.permutations(r3):
    EPS[p]=mpf(S.LeviCivita(*p))
ep=lambda i,j,k: EPS.get((i,j,k),mpf(0))
TOL=mpf('1e-12')
class Mod: pass
def inertia(ms,xs): return matrix(3,3)+matrix([[sum(m*(dl(i,j)*dot(x,x)-x[i]*x[j]) for m,x in zip(ms,xs)) for j in r3] for i in r3])
def model(n=7,Rfun=None,X=None,ms=None,sym=None):
    """rigid set of particles (the integral over rho dV is a sum over mass points), fixed point O, space axes"""
    o=Mod(); o.t=t=mpf('0.3'); o.m=ms or [rnd() for _ in range(n)]; o.X=X or [rv() for _ in range(n)]
    o.R=Rfun or rrot()
    o.xf=lambda t:[o.R(t)*X for X in o.X]; o.x=o.xf(t)
    o.w=angvel(o.R,t); o.v=[D(lambda s,X=X:o.R(s)*X,t) for X in o.X]
    o.I=inertia(o.m,o.x); o.M=sum(o.m); o.d=sum((m*x for m,x in zip(o.m,o.x)),V(0,0,0))/o.M
    o.W=matrix([[sum(-ep(i,j,k)*o.w[k] for k in r3) for j in r3] for i in r3])
    return o
def mm(A): return nrm(matrix(A))
N.definition(1,lambda:(lambda o:nrm(o.I-o.I.T))(model()))
def f2():
    return sum(abs(sum(ep(i,j,k)*ep(i,l,m) for i in r3)-dl(j,l)*dl(k,m)+dl(j,m)*dl(k,l)) for j in r3 for k in r3 for l in r3 for m in r3)
N.holds(2,f2)
N.definition(3,lambda:(lambda o:nrm(o.v[0]-o.W*o.x[0]))(model()),tol=TOL)
K=lambda:(lambda Q:model(Rfun=lambda s:Q))(randrot())   # a body at rest
def f4(sg,par=False,rest=False):
    def f():
        o=K() if rest else model(); x=o.x[0]; v=o.v[0]
        if par: x=o.w*rnd(); v=o.W*x
        return nrm(V(*[v[i]-sg*sum(ep(i,j,k)*x[j]*o.w[k] for j in r3 for k in r3) for i in r3]))
    return f
N.wrong(4,f4(1),(r'x_j\,\omega_k',r'\omega_j\,x_k'),f4(-1),'exchanged indices (sign of the cross product)',tol=TOL,
  others=[(r'v_i=-\epsilon_{ijk}\,x_j\,\omega_k',f4(-1)),(r'v_i=\Omega_{ij}\,x_j',lambda:(lambda o:nrm(o.v[0]-o.W*o.x[0]))(model()))],
  special=[('the element lies on the axis of rotation (x parallel to omega)',f4(1,True)),('omega = 0',f4(1,rest=True))])
def Lv(o): return sum((m*cross(x,v) for m,x,v in zip(o.m,o.x,o.v)),V(0,0,0))
def f5():
    o=model(); L=V(*[sum(m*ep(i,j,k)*x[j]*v[k] for m,x,v in zip(o.m,o.x,o.v) for j in r3 for k in r3) for i in r3])
    L2=V(*[sum(m*(dot(x,x)*o.w[i]-x[i]*dot(x,o.w)) for m,x in zip(o.m,o.x)) for i in r3])
    return nrm(L-Lv(o))+nrm(L-L2)+nrm(L-o.I*o.w)
N.holds(5,f5,tol=TOL)
def f6(k,rest=False):
    def f():
        o=K() if rest else model(); T=sum(m*dot(v,v) for m,v in zip(o.m,o.v))/2
        return abs(T-dot(o.w,o.I*o.w)/2)+abs(T-k*dot(Lv(o),o.w))
    return f
N.wrong(6,f6(1),(r'=L_i\,\omega_i',r'=\tfrac12\,L_i\,\omega_i'),f6(mpf(1)/2),'missing factor 1/2 in the last member',wrong_term=r'L_i\,\omega_i',part='last member of the chain',tol=TOL,
  special=[('omega = 0',f6(1,True))])
J=lambda o:matrix([[sum(m*x[i]*x[j] for m,x in zip(o.m,o.x)) for j in r3] for i in r3])
tr=lambda A:sum(A[i,i] for i in r3)
N.definition(7,lambda:(lambda o:nrm(o.I-tr(J(o))*eye(3)+J(o)))(model()))
f8=lambda k:lambda:(lambda o:nrm(J(o)-k*tr(o.I)*eye(3)+o.I))(model())
N.wrong(8,f8(1),(r'I_{kk}\,\delta_{ij}',r'\tfrac12\,I_{kk}\,\delta_{ij}'),f8(mpf(1)/2),'missing factor 1/2 at the trace')
def f9():
    o=model(); IG=inertia(o.m,[x-o.d for x in o.x]); d=o.d
    return mm([[o.I[i,j]-IG[i,j]-o.M*(dot(d,d)*dl(i,j)-d[i]*d[j]) for j in r3] for i in r3])
N.holds(9,f9)
def f10(case=None,gen=False):
    def f():
        o=model(); b=rv()
        if case=='G':
            dX=sum((m*X for m,X in zip(o.m,o.X)),V(0,0,0))/o.M; o=model(X=[X-dX for X in o.X],ms=o.m,Rfun=o.R)
        if case=='Q': b=V(0,0,0)
        IQ=inertia(o.m,[x+b for x in o.x]); d=o.d
        e=lambda i,j:IQ[i,j]-o.I[i,j]-o.M*(dot(b,b)*dl(i,j)-b[i]*b[j])-(o.M*(2*dot(b,d)*dl(i,j)-b[i]*d[j]-d[i]*b[j]) if gen else 0)
        return mm([[e(i,j) for j in r3] for i in r3])
    return f
N.under(10,f10(),[f10('G'),f10('Q')],corrected=f10(gen=True),assumptions=['O is the mass centre (d_i = 0)'],assumption_alternatives=[['Q coincides with O']],
  general_form=r'I^{Q}_{ij}=I_{ij}+M\left(b_kb_k\,\delta_{ij}-b_ib_j\right)+M\left(2\,b_kd_k\,\delta_{ij}-b_id_j-d_ib_j\right)',also_accept=['wrong'],
  remark='the note says that O is the fixed point and G another point, so that a reader may call the line wrong')
def f11(t,case=None):
    def f():
        o=model()
        a=randrot()        # x' = a x
        if case=='sym': n=rv(); n=n/sqrt(dot(n,n)); a=2*n*n.T-eye(3)
        if case=='sph':
            o.I=eye(3)*rnd(); Ip=a*o.I*a.T
        else: Ip=inertia(o.m,[a*x for x in o.x])
        A=a.T if t else a
        return mm([[Ip[i,j]-sum(A[i,k]*A[j,l]*o.I[k,l] for k in r3 for l in r3) for j in r3] for i in r3])
    return f
N.wrong(11,f11(1),(r'a_{ki}\,a_{lj}',r'a_{ik}\,a_{jl}'),f11(0),'transposed direction cosines',
  others=[(r"I_{ij}=a_{ki}\,a_{lj}\,I'_{kl}",f11(0))],
  special=[('a_ij symmetric (half turn or no turn)',f11(1,'sym')),('all principal moments at O equal',f11(1,'sph'))])
def f12(sg,rest=False):
    def f():
        o=K() if rest else model(); dI=D(lambda s:inertia(o.m,o.xf(s)),o.t)
        return nrm(dI-o.W*o.I-sg*o.I*o.W)
    return f
def f12b():
    o=model(); dI=D(lambda s:inertia(o.m,o.xf(s)),o.t); return nrm(dI-o.W*o.I-o.I*o.W.T)
N.wrong(12,f12(1),(r'+I_{ik}',r'-I_{ik}'),f12(-1),'sign of the second term (transpose of a skew tensor)',wrong_term=r'+I_{ik}\,\Omega_{kj}',tol=TOL,
  others=[(r'\dot I_{ij}=\Omega_{ik}\,I_{kj}+I_{ik}\,\Omega_{jk}',f12b)],special=[('omega = 0',f12(1,True))])
def f13(sg,case=None):
    def f():
        o=model()
        if case=='rest':   # omega = 0 at t, omega-dot not zero
            Q=randrot(); q=rfun(); p=rfun(); o=model(Rfun=lambda s:Q*Rz(q(s)*(s-mpf('0.3'))**2)*Rx(p(s)*(s-mpf('0.3'))**2))
        elif case:   # rotation about a principal axis: points symmetric about e3, R about a fixed direction
            q=rfun(); Q=randrot(); X=[]; ms=[]
            for _ in range(3):
                a=rv(); m=rnd()
                X+= [V(a[0],a[1],a[2]),V(-a[0],-a[1],a[2])]; ms+=[m,m]
            o=model(X=X,ms=ms,Rfun=lambda s:Q*Rz(q(s)))
        Nn=V(0,0,0)
        for m,x,X in zip(o.m,o.x,o.X): Nn+=m*cross(x,D(lambda s:o.R(s)*X,o.t,2))
        Ld=D(lambda s:sum((m*cross(o.R(s)*X,D(lambda q:o.R(q)*X,s)) for m,X in zip(o.m,o.X)),V(0,0,0)),o.t) if case is not True else Nn
        wd=D(lambda s:angvel(o.R,s),o.t); Iw=o.I*o.w
        g=V(*[sum(ep(i,j,k)*o.w[k]*Iw[j] for j in r3 for k in r3) for i in r3])
        return nrm(Nn-Ld)+nrm(Nn-o.I*wd-sg*g)
    return f
N.wrong(13,f13(1),(r'\omega_k\,I_{jl}\,\omega_l',r'\omega_j\,I_{kl}\,\omega_l'),f13(-1),'exchanged indices (sign of the gyroscopic term)',tol=TOL,wrong_term=r'\epsilon_{ijk}\,\omega_k\,I_{jl}\,\omega_l',
  others=[(r'N_i=\dot L_i=I_{ij}\,\dot\omega_j-\epsilon_{ijk}\,\omega_k\,I_{jl}\,\omega_l',f13(-1))],
  special=[('rotation about a principal axis',f13(1,True)),('omega = 0 at this instant',f13(1,'rest'))])
def f14():
    X=[];ms=[]
    for k in r3:
        for s in (1,-1):
            e=V(0,0,0); X.append(e); ms.append(None)
    a=rv(); m=[rnd() for _ in r3]; X=[];ms=[]
    for k in r3:
        for s in (1,-1):
            e=V(0,0,0); e[k]=s*a[k]; X.append(e); ms.append(m[k])
    o=model(X=X,ms=ms); t=o.t; Ib=inertia(ms,X); Rt=o.R(t).T
    Nn=V(0,0,0)
    for mq,x,Xq in zip(o.m,o.x,o.X): Nn+=mq*cross(x,D(lambda s:o.R(s)*Xq,t,2))
    Nb=Rt*Nn; wb=lambda s:o.R(s).T*angvel(o.R,s); w=wb(t); wd=D(wb,t); e=0
    for i in r3:
        j,k=(i+1)%3,(i+2)%3
        e+=abs(Ib[i,i]*wd[i]-(Ib[j,j]-Ib[k,k])*w[j]*w[k]-Nb[i])
    return e
N.holds(14,f14,tol=TOL,stated_in_note=['body axes are principal axes at O','primes dropped'])
def f15(case=None):
    def f():
        o=model(); Ib=inertia(o.m,o.X); w=rv(); Nb=rv()
        if case=='free': Nb=V(0,0,0)
        if case=='perp': Nb=cross(w,rv())
        wd=mp.lu_solve(Ib,Nb-cross(w,Ib*w))
        return 2*dot(w,Ib*wd)       # rate of I_ij w_i w_j (a scalar, evaluated in body axes); the first equality is display 6
    return f
N.under(15,f15(),[f15('free'),f15('perp')],assumptions=['no external torque about O: N_i = 0'],assumption_alternatives=[['the torque does no work: N_i omega_i = 0']],
  general_form=r'\frac{d}{dt}\left(I_{ij}\,\omega_i\,\omega_j\right)=2\,N_i\,\omega_i')
# 16, 17 exact
x=S.symbols('x1:4'); a,M=S.symbols('a M',positive=True)
Ic=S.Matrix(3,3,lambda i,j:S.integrate(M/a**3*((x[0]**2+x[1]**2+x[2]**2)*(1 if i==j else 0)-x[i]*x[j]),(x[0],0,a),(x[1],0,a),(x[2],0,a)))
P=M*a**2*S.Matrix(3,3,lambda i,j:S.Rational(2,3) if i==j else -S.Rational(1,4))
N.holds(16,lambda:mpf(0) if S.simplify(Ic-P)==S.zeros(3,3) else mpf(1),stated_in_note=['corner, axes along the edges, homogeneous cube'])
ev=sorted([(S.simplify(k/(M*a**2)),v) for k,v in Ic.eigenvals().items()],key=lambda q:q[0])
n=S.Matrix([1,1,1])
ok=lambda q:lambda:mpf(0) if ev==[(S.Rational(1,6),1),(q,2)] and S.simplify(Ic*n-M*a**2/6*n)==S.zeros(3,1) else mpf(1)
N.wrong(17,ok(S.Rational(5,12)),(r'\tfrac{5}{12}',r'\tfrac{11}{12}'),ok(S.Rational(11,12)),'sign of the off-diagonal element in the double eigenvalue')
N.finish()
