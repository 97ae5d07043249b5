"""3-1-2 attitude: explicit rotations with smooth angle functions at 50 digits; free motion from conservation of momentum and symbolic."""
from mpmath import mp, mpf, matrix, sin, cos, tan, asin, atan, acos, sqrt, diff, eye, zeros, diag
import json, random
mp.dps=50; random.seed(5)
rnd=lambda: mpf(random.randint(-10**6,10**6))/10**6
def vec(): return matrix([rnd() for _ in range(3)])
def cr(a,b): return matrix([a[1]*b[2]-a[2]*b[1], a[2]*b[0]-a[0]*b[2], a[0]*b[1]-a[1]*b[0]])
def sk(a): return matrix([[0,-a[2],a[1]],[a[2],0,-a[0]],[-a[1],a[0],0]])
def dot(a,b): return (a.T*b)[0]
n=lambda z: abs(z) if not hasattr(z,'rows') else max(abs(e) for e in z)
def rotvec(a,ang,x): # active right-handed rotation of the vector x about unit a (Rodrigues, geometric construction)
    par=a*dot(a,x); per=x-par
    return par+per*cos(ang)+cr(a,per)*sin(ang)
E=[matrix([1,0,0]),matrix([0,1,0]),matrix([0,0,1])]
def geomC(ang):   # rows: unit vectors of B in N, by successive turning about own axes
    psi,phi,th=ang; b=[e.copy() for e in E]
    ax=b[2]; b=[rotvec(ax,psi,x) for x in b]
    ax=b[0]; b=[rotvec(ax,phi,x) for x in b]
    ax=b[1]; b=[rotvec(ax,th,x) for x in b]
    return matrix([list(x) for x in b])
def C1(a): return matrix([[1,0,0],[0,cos(a),sin(a)],[0,-sin(a),cos(a)]])
def C2(a): return matrix([[cos(a),0,-sin(a)],[0,1,0],[sin(a),0,cos(a)]])
def C3(a): return matrix([[cos(a),sin(a),0],[-sin(a),cos(a),0],[0,0,1]])
k=[rnd() for _ in range(20)]
psi=lambda t: mpf('0.4')+k[0]*t+k[1]*t*t; phi=lambda t: mpf('0.3')+k[2]*sin(t); th=lambda t: mpf('0.5')+k[3]*t+k[4]*cos(t)
t0=mpf('0.61')
Cf=lambda t: geomC((psi(t),phi(t),th(t)))
C=Cf(t0)
dm=lambda f,t: matrix([[diff(lambda s:f(s)[i,j],t) for j in range(f(t).cols)] for i in range(f(t).rows)])
Cd=dm(Cf,t0)
# angular velocity from the motion of the unit vectors b_j (geometric, in N): w = 1/2 sum b_j x bdot_j
bs=[C[j,:].T for j in range(3)]; bd=[Cd[j,:].T for j in range(3)]
wN=sum((cr(bs[j],bd[j]) for j in range(3)),zeros(3,1))/2
w=C*wN
p,f,h=psi(t0),phi(t0),th(t0); pd,fd,hd=[diff(z,t0) for z in (psi,phi,th)]
c,s=cos,sin
res={}
res[1]=(max(n(C1(f)*E[1]-matrix([0,c(f),-s(f)])),n(C2(h)*C2(h).T-eye(3)),n(C3(p)*C3(p).T-eye(3)), n(matrix([list(rotvec(E[i],f,e)) for i in [0] for e in E])-C1(f)),n(matrix([list(rotvec(E[1],h,e)) for e in E])-C2(h)),n(matrix([list(rotvec(E[2],p,e)) for e in E])-C3(p))),None)
res[2]=(n(C-C2(h)*C1(f)*C3(p)),None)
full=lambda sg: matrix([[c(h)*c(p)-s(h)*s(f)*s(p), c(h)*s(p)+s(h)*s(f)*c(p), -s(h)*c(f)],[-c(f)*s(p),c(f)*c(p),s(f)],[s(h)*c(p)+c(h)*s(f)*s(p), s(h)*s(p)+sg*c(h)*s(f)*c(p), c(h)*c(f)]])
res[3]=(n(C-full(1)),n(C-full(-1)))
res[4]=(max(abs(s(f)-C[1,2]),abs(tan(h)+C[0,2]/C[2,2]),abs(tan(p)+C[1,0]/C[1,1])),None)
e1=rotvec(E[2],p,E[0])
res[5]=(n(wN-pd*E[2]-fd*e1-hd*bs[1]),None)
res[6]=(n(w-matrix([fd*c(h)-pd*s(h)*c(f),hd+pd*s(f),fd*s(h)+pd*c(h)*c(f)])),None)
res[7]=(max(abs(fd-w[0]*c(h)-w[2]*s(h)),abs(pd-(w[2]*c(h)-w[0]*s(h))/c(f))),None)
res[8]=(abs(hd-w[1]-(w[2]*c(h)-w[0]*s(h))*tan(f)),abs(hd-w[1]+(w[2]*c(h)-w[0]*s(h))*tan(f)))
res[9]=(n(Cd+sk(w)*C),None)
Om=C.T*w
res[10]=(n(Cd+C*sk(Om)),None)
# axis angle: B obtained from N by a right-handed turn
a=vec(); a=a/sqrt(dot(a,a)); Ph=mpf('1.1')
def CaP(a,Ph): return matrix([list(rotvec(a,Ph,e)) for e in E])
Ca=CaP(a,Ph)
res[11]=(n(Ca-cos(Ph)*eye(3)-(1-cos(Ph))*a*a.T-sin(Ph)*sk(a)),n(Ca-cos(Ph)*eye(3)-(1-cos(Ph))*a*a.T+sin(Ph)*sk(a)))
res[12]=('definition',None)
g=a*tan(Ph/2)
def Cg(g): return ((1-dot(g,g))*eye(3)+2*g*g.T-2*sk(g))/(1+dot(g,g))
res[13]=(n(Ca-Cg(g)),None)
def gof(C):
    S=(C.T-C); v=matrix([S[2,1],S[0,2],S[1,0]]); return v/(1+C[0,0]+C[1,1]+C[2,2])
