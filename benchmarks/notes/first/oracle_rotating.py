from common import *; from vec import *
from mpmath import mp, mpf, sin, cos, sqrt, pi, expm, findroot, polyroots, mpc
N=Note('rotating.tex')
TOL=mpf('1e-12')  # nested numerical derivatives
class Mod: pass
def model(par=False):
    """R0 components throughout; frame R1 = (A(t), R(t)), particle at A + R rho(t)"""
    o=Mod(); t=o.t=mpf('0.3')
    o.R=rrot(); o.A=rvfun(); o.rho=rvfun(); o.bB=rv()
    o.OM=lambda t:o.A(t)+o.R(t)*o.rho(t)
    o.OmF=lambda t:angvel(o.R,t); o.Om=o.OmF(t)
    o.U=rvfun()
    o.AM=o.OM(t)-o.A(t)
    o.V0=D(o.OM,t); o.V1=o.R(t)*D(o.rho,t); o.VA=D(o.A,t)
    return o
def f1():
    o=model(); t=o.t
    d1=o.R(t)*D(lambda s:o.R(s).T*o.U(s),t)
    return nrm(D(o.U,t)-d1-cross(o.Om,o.U(t)))
N.holds(1,f1,tol=TOL)
N.definition(2,stated_in_note=['O is fixed in R0'])
def f3(sg,om=None,am=False):
    def f():
        o=model()
        if am: # A, M on the axis: AM parallel to Omega
            o.rho0=o.R(o.t).T*o.Om*rnd()
            o.OM=lambda t:o.A(t)+o.R(t)*(o.rho0+o.rho(t)-o.rho(o.t)); o.AM=o.OM(o.t)-o.A(o.t); o.V0=D(o.OM,o.t)
        if om==0:
            R0=o.R(o.t); o.R=lambda t:R0; o.Om=V(0,0,0); o.V0=D(o.OM,o.t)
        return nrm(o.V0-o.V1-o.VA-sg*cross(o.Om,o.AM))
    return f
old=r'\overrightarrow\Omega(\mathcal R_1/\mathcal R_0)\wedge\overrightarrow{MA}'
L3=N.latex(3)
N.wrong(3,f3(-1),(old,old.replace('{MA}','{AM}')),f3(1),'reversed position vector',wrong_term=r'\overrightarrow{MA}',
  others=[(L3.replace(old,r'\overrightarrow{MA}\wedge\overrightarrow\Omega(\mathcal R_1/\mathcal R_0)'),f3(1)),(L3.replace('+'+old,'-'+old),f3(1))],
  special=[('M coincides with A or AM is parallel to Omega',f3(-1,am=True)),('R1 does not rotate',f3(-1,om=0))],tol=TOL)
def f4():
    o=model(); t=o.t; OB=lambda s:o.A(s)+o.R(s)*o.bB
    BA=o.A(t)-OB(t)
    return nrm(D(OB,t)-o.VA-cross(BA,o.Om))
N.holds(4,f4,tol=TOL,stated_in_note=['A and B are fixed in R1'])
N.definition(5)
def f6():
    o=model(); t=o.t
    G0=D(o.OM,t,2); G1=o.R(t)*D(o.rho,t,2); dOm=D(o.OmF,t)
    Ge=D(o.A,t,2)+cross(dOm,o.AM)+cross(o.Om,cross(o.Om,o.AM))
    return nrm(G0-G1-Ge-2*cross(o.Om,o.V1))
N.holds(6,f6,tol=TOL)
def two(par=False,const=False):
    t=mpf('0.3')
    if par:
        n=randrot(); a,b=rfun(),rfun(); R1=lambda s:n*Rz(a(s)); R21=lambda s:Rz(b(s))
    else: R1=rrot(); R21=rrot()
    R2=lambda s:R1(s)*R21(s)
    w10=lambda s:angvel(R1,s); w20=lambda s:angvel(R2,s)
    w21_1=lambda s:angvel(R21,s)       # R1 components
    return t,R1,R2,w10,w20,w21_1
def f7():
    t,R1,R2,w10,w20,w21=two()
    # Omega(R0/R2): rotation of R0 seen from R2, components turned to R0
    w02=R2(t)*angvel(lambda s:R2(s).T,t)
    return nrm(w20(t)-R1(t)*w21(t)-w10(t))+nrm(w20(t)+w02)
N.holds(7,f7,tol=TOL)
def f8(par=False,zero=None,gen=False):
    def f():
        t,R1,R2,w10,w20,w21=two(par)
        e=D(w20,t)-R1(t)*D(w21,t)-D(w10,t)
        if gen: e=e-cross(w10(t),R1(t)*w21(t))
        return nrm(e)
    return f
