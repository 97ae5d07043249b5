from common import *; from vec import *
from mpmath import mp, mpf, sin, cos, sqrt, pi, log, quad
import sympy as S
N=Note('impact.md')
class Mod: pass
k25=mpf(2)/5
N.definition(1)
def f2():
    # a ball as 6 equal masses on the axes (isotropic inertia about S); impulse distributed by the rigid-body constraint, solved from the
    # impulse-momentum laws of the system about a fixed origin
    a=rnd(); m=rnd(); s=a*sqrt(mpf(3)*2/5/2); Q=randrot(); S0=rv(); pts=[Q*V(*[s*sg if i==k else mpf(0) for i in range(3)]) for k in range(3) for sg in(1,-1)]
    mi=m/6; Th=matrix(3,3)
    for p in pts: Th+=mi*(dot(p,p)*eye(3)-p*p.T)
    assert nrm(Th-k25*m*a*a*eye(3))<mpf('1e-40')
    vS,w,Fh=rv(),rv(),rv(); n=rv(); SP=n*a/sqrt(dot(n,n))
    mom=lambda v,w:sum((mi*(v+cross(w,p)) for p in pts),V(0,0,0)); ang=lambda v,w:sum((mi*cross(S0+p,v+cross(w,p)) for p in pts),V(0,0,0))
    v2=vS+Fh/m; w2=w+cross(SP,Fh)/(k25*m*a*a)       # the claim
    return nrm(mom(v2,w2)-mom(vS,w)-Fh)+nrm(ang(v2,w2)-ang(vS,w)-cross(S0+SP,Fh))
N.holds(2,f2,stated_in_note=['other forces have no time to act','homogeneous ball: same moment of inertia about every axis through S'])
r,q=S.symbols('r q'); 
solid=S.integrate(S.integrate(2*S.pi*r**4*S.sin(q)**3,(q,0,S.pi)),(r,0,1))/(S.Rational(4,3)*S.pi)
shell=S.integrate(2*S.pi*S.sin(q)**3,(q,0,S.pi))/(4*S.pi)
f3=lambda c:lambda:abs(mpf(S.N(solid-S.Rational(2,5))))+abs(mpf(S.N(shell-c)))
N.wrong(3,f3(S.Rational(1,2)),(r'\tfrac12\,m\,a^2',r'\tfrac23\,m\,a^2'),f3(S.Rational(2,3)),'wrong entry in a table of moments of inertia',part='second row')
N.definition(4)
def imp(**k):
    o=Mod(); o.m1,o.m2,o.e=rnd(),rnd(),rnd(.2,.9); o.v1,o.v2=rnd(1,2),rnd(-1,.5); o.__dict__.update(k)
    A=matrix([[o.m1,o.m2],[-1,1]]); y=mp.lu_solve(A,matrix([o.m1*o.v1+o.m2*o.v2,-o.e*(o.v2-o.v1)])); o.w1,o.w2=y
    o.dE=(o.m1*o.v1**2+o.m2*o.v2**2-o.m1*o.w1**2-o.m2*o.w2**2)/2; return o
R=lambda f,**k:(lambda:f(imp(**k)))
f5=lambda ok:lambda o:abs(o.w1-(o.m1*o.v1+o.m2*o.v2-o.e*o.m2*(o.v1-o.v2))/(o.m1+o.m2))+abs(o.w2-(o.m1*o.v1+o.m2*o.v2+o.e*(o.m1 if ok else o.m2)*(o.v1-o.v2))/(o.m1+o.m2))
N.wrong(5,R(f5(0)),(r'+e\,m_2\,(v_1-v_2)',r'+e\,m_1\,(v_1-v_2)'),R(f5(1)),'wrong mass in one term',part='second row',
  special=[('m1 = m2',R(f5(0),m1=mpf(1),m2=mpf(1))),('e = 0',R(f5(0),e=mpf(0))),('v1 = v2',R(f5(0),v1=mpf(1),v2=mpf(1)))])
f6=lambda ok:lambda o:o.dE-((1-o.e**2) if ok else (1-o.e)**2)/2*o.m1*o.m2/(o.m1+o.m2)*(o.v1-o.v2)**2
N.wrong(6,R(f6(0)),(r'(1-e)^2',r'1-e^2'),R(f6(1)),'square of the difference for the difference of the squares',
  special=[('e = 0',R(f6(0),e=mpf(0))),('e = 1',R(f6(0),e=mpf(1))),('v1 = v2',R(f6(0),v1=mpf(1),v2=mpf(1)))])