assert n(gof(Ca)-g)<mpf(10)**-40
gt=lambda t: gof(Cf(t)); gd=matrix([diff(lambda x:gt(x)[i],t0) for i in range(3)]); g0=gt(t0)
res[14]=(n(gd-(eye(3)-sk(g0)+g0*g0.T)*w/2),n(gd-(eye(3)+sk(g0)+g0*g0.T)*w/2))
res[15]=(n(w-2/(1+dot(g0,g0))*(eye(3)-sk(g0))*gd),None)
g1,g2=vec()/2,vec()/2; tot=gof(Cg(g2)*Cg(g1))
res[16]=(n(tot-(g1+g2-cr(g1,g2))/(1-dot(g1,g2))),n(tot-(g1+g2-cr(g2,g1))/(1-dot(g1,g2))))
J=[mpf('1.3'),mpf('2.1'),mpf('2.9')]; JD=diag(J); w0=vec(); wd=JD**-1*(-cr(w0,JD*w0))   # conservation of H in N
res[17]=(max(abs(J[0]*wd[0]-(J[1]-J[2])*w0[1]*w0[2]),abs(J[1]*wd[1]-(J[0]-J[2])*w0[2]*w0[0]),abs(J[2]*wd[2]-(J[0]-J[1])*w0[0]*w0[1])),
         max(abs(J[0]*wd[0]-(J[1]-J[2])*w0[1]*w0[2]),abs(J[1]*wd[1]-(J[2]-J[0])*w0[2]*w0[0]),abs(J[2]*wd[2]-(J[0]-J[1])*w0[0]*w0[1])))
Hv=JD*w0
res[18]=(max(abs(dot(w0,JD*w0)-sum(J[i]*w0[i]**2 for i in range(3))),abs(dot(Hv,Hv)-dot(w0,JD*JD*w0)),abs(dot(w0,JD*wd)),abs(dot(w0,JD*JD*wd))),None)
Jt,J3,nu,wt=mpf('1.7'),mpf('2.6'),mpf('0.9'),mpf('0.35'); lam=(J3-Jt)/Jt*nu; JA=diag([Jt,Jt,J3])
wf=lambda t: matrix([wt*cos(lam*t),wt*sin(lam*t),nu]); ww=wf(t0); wdd=matrix([diff(lambda x:wf(x)[i],t0) for i in range(3)])
res[19]=(n(JA*wdd+cr(ww,JA*ww)),None)
# general J: same law does not hold
res['19 without symmetry']=(n(JD*wdd+cr(ww,JD*ww)),None)
# precession: body-axis b3, H fixed in N. In B comps: N-derivative of b3 = w x b3 ; must equal Lam * Hhat x b3
H=JA*ww; Hm=sqrt(dot(H,H)); b3=E[2]
res[20]=(n(cr(ww,b3)-(Hm/J3)*cr(H/Hm,b3)),n(cr(ww,b3)-(Hm/Jt)*cr(H/Hm,b3)))
out={str(i):[mp.nstr(z,5) if isinstance(z,mpf) else z for z in r] for i,r in res.items()}
for i,r in out.items(): print(i,r)
json.dump(out,open('out_attitude_lecture.json','w'),indent=1)
