"""Gyrostat as explicit mass points (carrier: 5 points, wheel: 4 points 90 deg apart, off the mass centre), 50 digits; linear part by SymPy."""
from mpmath import mp, mpf, matrix, sin, cos, sqrt, diff, eye, zeros
import json, random, sympy as sp
mp.dps=50; random.seed(23)
rnd=lambda: mpf(random.randint(-10**6,10**6))/10**6
def vec(): return matrix([rnd() for _ in range(3)])
def cr(a,b): return matrix([a[1]*b[2]-a[2]*b[1], a[2]*b[0]-a[0]*b[2], a[0]*b[1]-a[1]*b[0]])
def dot(a,b): return (a.T*b)[0]
n_=lambda z: abs(z) if not hasattr(z,'rows') else max(abs(e) for e in z)
def d(f,t,n=1): return matrix([diff(lambda s:f(s)[i], t, n) for i in range(f(t).rows)])
k=[rnd() for _ in range(20)]
def Rot(t):
    a,b,c = k[0]+k[1]*t+sin(t*k[2]), k[3]*t+cos(k[4]*t), k[5]+t*t*k[6]+t*k[7]
    R1=matrix([[1,0,0],[0,cos(a),-sin(a)],[0,sin(a),cos(a)]]); R2=matrix([[cos(b),0,sin(b)],[0,1,0],[-sin(b),0,cos(b)]])
    R3=matrix([[cos(c),-sin(c),0],[sin(c),cos(c),0],[0,0,1]]); return R3*R2*R1
a=vec(); a=a/sqrt(dot(a,a)); b1=cr(a,matrix([0,0,1])); b1=b1/sqrt(dot(b1,b1)); b2=cr(a,b1)
mc=[1+abs(rnd()) for _ in range(5)]; qc=[vec() for _ in range(5)]; mw=mpf('0.7'); rw=mpf('0.45'); qw=vec()
gam=lambda t: k[8]*t+mpf('0.8')*t*t+sin(k[9]*t)*2; nu=lambda t: diff(gam,t)
Mt=sum(mc)+4*mw; G=(sum((mc[i]*qc[i] for i in range(5)),zeros(3,1))+4*mw*qw)/Mt
qc=[q-G for q in qc]; qw=qw-G
wp=lambda j,t: qw+rw*(b1*cos(gam(t)+j*mp.pi/2)+b2*sin(gam(t)+j*mp.pi/2))
pts=[(mc[i],(lambda t,i=i: Rot(t)*qc[i])) for i in range(5)]+[(mw,(lambda t,j=j: Rot(t)*wp(j,t))) for j in range(4)]
t0=mpf('0.43'); R0=Rot(t0)
def om(t):
    S=matrix([[diff(lambda s:Rot(s)[i,j],t) for j in range(3)] for i in range(3)]); S=Rot(t).T*S
    return matrix([S[2,1]-S[1,2],S[0,2]-S[2,0],S[1,0]-S[0,1]])/2       # carrier axes
w=om(t0); wd=d(om,t0)
I=zeros(3,3)
for i in range(5): I+=mc[i]*(dot(qc[i],qc[i])*eye(3)-qc[i]*qc[i].T)
for j in range(4):
    q=wp(j,t0); I+=mw*(dot(q,q)*eye(3)-q*q.T)
I2=zeros(3,3)
for i in range(5): I2+=mc[i]*(dot(qc[i],qc[i])*eye(3)-qc[i]*qc[i].T)
for j in range(4):
    q=wp(j,t0+1); I2+=mw*(dot(q,q)*eye(3)-q*q.T)
