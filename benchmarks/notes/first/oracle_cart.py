from common import *; from vec import *
from mpmath import mp, mpf, sin, cos, sqrt, quad, lu_solve, pi
import sympy as S
N=Note('cart.md')
# ---- exact Lagrangian from the velocities of the elements of the rod (independent of I_C) ----
x,th,xd,td,xdd,tdd,M,m,l,g,u,b,s=S.symbols('x th xd td xdd tdd M m l g u b s')
vx=xd+s*td*S.cos(th); vy=s*td*S.sin(th)
Ts=M*xd**2/2+S.integrate(S.expand(m/(2*l)*(vx**2+vy**2)/2),(s,0,2*l))
Vs=S.integrate(m/(2*l)*g*(-s*S.cos(th)),(s,0,2*l))
Ls=Ts-Vs
ALL=(x,th,xd,td,xdd,tdd,M,m,l,g,u,b)
def ddt(e): return S.diff(e,x)*xd+S.diff(e,th)*td+S.diff(e,xd)*xdd+S.diff(e,td)*tdd
F=lambda e: S.lambdify(ALL,e,'mpmath')
fT,fV=F(Ts),F(Vs)
fp=F(S.diff(Ls,xd)); fdp=F(ddt(S.diff(Ls,xd)))
fE1=F(ddt(S.diff(Ls,xd))-S.diff(Ls,x)); fE2=F(ddt(S.diff(Ls,td))-S.diff(Ls,th))
# ---- Newton-Euler with hinge force ----
def model(**k):
    p=dict(M=rnd(),m=rnd(),l=rnd(),g=rnd(5,10),b=rnd(),u=rnd(.3,2,True),x=rnd(),th=rnd(.2,1.4),xd=rnd(.3,2,True),td=rnd(1.1,2,True)); p.update(k)
    M,m,l,g,b,u,th,xd,td=[p[q] for q in ('M','m','l','g','b','u','th','xd','td')]
    IC=quad(lambda r: m/(2*l)*r*r,[-l,l])
    c,s=cos(th),sin(th)
    # unknowns xdd, tdd, Hx, Hy
    A=matrix([[M,0,1,0],[m,m*l*c,-1,0],[0,m*l*s,0,-1],[0,IC,l*c,l*s]])
    r=matrix([u-b*xd, m*l*td**2*s, -m*l*td**2*c-m*g, 0])
    z=lu_solve(A,r); p.update(xdd=z[0],tdd=z[1],Hx=z[2],Hy=z[3],IC=IC,c=c,s=s)
    class O: pass
    o=O(); o.__dict__.update(p); o.a=[p[str(q)] for q in ALL]; return o
def R(f,**k):
    return lambda: f(model(**{a:(v() if callable(v) else v) for a,v in k.items()}))
N.definition(1)
def f2(o):
    acc=lambda t: None
    X=lambda t:o.x+o.xd*t; Q=lambda t:o.th+o.td*t
    r=lambda t:V(X(t)+o.l*sin(Q(t)),-o.l*cos(Q(t)))
    return nrm(D(r,mpf(0))-V(o.xd+o.l*o.td*o.c,o.l*o.td*o.s))
N.holds(2,R(f2))
N.holds(3,R(lambda o:(o.xd+o.l*o.td*o.c)**2+(o.l*o.td*o.s)**2-(o.xd**2+2*o.l*o.xd*o.td*o.c+o.l**2*o.td**2)))
N.holds(4,R(lambda o:abs(o.IC-o.m*(2*o.l)**2/12)+abs(o.IC-o.m*o.l**2/3)),stated_in_note=['uniform rod of total length 2l'])
T=lambda o,k:fT(*o.a)-((o.M+o.m)*o.xd**2/2+k*o.m*o.l*o.xd*o.td*o.c+mpf(2)/3*o.m*o.l**2*o.td**2)
h=mpf(1)/2
N.wrong(5,R(lambda o:T(o,h)),(r'\tfrac12\,m\,l\,\dot x\,\dot\theta\cos\theta',r'm\,l\,\dot x\,\dot\theta\cos\theta'),R(lambda o:T(o,1)),
  'factor 1/2 on the mixed term of the kinetic energy',
  special=[('xdot = 0',R(lambda o:T(o,h),xd=0)),('thetadot = 0',R(lambda o:T(o,h),td=0)),('cos theta = 0',R(lambda o:T(o,h),th=pi/2))])
N.wrong(6,R(lambda o:fV(*o.a)-o.m*o.g*o.l*o.c),(r'V=m',r'V=-m'),R(lambda o:fV(*o.a)+o.m*o.g*o.l*o.c),
  'sign of the potential energy (angle measured from the downward vertical)',wrong_term=r'm\,g\,l\cos\theta',
  special=[('cos theta = 0',R(lambda o:fV(*o.a)-o.m*o.g*o.l*o.c,th=pi/2))],stated_in_note=['theta from the downward vertical','V = 0 when C is level with the hinge'])
N.holds(7,R(lambda o:abs(fE1(*o.a)-(o.u-o.b*o.xd))+abs(fE2(*o.a))),stated_in_note=['frictionless hinge','viscous rail friction -b xdot','motor force u on the cart'])
g8=lambda o,p:fdp(*o.a)-((o.M+o.m)*o.xdd+o.m*o.l*o.tdd*o.c-o.m*o.l*o.td**p*o.s)
N.wrong(8,R(lambda o:g8(o,1)),(r'm\,l\,\dot\theta\sin\theta',r'm\,l\,\dot\theta^2\sin\theta'),R(lambda o:g8(o,2)),'missing square (dimensions differ)',
  special=[('thetadot = 0',R(lambda o:g8(o,1),td=0)),('sin theta = 0',R(lambda o:g8(o,1),th=0)),('numerically thetadot = 1 in the unit used',R(lambda o:g8(o,1),td=1))])
