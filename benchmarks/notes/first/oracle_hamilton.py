from common import *; from vec import *
from mpmath import mp, mpf, sin, cos, sqrt, pi
import sympy as S
N=Note('hamilton.md')
class Mod: pass
# ---- exact, from Cartesian coordinates ----
th,ph,thd,phd,mu,l,g,pt,pp,a,Om,p=S.symbols('theta phi thetad phid mu l g pt pp a Omega p')
X=S.Matrix([l*S.sin(th)*S.cos(ph),l*S.sin(th)*S.sin(ph),-l*S.cos(th)])
Xd=X.diff(th)*thd+X.diff(ph)*phd
Lx=mu*(Xd.T*Xd)[0]/2-mu*g*X[2]
px=(S.diff(Lx,thd),S.diff(Lx,phd))
ST=(th,ph,thd,phd,mu,l,g)
F=lambda e:S.lambdify(ST,e,'mpmath')
fL=F(Lx); fp=[F(q) for q in px]; fE=F(mu*(Xd.T*Xd)[0]/2+mu*g*X[2])
fX=F(X); fXd=F(Xd)
fB=F(S.Matrix.hstack(X.diff(th),X.diff(ph)))
q2=sum((X.diff(s).diff(r)*sd*rd for s,sd in((th,thd),(ph,phd)) for r,rd in((th,thd),(ph,phd))),S.zeros(3,1)); fQ=F(q2)
def model(**k):
    """spherical pendulum; angular accelerations from Newton's law with a constraint force along the rod"""
    v=dict(th=rnd(.3,1.3),ph=rnd(0,3),thd=rnd(.3,2,True),phd=rnd(.3,2,True),mu=rnd(),l=rnd(),g=rnd(5,10)); v.update(k)
    o=Mod(); o.__dict__.update(v); o.a=[v[n] for n in('th','ph','thd','phd','mu','l','g')]
    r=matrix(fX(*o.a)); rd=matrix(fXd(*o.a)); n=r/o.l
    acc=V(0,0,-o.g); acc=acc-n*(dot(n,acc)+dot(rd,rd)/o.l)          # |r| = l
    B=matrix(fB(*o.a)); rhs=acc-matrix(fQ(*o.a)); z=mp.lu_solve(B.T*B,B.T*rhs); o.thdd,o.phdd=z[0],z[1]
    o.pt,o.pp=[f(*o.a) for f in fp]; o.s,o.c=sin(o.th),cos(o.th)
    return o
R=lambda f,**k:(lambda:f(model(**{q:(v() if callable(v) else v) for q,v in k.items()})))
N.holds(1,R(lambda o:fL(*o.a)-(o.mu*o.l**2/2*(o.thd**2+o.phd**2*o.s**2)+o.mu*o.g*o.l*o.c)))
N.definition(2)
N.holds(3,R(lambda o:abs(o.pt-o.mu*o.l**2*o.thd)+abs(o.pp-o.mu*o.l**2*o.phd*o.s**2)))
N.definition(4)
H=lambda o:o.pt*o.thd+o.pp*o.phd-fL(*o.a)
def f5(o,k): return H(o)-((o.pt**2+o.pp**2*o.s**k)/(2*o.mu*o.l**2)-o.mu*o.g*o.l*o.c)
N.wrong(5,R(lambda o:f5(o,2)),(r'p_\phi^2\sin^2\theta',r'\frac{p_\phi^2}{\sin^2\theta}'),R(lambda o:f5(o,-2)),'factor put in the numerator instead of the denominator',
  special=[('theta = 90 degrees',R(lambda o:f5(o,2),th=pi/2)),('p_phi = 0',R(lambda o:f5(o,2),phd=0))])
# true Hamiltonian as a function of (theta,phi,pt,pp), by exact inversion of p(qdot)
sol=S.solve([px[0]-pt,px[1]-pp],[thd,phd],dict=True)[0]
Hs=S.simplify((pt*thd+pp*phd-Lx).subs(sol))
HA=(th,ph,pt,pp,mu,l,g); dH={s:S.lambdify(HA,S.diff(Hs,s),'mpmath') for s in(th,ph,pt,pp)}
pdot=S.Matrix([S.diff(q,th)*thd+S.diff(q,ph)*phd for q in px])
fpd=[F(q) for q in pdot]; fMm=F(S.Matrix([[S.diff(q,thd),S.diff(q,phd)] for q in px]))
def pd(o):
    M_=matrix(fMm(*o.a)); z=M_*matrix([o.thdd,o.phdd]); return [fpd[i](*o.a)+z[i] for i in(0,1)]
def f6(o,sg):
    A=(o.th,o.ph,o.pt,o.pp,o.mu,o.l,o.g); q=pd(o)
    return abs(o.thd-dH[pt](*A))+abs(o.phd-dH[pp](*A))+abs(q[0]-sg*dH[th](*A))+abs(q[1]-sg*dH[ph](*A))