assert n_(I-I2)<mpf(10)**-45       # inertia does not change as the wheel turns
Is=4*mw*rw**2
Hf=lambda t: sum((m*cr(f(t),d(f,t)) for m,f in pts),zeros(3,1))
H=R0.T*Hf(t0); Mo=R0.T*sum((m*cr(f(t0),d(f,t0,2)) for m,f in pts),zeros(3,1))
T=sum(m*dot(d(f,t0),d(f,t0)) for m,f in pts)/2; Td=sum(m*dot(d(f,t0),d(f,t0,2)) for m,f in pts)
n0,nd=nu(t0),diff(gam,t0,2)
cen=lambda t: Rot(t)*qw
tau=sum(dot(R0*a,cr(f(t0)-cen(t0),m*(d(f,t0,2)-d(cen,t0,2)))) for m,f in pts[5:])
res={}
res[1]=(n_(H-I*w-Is*n0*a),None)
res[2]=(n_(I*wd+Is*nd*a+cr(w,I*w)-Mo),n_(I*wd+Is*nd*a+cr(w,I*w+Is*n0*a)-Mo))
res[3]=(abs(Is*(nd+dot(a,wd))-tau),None)
res[4]=(abs(T-dot(w,I*w)/2-Is*n0*dot(a,w)/2-Is*n0**2/2),abs(T-dot(w,I*w)/2-Is*n0*dot(a,w)-Is*n0**2/2))
res[5]=(abs(Td-dot(w,Mo)-tau*n0),None)
mu=mpf('3.1'); Rd=vec(); Rd=Rd/sqrt(dot(Rd,Rd))
P=[(m,R0.T*f(t0)) for m,f in pts]
def exact(R): # true moment: sum rho x force
    return sum((cr(p,-mu*m*(R+p)/sqrt(dot(R+p,R+p))**3) for m,p in P),zeros(3,1))