def f9(o): return abs((o.M+o.m)*o.xdd+o.m*o.l*o.tdd*o.c-o.m*o.l*o.td**2*o.s+o.b*o.xd-o.u)+abs(mpf(4)/3*o.m*o.l**2*o.tdd+o.m*o.l*o.xdd*o.c+o.m*o.g*o.l*o.s)
N.holds(9,R(f9))
def f10(o,k): return o.tdd+((o.M+o.m)*o.g*o.s+o.c*(o.u-o.b*o.xd+o.m*o.l*o.td**2*o.s))/(o.l*(mpf(4)/3*(o.M+o.m)+k*o.m*o.c**2))
N.wrong(10,R(lambda o:f10(o,1)),(r'(M+m)+m\cos^2\theta',r'(M+m)-m\cos^2\theta'),R(lambda o:f10(o,-1)),'sign of a term in the denominator',
  wrong_term=r'\tfrac43(M+m)+m\cos^2\theta',special=[('cos theta = 0',R(lambda o:f10(o,1),th=pi/2))])
# 11: momentum formula holds exactly; its rate must vanish
f11=lambda o:abs(fp(*o.a)-((o.M+o.m)*o.xd+o.m*o.l*o.td*o.c))+abs(fdp(*o.a))
def bal():
    o=model(); return f11(model(b=mpf(2)/3,xd=mpf(3)/2,u=mpf(1)))
N.under(11,R(f11),[R(f11,u=0,b=0),bal],corrected=R(lambda o:fdp(*o.a)-(o.u-o.b*o.xd)),
  assumptions=['no motor force: u = 0','no rail friction: b = 0'],assumption_alternatives=[['the motor force balances the rail friction at all times: u = b xdot']],
  general_form=r'\frac{dp_x}{dt}=u-b\,\dot x',also_accept=['wrong'],stated_in_note=['motor force and rail friction act on the cart (so the line is not true as the note stands)'])
# 12, 17: first-order lines: residual / eps -> 0
eps=mpf(10)**-20
def lin(o_kw,base,sg,su):
    e=eps*rnd(.5,1.5); o=model(b=0,th=base+e*rnd(),td=e*rnd(),u=e*rnd(),**o_kw); ph=o.th-base
    return (o.tdd-sg*3*(o.M+o.m)*o.g/((4*o.M+o.m)*o.l)*ph-su*3/((4*o.M+o.m)*o.l)*o.u)/eps
def notsmall():
    o=model(b=0); return o.tdd+3*(o.M+o.m)*o.g/((4*o.M+o.m)*o.l)*o.th+3/((4*o.M+o.m)*o.l)*o.u
N.under(12,notsmall,[lambda:lin({},mpf(0),-1,-1)],tol=mpf('1e-15'),assumptions=['small theta and thetadot (first order about the hanging position)','no rail friction: b = 0'],
  stated_in_note=['small theta, thetadot and u','b = 0'],also_accept=['holds'])
def f13():
    o=model(b=0,u=0,td=0,th=eps); return sqrt(-o.tdd/o.th)-sqrt(3*(o.M+o.m)*o.g/((4*o.M+o.m)*o.l))
N.holds(13,f13,tol=mpf('1e-15'),stated_in_note=['small oscillations','u = 0','b = 0'],also_accept=['holds_under'])
def f14(d):
    o=model(b=0,u=0,td=0,th=eps,M=mpf(10)**25); return sqrt(-o.tdd/o.th)-sqrt(3*o.g/(d*o.l))
N.wrong(14,lambda:f14(2),(r'{2\,l}',r'{4\,l}'),lambda:f14(4),'length of the rod taken for half its length in the limit',wrong_term=r'\frac{3\,g}{2\,l}',tol=mpf('1e-15'))
f15=lambda o,w:o.Hy-(o.m*o.g+o.m*o.l*(o.tdd*o.s+o.td**2*w))
N.wrong(15,R(lambda o:f15(o,o.s)),(r'\dot\theta^2\sin\theta',r'\dot\theta^2\cos\theta'),R(lambda o:f15(o,o.c)),'sine for cosine in the centripetal term',
  special=[('thetadot = 0',R(lambda o:f15(o,o.s),td=0)),('theta = 45 degrees',R(lambda o:f15(o,o.s),th=pi/4))])
N.definition(16)
N.wrong(17,lambda:lin({},+pi,1,-1),(r'\varphi-\frac{3}{(4M+m)\,l}\,u',r'\varphi+\frac{3}{(4M+m)\,l}\,u'),lambda:lin({},+pi,1,1),'sign of the input term',
  wrong_term=r'-\frac{3}{(4M+m)\,l}\,u',special=[('u = 0',lambda:(lambda o:(o.tdd-3*(o.M+o.m)*o.g/((4*o.M+o.m)*o.l)*(o.th-pi))/eps)(model(b=0,u=0,td=0,th=pi+eps)))],
  tol=mpf('1e-15'),stated_in_note=['small phi, phidot, u','b = 0'],remark='the corrected line holds to first order (assumption stated)')
N.finish()