N.under(8,f8(),[f8(par=True)],corrected=f8(gen=True),tol=TOL,
  assumptions=['Omega(R2/R1) is parallel to Omega(R1/R0) (or one of them is zero)'],also_accept=['wrong'],
  general_form=N.latex(8)+r'+\overrightarrow\Omega(\mathcal R_1/\mathcal R_0)\wedge\overrightarrow\Omega(\mathcal R_2/\mathcal R_1)')
def f9(k,rc=False,qc=False):
    def f():
        r,q=rfun(),rfun(); t=mpf('0.3'); Q=randrot()
        if rc: r=lambda s:mpf('1.3')
        if qc: q=lambda s:mpf('0.7')
        P=lambda s:Q*V(r(s)*cos(q(s)),r(s)*sin(q(s)),0)
        er=Q*V(cos(q(t)),sin(q(t)),0); et=Q*V(-sin(q(t)),cos(q(t)),0)
        rd,qd,rdd,qdd=D(r,t),D(q,t),D(r,t,2),D(q,t,2)
        return nrm(D(P,t,2)-(rdd-r(t)*qd**2)*er-(r(t)*qdd+k*rd*qd)*et)
    return f
N.wrong(9,f9(1),(r'\dot r\,\dot\theta\right)',r'2\,\dot r\,\dot\theta\right)'),f9(2),'missing factor 2 of the Coriolis term',wrong_term=r'+\dot r\,\dot\theta',
  special=[('rdot = 0',f9(1,rc=True)),('thetadot = 0',f9(1,qc=True))],tol=TOL)
# ---- Earth ----
def earth(lam=None,Om=None):
    o=Mod(); o.lam=rnd(.2,1.2) if lam is None else lam; o.Om=rnd(.2,.9) if Om is None else Om; lon=rnd(0,3)
    o.ez=V(cos(o.lam)*cos(lon),cos(o.lam)*sin(lon),sin(o.lam))      # zenith, geocentric axes, z to the north pole
    o.ex=V(-sin(lon),cos(lon),0); o.ey=cross(o.ez,o.ex)
    o.OmV=V(0,0,o.Om); o.B=matrix([[dot(a,V(1,0,0)) for a in (o.ex,o.ey,o.ez)],[dot(a,V(0,1,0)) for a in (o.ex,o.ey,o.ez)],[dot(a,V(0,0,1)) for a in (o.ex,o.ey,o.ez)]])
    o.w=o.B.T*o.OmV   # local components of the rotation vector
    return o
def f10(sw,lam=None):
    def f():
        o=earth(lam); a,b=(sin(o.lam),cos(o.lam)) if sw else (cos(o.lam),sin(o.lam))
        return nrm(o.OmV-o.Om*(a*o.ey+b*o.ez))
    return f
N.wrong(10,f10(1),(N.latex(10).split('=')[1],r'\Omega_T\left(\cos\lambda\,\overrightarrow{e_y}+\sin\lambda\,\overrightarrow{e_z}\right)'),f10(0),
  'sine and cosine of the latitude exchanged',special=[('latitude 45 degrees',f10(1,pi/4))])
def f11():
    Om=rnd(.2,.9); m=rnd(); GM=rnd(5,9); t=mpf('0.3'); q=rvfun(); rho=lambda s:q(s)+V(6,2,3)  # in R_T axes, origin at the centre
    R=lambda s:Rz(Om*s); r=lambda s:R(s)*rho(s)
    att=-GM*r(t)/sqrt(dot(r(t),r(t)))**3
    F=m*D(r,t,2)-m*att                       # Newton in R0
    w=V(0,0,Om); gap=att-cross(w,cross(w,r(t)))
    return nrm(m*(R(t)*D(rho,t,2))-F-m*gap+2*m*cross(w,R(t)*D(rho,t)))
N.holds(11,f11,tol=TOL,stated_in_note=['geocentric frame Galilean','constant rotation vector','g contains the centrifugal term'])
def f12(sg,lam=None,xd=None):
    def f():
        o=earth(lam); v=rv(); g=rnd(9,10)
        if xd is not None: v[0]=xd
        a=V(0,0,-g)-2*cross(o.w,v); s,c=sin(o.lam),cos(o.lam)
        return nrm(a-V(2*o.Om*(v[1]*s-v[2]*c),sg*2*o.Om*v[0]*s,-g+2*o.Om*v[0]*c))
    return f