num=lambda:imp(m1=mpf(2),m2=mpf(3),v1=mpf(4),v2=mpf(-1),e=mpf('0.5'))
def f7():
    o=num(); A=(8-3-mpf('.5')*15)/5; B=(8-3+mpf('.5')*10)/5; return abs(o.w1-A)+abs(o.w2-B)+abs(A+mpf('.5'))+abs(B-2)
N.holds(7,f7,remark='uses the right mass in the second formula although display 5 has the wrong one')
f8=lambda pre,val:lambda:(lambda o:abs(o.dE-pre/2*6/5*25)+abs(o.dE-val))(num())
assert abs(mpf('.25')/2*6/5*25-mpf('3.75'))<mpf('1e-40')
old8=N.latex(8).split('=',1)[1]
N.wrong(8,f8(mpf('.25'),mpf('3.75')),(old8,old8.replace('(1-0.5)^2','1-0.5^2').replace('3.75','11.25')),f8(mpf('.75'),mpf('11.25')),'carries the wrong factor of the formula',wrong_term='(1-0.5)^2',
  remark='carries: consequence of display 6; the arithmetic itself is right')
def f9(sg,case=None):
    def f():
        t=mpf('0.3'); Rf=rrot(); c=rvfun(); a=rnd(); SP=V(0,0,-a); X=Rf(t).T*SP
        if case: n=V(0,0,1); qf=rfun(); Rf=lambda s:Rz(qf(s)); X=Rf(t).T*SP
        w=angvel(Rf,t); vP=D(lambda s:c(s)+Rf(s)*X,t)
        return nrm(vP-D(c,t)-sg*cross(SP,w))
    return f
L9=r'\underline v_P=\underline v_S+'
N.wrong(9,f9(1),(r'\underline{SP}\times\underline\omega',r'\underline\omega\times\underline{SP}'),f9(-1),'factors of the cross product exchanged',tol=mpf('1e-12'),
  others=[(r'\underline v_P=\underline v_S-\underline{SP}\times\underline\omega',f9(-1)),(r'\underline v_P=\underline v_S+\underline{PS}\times\underline\omega',f9(-1))],
  special=[('omega is vertical (pure pivoting) or zero',f9(1,True))])
# ---- sliding: Coulomb friction opposite to the slip velocity ----
def slide():
    o=Mod(); o.m,o.a,o.mu,o.g,o.v0=rnd(),rnd(),rnd(.1,.6),rnd(9,10),rnd(1,3); o.Th=k25*o.m*o.a**2
    Nn=o.m*o.g; Fx=-o.mu*Nn                       # slip velocity v - a*omega > 0
    o.vd=Fx/o.m; M=cross(V(0,0,-o.a),V(Fx,0,0)); assert M[0]==0 and M[2]==0
    o.wd=M[1]/o.Th
    o.t1=o.v0/(o.a*o.wd-o.vd); o.v1=o.v0+o.vd*o.t1; return o
N.holds(10,lambda:(lambda o:abs(o.vd+o.mu*o.g)+abs(o.a*o.wd-mpf(5)/2*o.mu*o.g))(slide()),stated_in_note=['solid ball slides forward','homogeneous solid ball'])
f11=lambda k:lambda:(lambda o:abs(o.t1-2*o.v0/(7*o.mu*o.g))+abs(o.v1-(o.v0-o.mu*o.g*o.t1))+abs(o.v1-mpf(k)/7*o.v0))(slide())
N.wrong(11,f11(2),(r'\tfrac27\,v_0',r'\tfrac57\,v_0'),f11(5),'the loss of velocity taken for the velocity that is left',part='last member of the second chain',stated_in_note=['no rotation at t = 0'])
def f12():
    m,a,F=rnd(),rnd(),rnd(); Th=k25*m*a*a; v=F/m; fun=lambda H:F*H/Th*a-v
    H=mp.findroot(fun,a*mpf('.3')); return abs(H-Th/(m*a))+abs(H-k25*a)+abs(F*H-Th*v/a)
N.holds(12,f12,stated_in_note=['horizontal blow','no friction impulse','solid ball at rest before'])
def f13(roll):
    def f():
        m,a,g,al=rnd(),rnd(),rnd(9,10),rnd(.3,1.2); Th=k25*m*a*a; mu=mpf(2)/7*mp.tan(al)*(rnd(1.1,3) if roll else rnd(.2,.8))
        # rolling: m vd = m g sin - Fr ; Th vd/a = a Fr
        y=mp.lu_solve(matrix([[m,1],[Th/a,-a]]),matrix([m*g*sin(al),0])); vd,Fr=y
        if Fr>mu*m*g*cos(al): vd=g*sin(al)-mu*g*cos(al)
        return abs(vd-g*sin(al)/(1+Th/(m*a*a)))+abs(vd-mpf(5)/7*g*sin(al))
    return f
