"""Two particles, variable mass, rotating frames: 50-digit numbers / SymPy."""
from mpmath import mp, mpf, matrix, sin, cos, sqrt, diff, log, zeros, acos, atan2, odefun, taylor
import json, random, sympy as sp
mp.dps=50; random.seed(77)
rnd=lambda: mpf(random.randint(-10**6,10**6))/10**6
def vec(): return matrix([rnd() for _ in range(3)])
def cr(a,b): return matrix([a[1]*b[2]-a[2]*b[1], a[2]*b[0]-a[0]*b[2], a[0]*b[1]-a[1]*b[0]])
def dot(a,b): return (a.T*b)[0]
N_=lambda z: abs(z) if not hasattr(z,'rows') else max(abs(e) for e in z)
res={}
m1,m2=mpf('1.7'),mpf('0.6'); M=m1+m2; mu=m1*m2/M
r1,r2,v1,v2=vec(),vec(),vec(),vec(); R=(m1*r1+m2*r2)/M; V=(m1*v1+m2*v2)/M; r=r1-r2; v=v1-v2
res[1]=('definition',None)
res[2]=(max(N_(r1-R-m2/M*r),N_(r2-R+m1/M*r)),None)
T=m1*dot(v1,v1)/2+m2*dot(v2,v2)/2
res[3]=(max(abs(T-M*dot(V,V)/2-mu*dot(v,v)/2),N_(m1*cr(r1,v1)+m2*cr(r2,v2)-M*cr(R,V)-mu*cr(r,v))),None)
g=vec(); F12=vec(); a1,a2=F12/m1+g,-F12/m2+g
res[4]=(N_(mu*(a1-a2)-F12),None)
res[5]=('definition',None)
e=mpf('0.55'); n=vec(); n=n/sqrt(dot(n,n)); 
if dot(n,v)>0: n=-n                        # approaching: n from 2 to 1, n.v<0
# solve the impulse from momentum balance and the restitution law directly
j=-(1+e)*dot(n,v)/(1/m1+1/m2); w1,w2=v1+j/m1*n,v2-j/m2*n
assert abs(dot(n,w1-w2)+e*dot(n,v))<mpf(10)**-45
res[6]=(N_(m1*(w1-v1)+(1+e)*mu*dot(n,v)*n),None)
T2=m1*dot(w1,w1)/2+m2*dot(w2,w2)/2
res[7]=(abs(T2-T+(1-e)**2*mu*dot(n,v)**2/2),abs(T2-T+(1-e**2)*mu*dot(n,v)**2/2))
u=matrix([1,0]); chi=mpf('0.8'); Vc=m1/M*u; rel=matrix([cos(chi),sin(chi)]); lab=Vc+m2/M*rel
tanl=lab[1]/lab[0]
res[8]=(abs(tanl-sin(chi)/(cos(chi)+m2/m1)),abs(tanl-sin(chi)/(cos(chi)+m1/m2)))
# variable mass: momentum balance over dt of body m + parcel dm (velocity w): (m+dm)(v+dv) - m v - dm w = F dt
ms,vs,ws,Fs,dm,dv,dt=sp.symbols('m v w F dm dv dt'); md,vd=sp.symbols('mdot vdot')
bal=sp.limit(sp.expand(((ms+md*dt)*(vs+vd*dt)-ms*vs-md*dt*ws-Fs*dt)/dt),dt,0)   # = 0
z=lambda x: 'identically 0' if sp.simplify(x)==0 else 'nonzero: '+str(sp.factor(sp.simplify(x)))
lhs=md*vs+ms*vd
res[9]=(z(lhs-Fs-md*(ws-vs)-bal),z(lhs-Fs-md*ws-bal)+' / '+z(ms*vd-Fs-md*(ws-vs)-bal))
us,gs=sp.symbols('u g',positive=True)
rb=bal.subs({ws:vs-us,Fs:-ms*gs})
res[10]=(z(ms*vd-md*us+ms*gs-rb),z(ms*vd+md*us+ms*gs-rb))
t=sp.symbols('t',positive=True); m0=sp.symbols('m_0',positive=True); mt=sp.Function('m',positive=True)(t)
vt=us*sp.log(m0/mt)-gs*t
res[11]=(z(mt*sp.diff(vt,t)+sp.diff(mt,t)*us+mt*gs),None)
kap=sp.symbols('kappa',positive=True)
rain=bal.subs({ws:0,Fs:ms*gs}).subs(md,kap*ms*vs)
res[12]=(z((vd-gs+kap*vs**2)*ms-rain),None)
x=sp.Function('x')(t); lam=sp.symbols('mu',positive=True); D=lambda q: sp.diff(q,t)
F=D(lam*x*D(x))+lam*x*gs          # momentum of the moving part (heap held by floor), weight of the moving part
res[13]=(z(F-lam*(gs*x+x*D(D(x))+D(x)**2/2)),z(F-lam*(gs*x+x*D(D(x))+D(x)**2)))
E=lam*x*D(x)**2/2+lam*gs*x**2/2
res[14]=(z(D(E)-F*D(x)+lam*D(x)**3/2),None)
# rotating frames: R(t) with variable Omega, particle path in R
k=[rnd() for _ in range(20)]
def Rot(t):
    a,b,c=k[0]+k[1]*t+sin(t*k[2]),k[3]*t+cos(k[4]*t),k[5]+t*t*k[6]+t*k[7]
    R1=matrix([[1,0,0],[0,cos(a),-sin(a)],[0,sin(a),cos(a)]]); R2=matrix([[cos(b),0,sin(b)],[0,1,0],[-sin(b),0,cos(b)]])
    R3=matrix([[cos(c),-sin(c),0],[sin(c),cos(c),0],[0,0,1]]); return R3*R2*R1