N.wrong(12,f12(1),(r'\ddot y=2\,',r'\ddot y=-2\,'),f12(-1),'sign of a Coriolis component',wrong_term=r'\ddot y=2\,\Omega_T\,\dot x\sin\lambda',part='second row',
  special=[('xdot = 0',f12(1,xd=0)),('at the equator (lambda = 0)',f12(1,lam=mpf(0)))],
  stated_in_note=['free fall, uniform g'],remark='independent of the exchange in display 10; with the correct rotation vector the first and third rows are right')
def f13(Om):
    o=earth(Om=Om); g=rnd(9,10); h=rnd(5,20)
    A=mp.zeros(7,7)                       # state x(3) v(3) 1
    W=sk(o.w)
    for i in range(3):
        A[i,3+i]=1
        for j in range(3): A[3+i,3+j]=-2*W[i,j]
    A[5,6]=-g
    st=lambda t:expm(A*t,method='taylor')*matrix([0,0,h,0,0,0,1])
    T=sqrt(2*h/g)
    for _ in range(12):                    # Newton on z(T)=0
        y=st(T); dT=y[2]/y[5]; T-=dT
        if abs(dT)<mpf(10)**-40: break
    y=st(T); return y[0]/(o.Om*g*cos(o.lam)/3*sqrt(2*h/g)**3)-1
N.under(13,lambda:f13(mpf('0.4')),[lambda:f13(mpf('1e-15'))],tol=mpf('1e-10'),assumptions=['first order in Omega_T (slow rotation of the Earth during the fall)'],
  stated_in_note=['first order in Omega_T','no initial velocity','free fall without air drag, uniform g'],also_accept=['holds'])
e_=mpf(10)**-18
def f14(sg,lam=None,zd=None):
    def f():
        o=earth(lam); l=rnd(1,5); g=rnd(9,10); w02=g/l
        x,y=e_*rnd(),e_*rnd(); z=-sqrt(l*l-x*x-y*y)
        vx,vy=(e_*rnd(),e_*rnd()) if zd is None else (mpf(0),mpf(0))
        vz=-(x*vx+y*vy)/z; r=V(x,y,z); v=V(vx,vy,vz)
        a0=V(0,0,-g)-2*cross(o.w,v)
        k=(-dot(v,v)-dot(r,a0))/dot(r,r); a=a0+k*r
        Z=mpc(x,y); Zd=mpc(vx,vy); Zdd=mpc(a[0],a[1])
        return abs(Zdd+sg*2j*o.Om*sin(o.lam)*Zd+w02*Z)/e_
    return f
N.wrong(14,f14(-1),(r'\ddot\zeta-2',r'\ddot\zeta+2'),f14(1),'sign of the Coriolis term',wrong_term=r'-2\,i\,\Omega_T\sin\lambda\,\dot\zeta',tol=mpf('1e-12'),
  special=[('at the equator (lambda = 0)',f14(-1,lam=mpf(0))),('zetadot = 0',f14(-1,zd=0))],stated_in_note=['small swings','vertical velocity and change of tension neglected'],
  remark='the corrected line holds for small swings (stated); not a consequence of display 12')
def TF(o,w0):
    r=polyroots([1,2j*o.Om*sin(o.lam),w0**2],maxsteps=200,extraprec=200)
    return 2*pi/abs((r[0].imag+r[1].imag)/2)    # mean of the two frequencies = rate of the plane of the swing
def f15(fn,lam=None):
    def f():
        o=earth(lam); return TF(o,rnd(2,3))-2*pi/(o.Om*fn(o.lam))
    return f
N.wrong(15,f15(cos),(r'\cos\lambda',r'\sin\lambda'),f15(sin),'cosine for sine of the latitude',special=[('latitude 45 degrees',f15(cos,pi/4))],
  remark='with display 10 as written (sine and cosine exchanged) the vertical component would be Omega_T cos(lambda), so a reader may also say that this line carries the slip of display 10')
lamP=mpf('48.85')*pi/180
def f16(fn,num):
    # the physical period (from the roots) against the formula and the printed number
    o=earth(lamP,2*pi/mpf('23.93')); true=TF(o,mpf(300)); return abs(true-mpf('23.93')/fn(lamP))/true+(abs(mpf('23.93')/fn(lamP)-num)/num if abs(mpf('23.93')/fn(lamP)-num)>mpf('0.05') else 0)
assert abs(mpf('23.93')/cos(lamP)-mpf('36.4'))<0.05
N.wrong(16,lambda:f16(cos,mpf('36.4')),(N.latex(16).split('=',1)[1],r'\frac{23.93\ \mathrm h}{\sin 48.85^\circ}\approx31.8\ \mathrm h'),lambda:f16(sin,mpf('31.8')),
  'carries the cosine of the line before',remark='carries: consequence of display 15; the arithmetic itself is right',also_accept=[])
N.finish()