def cone():
    o=model(); return model(thd=0,th=o.th,g=o.g,l=o.l,phd=sqrt(o.g/(o.l*cos(o.th))))
N.wrong(6,R(lambda o:f6(o,1)),(r'\dot p_i=\frac{\partial H}{\partial q_i}',r'\dot p_i=-\frac{\partial H}{\partial q_i}'),R(lambda o:f6(o,-1)),
  'sign of the second canonical equation',special=[('all coordinates cyclic, or at a point where dH/dq_i = 0 (e.g. the steady cone)',lambda:f6(cone(),1))])
N.holds(7,R(lambda o:(lambda q:abs(q[0]-(o.pp**2*o.c/(o.mu*o.l**2*o.s**3)-o.mu*o.g*o.l*o.s))+abs(q[1]))(pd(o))))
N.definition(8)
Rt=lambda o:o.pp*o.phd-fL(*o.a)
f9=lambda o,k:Rt(o)-(k*o.mu*o.l**2/2*o.thd**2+o.pp**2/(2*o.mu*o.l**2*o.s**2)-o.mu*o.g*o.l*o.c)
N.wrong(9,R(lambda o:f9(o,1)),(r'R=\frac{\mu\ell^2}{2}',r'R=-\frac{\mu\ell^2}{2}'),R(lambda o:f9(o,-1)),'sign of the kinetic term of the Routhian',
  wrong_term=r'\frac{\mu\ell^2}{2}\,\dot\theta^2',special=[('thetadot = 0',R(lambda o:f9(o,1),thd=0))],
  remark='as written the right-hand side is the energy; display 10 is true for R as defined in display 8')
Rs=S.simplify((pp*phd-Lx).subs(phd,S.solve(px[1]-pp,phd)[0])); RA=(th,thd,pp,mu,l,g)
L=lambda e:S.lambdify(RA,e,'mpmath')
R1,R2,R3=L(S.diff(Rs,thd,thd)),L(S.diff(Rs,thd,th)),L(S.diff(Rs,th))
N.holds(10,R(lambda o:(lambda A:R1(*A)*o.thdd+R2(*A)*o.thd-R3(*A))((o.th,o.thd,o.pp,o.mu,o.l,o.g))))
def f11():
    o=model(thd=0); fun=lambda w:model(th=o.th,ph=o.ph,thd=0,phd=w,mu=o.mu,l=o.l,g=o.g).thdd
    w=mp.findroot(fun,sqrt(o.g/(o.l*o.c))*mpf('1.1')); return w**2-o.g/(o.l*o.c)
N.holds(11,f11,tol=mpf('1e-20'),stated_in_note=['steady conical motion','0 < theta_0 < pi/2'])
def wn2(o):
    P=o.mu*o.l**2*sin(o.th)**2*sqrt(o.g/(o.l*cos(o.th)))
    fun=lambda t:model(th=t,thd=0,phd=P/(o.mu*o.l**2*sin(t)**2),mu=o.mu,l=o.l,g=o.g,ph=mpf(1)).thdd
    return -diff(fun,o.th)
N.wrong(12,R(lambda o:wn2(o)-o.g/o.l*(1+4*o.c**2)/o.c),(r'1+4\cos^2',r'1+3\cos^2'),R(lambda o:wn2(o)-o.g/o.l*(1+3*o.c**2)/o.c),
  'wrong coefficient from the second derivative of the effective potential',wrong_term=r'1+4\cos^2\theta_0',tol=mpf('1e-15'),stated_in_note=['small disturbance of the steady cone at the same p_phi'])
def f13(k):
    o=model(th=mpf('1e-6')); return sqrt(wn2(o))-k*sqrt(o.g/o.l)
N.wrong(13,lambda:f13(sqrt(mpf(5))),(r'\sqrt5\,\sqrt{\frac{g}{\ell}}',r'2\,\sqrt{\frac{g}{\ell}}'),lambda:f13(2),'carries the wrong coefficient of the line before',wrong_term=r'\sqrt5',tol=mpf('1e-9'),
  remark='carries: consequence of display 12; the limit of the written expression itself is taken correctly')
N.definition(14)
# 15 f(q,p,t) along the true motion
def f15(expl):
    def f():
        t=S.Symbol('t'); c=[rnd() for _ in range(4)]
        fs=c[0]*S.sin(th)*pt+c[1]*pp*S.cos(ph)+c[2]*pt**2+(c[3]*S.sin(t)*pp*th if expl else 0)
        o=model(); q=pd(o); sub={th:o.th,ph:o.ph,pt:o.pt,pp:o.pp,t:mpf('0.7'),mu:o.mu,l:o.l,g:o.g}
        E=lambda e:S.lambdify((th,ph,pt,pp,mu,l,g,t),e,'mpmath')(o.th,o.ph,o.pt,o.pp,o.mu,o.l,o.g,mpf('0.7'))
        rate=E(S.diff(fs,th))*o.thd+E(S.diff(fs,ph))*o.phd+E(S.diff(fs,pt))*q[0]+E(S.diff(fs,pp))*q[1]+E(S.diff(fs,t))
        br=sum(E(S.diff(fs,x)*S.diff(Hs,y)-S.diff(fs,y)*S.diff(Hs,x)) for x,y in((th,pt),(ph,pp)))
        return rate-br
    return f