R=Rd*7
res[6]=(n_(exact(R)+mu*sum((m*cr(p,R)/sqrt(dot(R+p,R+p))**3 for m,p in P),zeros(3,1))),None)
def appr(R): r=sqrt(dot(R,R)); return 3*mu/r**5*cr(R,I*R)
rel=[n_(exact(Rd*s)-appr(Rd*s))/n_(appr(Rd*s)) for s in (10,mpf(10)**4,mpf(10)**8)]
res[7]=('relative error at R/rho = 10, 1e4, 1e8: '+', '.join(mp.nstr(x,3) for x in rel),None)
n=mpf('0.31'); r0=(mu/n**2)**(mpf(1)/3)
O=lambda t: matrix([[-sin(n*t),0,-cos(n*t)],[cos(n*t),0,-sin(n*t)],[0,-1,0]])     # columns o1,o2,o3 in inertial axes
assert n_(cr(O(t0)[:,2],O(t0)[:,0])-O(t0)[:,1])<mpf(10)**-45
Cf=lambda t: Rot(t).T*O(t); C=Cf(t0); c1,c2,c3=[C[:,j] for j in range(3)]
Rcol=-r0*c3
res[8]=(n_(appr(Rcol)-3*n**2*cr(c3,I*c3)),None)
Cd=matrix([[diff(lambda s:Cf(s)[i,j],t0) for j in range(3)] for i in range(3)])
S=Cd*C.T; wr=-matrix([S[2,1]-S[1,2],S[0,2]-S[2,0],S[1,0]-S[0,1]])/2     # rotation of the carrier relative to the orbital axes
# independent: relative angular velocity from dB/dt seen in orbit axes
Brel=lambda t:O(t).T*Rot(t); Bd=matrix([[diff(lambda s:Brel(s)[i,j],t0) for j in range(3)] for i in range(3)]); S2=Brel(t0).T*Bd
wr2=matrix([S2[2,1]-S2[1,2],S2[0,2]-S2[2,0],S2[1,0]-S2[0,1]])/2; assert n_(wr-wr2)<mpf(10)**-40
res[9]=(n_(wr-w+n*c2),n_(wr-w-n*c2))
res[10]=(max(n_(Cd[:,j]+cr(wr2,C[:,j])) for j in range(3)),None)
# integral: nu constant, moment 3 n^2 c3 x I c3
h=Is*n0
W=w; Wd=I**-1*(3*n**2*cr(c3,I*c3)-cr(W,I*W+h*a)); WR=W+n*c2
cd=lambda c:-cr(WR,c); WRd=Wd+n*cd(c2)
base=dot(WR,I*WRd)+3*n**2*dot(c3,I*cd(c3))+n*h*dot(a,cd(c2)); t2=n**2*dot(c2,I*cd(c2))
res[11]=(abs(base+t2),abs(base-t2))
# ---- linear part, SymPy
t,e=sp.symbols('t e'); A,B,Cc,N,hh=sp.symbols('A B C n h',real=True); q=[sp.Function(s)(t) for s in ('phi','theta','psi')]
E1=lambda x: sp.Matrix([[1,0,0],[0,sp.cos(x),sp.sin(x)],[0,-sp.sin(x),sp.cos(x)]]); E2=lambda x: sp.Matrix([[sp.cos(x),0,-sp.sin(x)],[0,1,0],[sp.sin(x),0,sp.cos(x)]]); E3=lambda x: sp.Matrix([[sp.cos(x),sp.sin(x),0],[-sp.sin(x),sp.cos(x),0],[0,0,1]])
CC=E1(e*q[0])*E2(e*q[1])*E3(e*q[2])
lin=lambda z: sp.expand(sp.simplify((z.subs(e,0)+e*sp.diff(z,e).subs(e,0)).doit()))
L=lambda Mx: Mx.applyfunc(lin)
ph,th,ps=q
want=[sp.Matrix([1,-e*ps,e*th]),sp.Matrix([e*ps,1,-e*ph]),sp.Matrix([-e*th,e*ph,1])]
z=lambda ok: 'first order: '+('ok' if ok else 'NOT ok')
res[12]=(z(all(sp.simplify(L(CC[:,j])-want[j])==sp.zeros(3,1) for j in range(3))),None)
Sd=sp.diff(CC,t)*CC.T; wrs=-sp.Matrix([Sd[2,1]-Sd[1,2],Sd[0,2]-Sd[2,0],Sd[1,0]-Sd[0,1]])/2
ws=wrs-N*CC[:,1]
D=lambda f: sp.diff(f,t)
wl=L(ws); res[13]=(z(sp.simplify(wl-sp.Matrix([e*D(ph)-N*e*ps,e*D(th)-N,e*D(ps)+N*e*ph]))==sp.zeros(3,1)),None)
II=sp.diag(A,B,Cc); Ms=3*N**2*CC[:,2].cross(II*CC[:,2]); Ml=L(Ms)
res[14]=(z(sp.simplify(Ml+3*N**2*e*sp.Matrix([(B-Cc)*ph,(A-Cc)*th,0]))==sp.zeros(3,1)),None)
eq=II*sp.diff(ws,t)+ws.cross(II*ws+sp.Matrix([0,hh,0]))-Ms; el=L(eq)
zz=lambda expr: 'identically 0' if sp.simplify(sp.expand(expr))==0 else 'nonzero: '+str(sp.factor(sp.simplify(expr)))
P=lambda sg: e*(B*D(D(th))+sg*3*N**2*(A-Cc)*th)
res[15]=(zz(el[1]-P(-1)),zz(el[1]-P(1)))
Rl=lambda f: e*(A*D(D(ph))+(f*N**2*(B-Cc)-N*hh)*ph-(N*(A-B+Cc)+hh)*D(ps))
res[16]=(zz(el[0]-Rl(3)),zz(el[0]-Rl(4)))
res[17]=('first order: '+zz(el[2]-e*(Cc*D(D(ps))+(N**2*(B-A)-N*hh)*ps+(N*(A-B+Cc)+hh)*D(ph))),None)
res[18]=('p^2 from exact pitch line: '+zz(sp.expand(el[1]/e).coeff(th)/sp.expand(el[1]/e).coeff(D(D(th)))-3*N**2*(A-Cc)/B),None)
lam=sp.symbols('lam'); 
# n=0:  A s^2 , -h s ; h s, C s^2   -> s^2 (A C s^2 + h^2)
det=sp.Matrix([[A*lam**2,-hh*lam],[hh*lam,Cc*lam**2]]).det()
res[19]=(zz(det.subs(lam**2,-hh**2/(A*B)).subs(lam**4,hh**4/(A*B)**2)),zz(sp.expand(det/lam**2).subs(lam,sp.I*hh/sp.sqrt(A*Cc))))
# nutation read from el as n->0
e0=[sp.expand(el[i]/e).subs(N,0) for i in (0,2)]
res['19 check of the pair']=(str(e0),None)
out={str(i):[mp.nstr(x,5) if isinstance(x,mpf) else x for x in r] for i,r in res.items()}
for i,r in out.items(): print(i,r)
json.dump(out,open('out_wheel_satellite.json','w'),indent=1)