N.under(13,f13(False),[f13(True)],assumptions=['the ball rolls without slipping (mu_0 >= (2/7) tan alpha)'],also_accept=['holds'])
def f14():
    # rate of the energy from Newton-Euler on an incline, rolling
    m,a,g,al,v=rnd(),rnd(),rnd(9,10),rnd(.2,1.2),rnd(); Th=rnd(.2,.66)*m*a*a
    vd,Fr=mp.lu_solve(matrix([[m,1],[Th/a,-a]]),matrix([m*g*sin(al),0])); w=v/a; wd=a*Fr/Th; zd=-v*sin(al)
    flat=m*v*vd+Th*w*wd+m*g*zd
    # 3D: rolling in any direction on a curved fixed ground: contact force R at P does no work since v_P = 0
    vS=rv(); n=rv(); n=n/sqrt(dot(n,n)); vS=vS-n*dot(n,vS); piv=rnd(); om=cross(n,vS)/a+piv*n; SP=-a*n; assert nrm(vS+cross(om,SP))<mpf('1e-40')
    Rf=rv(); acc=Rf/m+V(0,0,-g); omd=cross(SP,Rf)/Th
    return abs(flat)+abs(m*dot(vS,acc)+Th*dot(om,omd)+m*g*vS[2])
N.holds(14,f14,stated_in_note=['rolling without slipping on fixed ground','no drag, no rolling resistance'])
N.definition(15)
# ---- rocket: momentum of rocket and expelled gas together ----
def rocket(abszero=False,const=False):
    o=Mod(); t=o.t=mpf('0.3'); o.m0,o.b=rnd(5,8),rnd(.3,1)
    mf=(lambda s:o.m0-o.b*s-mpf('.2')*s*s) if not const else (lambda s:o.m0)
    o.v=rvfun(); o.u=rvfun()
    if abszero: o.u=lambda s:-o.v(s)
    o.m=mf; o.md=D(mf,t); o.vd=D(o.v,t)
    gasrate=-o.md*(o.v(t)+o.u(t))                       # momentum flux into the gas
    o.F=D(lambda s:mf(s)*o.v(s),t)+gasrate
    return o
T=mpf('1e-15')
N.holds(16,lambda:(lambda o:nrm(o.m(o.t)*o.vd-o.F-o.u(o.t)*o.md))(rocket()),tol=T)
f17=lambda **k:lambda:(lambda o:nrm(D(lambda s:o.m(s)*o.v(s),o.t)-o.F))(rocket(**k))
f17g=lambda:(lambda o:nrm(D(lambda s:o.m(s)*o.v(s),o.t)-o.F-(o.u(o.t)+o.v(o.t))*o.md))(rocket())
N.under(17,f17(),[f17(abszero=True),f17(const=True)],corrected=f17g,tol=T,assumptions=['the expelled gas has no velocity in the inertial frame (u = -v)'],assumption_alternatives=[['the engine is off (m constant)']],
  general_form=r'\frac{\mathrm d}{\mathrm dt}\left(m\,\underline v\right)=\underline F+\left(\underline u+\underline v\right)\frac{\mathrm dm}{\mathrm dt}',also_accept=['wrong'])
def f18(sg,t0=False):
    def f():
        m0,b,w,g,v0=rnd(5,8),rnd(.3,1),rnd(3,6),rnd(9,10),rnd(); t=mpf(0) if t0 else rnd(1,3); m=lambda s:m0-b*s
        v=v0+quad(lambda s:(-m(s)*g+(-w)*(-b))/m(s),[0,t]) if t else v0
        return v-(v0+sg*w*log(m(t)/m0)-g*t)
    return f
N.wrong(18,f18(1),(r'\ln\frac{m(t)}{m_0}',r'\ln\frac{m_0}{m(t)}'),f18(-1),'inverted mass ratio',others=[(r'v(t)=v_0-w\ln\frac{m(t)}{m_0}-g\,t',f18(-1))],
  special=[('t = 0 (no fuel burnt yet)',f18(1,True))],tol=T)
def f19():
    m0,b,w,g=mpf(12000),mpf(80),mpf(2500),mpf('9.81'); assert m0-b*100==4000
    v=quad(lambda s:-g+w*b/(m0-b*s),[0,100]); e=2500*log(mpf(3))-mpf('9.81')*100
    return abs(v-e)+(0 if abs(e-1766)<mpf('.5') else 1)
N.holds(19,f19,tol=T)
N.finish()