N.under(15,f15(True),[f15(False)],tol=mpf('1e-20'),assumptions=['f does not depend explicitly on time'],general_form=r'\frac{df}{dt}=\{f,H\}+\frac{\partial f}{\partial t}. \tag{7.15}',also_accept=['wrong'])
x=S.symbols('x y z'); P=S.symbols('p_x p_y p_z'); Mv=S.Matrix(x).cross(S.Matrix(P))
def pb(f,h): return sum(S.diff(f,x[i])*S.diff(h,P[i])-S.diff(f,P[i])*S.diff(h,x[i]) for i in range(3))
def f16(sg,order=0):
    def f():
        e=0; v={s:rnd(.2,2,True) for s in x+P}
        for i,j,k in((0,1,2),(1,2,0),(2,0,1)):
            b=pb(Mv[i],Mv[j]) if not order else pb(Mv[j],Mv[i])
            e+=abs(mpf(S.N(S.expand(b-sg*Mv[k]).subs(v),40)))
        return e
    return f
old=r'\{M_x,M_y\}=-M_z,\qquad\{M_y,M_z\}=-M_x,\qquad\{M_z,M_x\}=-M_y'
N.wrong(16,f16(-1),(old,old.replace('=-','=')),f16(1),'sign that belongs to the opposite convention of the bracket',part='all three brackets',
  others=[(r'\{M_y,M_x\}=-M_z,\qquad\{M_z,M_y\}=-M_x,\qquad\{M_x,M_z\}=-M_y. \tag{7.16}',f16(-1,1))],stated_in_note=['sign convention of the bracket (7.14)'],
  special=[('M = 0',lambda:abs(S.N(sum(abs(pb(Mv[i],Mv[j]).subs(dict(zip(P,[2*q for q in x])))) for i,j in((0,1),(1,2),(2,0))).subs({x[0]:1,x[1]:2,x[2]:3}))))])
# ---- hoop ----
t=S.Symbol('t')
Y=S.Matrix([a*S.sin(th)*S.cos(Om*t),a*S.sin(th)*S.sin(Om*t),-a*S.cos(th)]); Yd=Y.diff(th)*thd+Y.diff(t)
Th=S.simplify(mu*(Yd.T*Yd)[0]/2); Vh=mu*g*Y[2]; Lh=Th-Vh; ph_=S.diff(Lh,thd); Hh=ph_*thd-Lh
HS=(th,thd,mu,a,g,Om); h=lambda e:S.lambdify(HS,e,'mpmath')
hH,hE,hp,hdL=h(Hh),h(Th+Vh),h(ph_),h(S.diff(Lh,th))
def hv(**k): 
    v=dict(th=rnd(.3,1.3),thd=rnd(.3,2,True),mu=rnd(),a=rnd(),g=rnd(5,10),Om=rnd(1,3)); v.update(k); return [v[n] for n in('th','thd','mu','a','g','Om')]
def f17():
    A=hv(); T_,td,m,aa,gg,O=A; return hH(*A)-(hp(*A)**2/(2*m*aa**2)-m*aa**2*O**2*sin(T_)**2/2-m*gg*aa*cos(T_))
N.holds(17,f17)
def f18(k,**kw):
    def f():
        A=hv(**kw); T_,td,m,aa,gg,O=A; return hE(*A)-hH(*A)-k*m*aa**2*O**2*sin(T_)**2
    return f
N.wrong(18,f18(mpf(1)/2),(r'\frac12\,\mu a^2',r'\mu a^2'),f18(1),'factor 1/2 in the difference of energy and Hamiltonian',wrong_term=r'\frac12\,\mu a^2\Omega^2\sin^2\theta',
  special=[('Omega = 0',f18(mpf(1)/2,Om=0)),('sin theta = 0',f18(mpf(1)/2,th=0))])
def f19(fast):
    def f():
        A=hv(); T_,td,m,aa,gg,O=A
        if not fast:
            O=sqrt(gg/aa)*rnd(.3,.9); best=min(abs(hdL(mpf(k)*pi/200,0,m,aa,gg,O)) for k in range(1,200))
            assert best>0          # no equilibrium off the axis
            return min(abs(cos(mpf(k)*pi/200)-gg/(aa*O*O)) for k in range(201))
        O=sqrt(gg/aa)*rnd(1.1,3); q=mp.findroot(lambda s:hdL(s,0,m,aa,gg,O)/sin(s),mp.acos(gg/(aa*O*O))*mpf('1.05'))
        return cos(q)-gg/(aa*O*O)
    return f
N.under(19,f19(False),[f19(True)],tol=mpf('1e-20'),assumptions=['the hoop turns fast enough: a Omega^2 > g'],also_accept=['holds'])
N.finish()