d=lambda f,t,n=1: matrix([diff(lambda s:f(s)[i],t,n) for i in range(3)])
def Om(t):
    S=Rot(t).T*matrix([[diff(lambda s:Rot(s)[i,j],t) for j in range(3)] for i in range(3)])
    return matrix([S[2,1]-S[1,2],S[0,2]-S[2,0],S[1,0]-S[0,1]])/2
p=lambda t: matrix([sin(k[8]*t)+k[9]*t,cos(k[10]*t),k[11]*t**3+k[12]*t])
t0=mpf('0.7'); aI=Rot(t0).T*d(lambda s:Rot(s)*p(s),t0,2); O,Od=Om(t0),d(Om,t0); P,Pv,Pa=p(t0),d(p,t0),d(p,t0,2)
res[15]=(N_(aI-Pa-2*cr(O,Pv)-cr(Od,P)-cr(O,cr(O,P))),None)
mm=mpf('1.3'); Fv=mm*aI
q16=mm*Pa-Fv+2*mm*cr(O,Pv)+mm*cr(O,cr(O,P))
res[16]=('variable Omega: '+mp.nstr(N_(q16),5),'with Euler force: '+mp.nstr(N_(q16+mm*cr(Od,P)),5)+' (so true for constant Omega)')
la,Om_=mpf('0.52'),mpf('0.21'); g9=mpf('9.7'); xd=vec(); Oe=matrix([0,Om_*cos(la),Om_*sin(la)])
acc=matrix([0,0,-g9])-2*cr(Oe,xd)
w17=lambda f: N_(acc-matrix([2*Om_*(xd[1]*sin(la)-xd[2]*cos(la)),-2*Om_*xd[0]*f,-g9+2*Om_*xd[0]*cos(la)]))
res[17]=(w17(cos(la)),w17(sin(la)))
# drop: exact solution of the linear system, series in Omega
OO,gg,L_,tt=sp.symbols('Omega g lambda t',positive=True)
# Picard: v0=(0,0,-g t); first order xddot = 2 Omega g t cos(lambda)
x1=sp.integrate(sp.integrate(2*OO*gg*tt*sp.cos(L_),(tt,0,tt)),(tt,0,tt))
A=-2*sp.Matrix([[0,-OO*sp.sin(L_),OO*sp.cos(L_)],[OO*sp.sin(L_),0,0],[-OO*sp.cos(L_),0,0]])
xser=sum((( A**k_ )*sp.Matrix([0,0,-gg])*tt**(k_+2)/sp.factorial(k_+2) for k_ in range(0,6)),sp.zeros(3,1))[0]
xe=sp.expand(sp.simplify(xser))
res[18]=('first order in Omega: '+z(x1-OO*gg*tt**3*sp.cos(L_)/3),'exact minus formula: '+str(sp.factor(sp.simplify(xe-OO*gg*tt**3*sp.cos(L_)/3))))
# bead
w_,m_=sp.symbols('omega m',positive=True); s=sp.Function('s')(t)
px,py=s*sp.cos(w_*t),s*sp.sin(w_*t)
ar=sp.simplify(D(D(px))*sp.cos(w_*t)+D(D(py))*sp.sin(w_*t)); at=sp.simplify(-D(D(px))*sp.sin(w_*t)+D(D(py))*sp.cos(w_*t))
sdd=sp.solve(ar,D(D(s)))[0]
q=lambda sg: z(D(m_*D(s)**2/2+sg*m_*w_**2*s**2/2).subs(D(D(s)),sdd))
res[19]=(q(1),q(-1))
res[20]=(z(m_*at-m_*w_*D(s)),z(m_*at-2*m_*w_*D(s)))
out={str(i):[mp.nstr(x,5) if isinstance(x,mpf) else x for x in r] for i,r in res.items()}
for i,r in out.items(): print(i,r)
json.dump(out,open('out_many_bodies.json','w'),indent=1)
