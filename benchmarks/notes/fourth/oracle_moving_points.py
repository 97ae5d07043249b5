"""Explicit model: 6 particles glued to a rotating, translating frame; 50 digits; P and S move on arbitrary curves."""
from mpmath import mp, mpf, matrix, sin, cos, sqrt, diff, eye, zeros
import json, random
mp.dps = 50
random.seed(11)
rnd = lambda: mpf(random.randint(-10**6, 10**6))/10**6
def vec(): return matrix([rnd() for _ in range(3)])
def cr(a,b): return matrix([a[1]*b[2]-a[2]*b[1], a[2]*b[0]-a[0]*b[2], a[0]*b[1]-a[1]*b[0]])
def dot(a,b): return (a.T*b)[0]
def d(f,t,n=1):
    k=len(f(t)); return matrix([diff(lambda s:f(s)[i], t, n) for i in range(k)])
m=[abs(rnd())+1 for _ in range(6)]; M=sum(m); q=[vec() for _ in range(6)]
qG=sum((m[i]*q[i] for i in range(6)), zeros(3,1))/M
qA,qB=vec(),vec()
k=[rnd() for _ in range(40)]
def R(t):      # body -> N
    a,b,c = k[0]+k[1]*t+sin(t*k[2]), k[3]*t+cos(k[4]*t), k[5]+t*t*k[6]+t*k[7]
    R1=matrix([[1,0,0],[0,cos(a),-sin(a)],[0,sin(a),cos(a)]]); R2=matrix([[cos(b),0,sin(b)],[0,1,0],[-sin(b),0,cos(b)]])
    R3=matrix([[cos(c),-sin(c),0],[sin(c),cos(c),0],[0,0,1]]); return R3*R2*R1
def XA(t): return matrix([sin(k[8]*t)+t*k[9], cos(k[10]*t+k[11]), t**2*k[12]+k[13]*t])
def X(qq): return lambda t: XA(t)+R(t)*(qq-qA)
def XP(t): return matrix([cos(k[14]*t)+t*k[15]+1, sin(k[16]*t)*2, t**3*k[17]+k[18]*t+1])
def sb(t): return matrix([k[19]+k[20]*t+sin(t), k[21]*t**2+k[22]*t, cos(k[23]*t)])       # slider from A, body comps
def XS(t): return XA(t)+R(t)*sb(t)
def unskew(S): return matrix([S[2,1]-S[1,2], S[0,2]-S[2,0], S[1,0]-S[0,1]])/2
def dR(t): return matrix(3,3) if 0 else matrix([[diff(lambda s:R(s)[i,j],t) for j in range(3)] for i in range(3)])
t0=mpf('0.37')
def om(t): return unskew(dR(t)*R(t).T)
w=om(t0); al=d(om,t0); Rt=R(t0)
pos=lambda f:f(t0); vel=lambda f:d(f,t0); acc=lambda f:d(f,t0,2)
xs=[X(qq) for qq in q]; x=[pos(f) for f in xs]; v=[vel(f) for f in xs]; a=[acc(f) for f in xs]
XG,XB=X(qG),X(qB)
rG,vG,aG=pos(XG),vel(XG),acc(XG); rA,vA,aA=pos(XA),vel(XA),acc(XA); rB,vB,aB=pos(XB),vel(XB),acc(XB); rP,vP,aP=pos(XP),vel(XP),acc(XP)
rS,vS,aS=pos(XS),vel(XS),acc(XS)
F=sum((m[i]*a[i] for i in range(6)),zeros(3,1))
def Mom(r0): return sum((m[i]*cr(x[i]-r0,a[i]) for i in range(6)),zeros(3,1))   # internal forces: none net
def J(r0):
    S=zeros(3,3)
    for i in range(6):
        r=x[i]-r0; S+=m[i]*(dot(r,r)*eye(3)-r*r.T)
    return S
def hfun(Pf,rel):
    def h(t):
        s=zeros(3,1)
        vp=d(Pf,t)
        for i in range(6):
            s+=m[i]*cr(xs[i](t)-Pf(t), d(xs[i],t)-(vp if rel else 0*vp))
        return s
    return h
def par(r): return M*(dot(r,r)*eye(3)-r*r.T)
hP=hfun(XP,0)(t0); hPr=hfun(XP,1)(t0); hG=hfun(XG,0)(t0); hA=hfun(XA,0)(t0)
mp.dps=50
dhP=d(hfun(XP,0),t0); dhPr=d(hfun(XP,1),t0)
u=lambda t: matrix([sin(t)*k[24],t**2+k[25],cos(k[26]*t)])       # arbitrary, N comps
ub=lambda t: R(t).T*u(t)
uring=Rt*d(ub,t0)
wring=Rt*d(lambda t:R(t).T*om(t),t0)
sring=Rt*d(sb,t0); sring2=Rt*d(sb,t0,2)
rBA=rB-rA; rSA=rS-rA; rGA=rG-rA; rGB=rG-rB; rGP=rG-rP
JG,JA,JB=J(rG),J(rA),J(rB); MG,MA,MB=Mom(rG),Mom(rA),Mom(rB)
T=sum(m[i]*dot(v[i],v[i]) for i in range(6))/2
Td=sum(m[i]*dot(v[i],a[i]) for i in range(6))
n=lambda z: abs(z) if not hasattr(z,'rows') else max(abs(e) for e in z)
res={}   # index: (residual as written, residual of correction or None)
res[1]=(n(d(u,t0)-uring-cr(w,u(t0))),None)
res[2]=(n(al-wring),None)
res[3]=(n(vB-vA-cr(w,rBA)),None)
res[4]=(n(aB-aA-cr(al,rBA)-cr(w,cr(rBA,w))), n(aB-aA-cr(al,rBA)-cr(w,cr(w,rBA))))
res[5]=(n(vS-vA-sring-cr(w,rSA)),None)
b6=aA+sring2+cr(al,rSA)+cr(w,cr(w,rSA))
res[6]=(n(aS-b6-cr(w,sring)), n(aS-b6-2*cr(w,sring)))
res[7]=('definition',None); res[8]=('definition',None)
res[9]=(n(hP-hPr-M*cr(rGP,vP)),None)
res[10]=(n(hP-hG-M*cr(rGP,vG)),None)
MP=Mom(rP)
res[11]=(n(dhP-MP-M*cr(vP,vG)), n(dhP-MP+M*cr(vP,vG)))
res[12]=(n(dhPr-MP+M*cr(rGP,aP)),None)
res[13]=(n(hA-JA*w-M*cr(rGA,vG)), n(hA-JA*w-M*cr(rGA,vA)))
res[14]=(n(JB-JA-par(rBA)), n(JB-JA-par(rGB)+par(rGA)))
res[15]=(n(JG*al+cr(w,JG*w)-MG),None)
res[16]=(n(JA*al+cr(w,JA*w)+M*cr(rGA,aA)-MA),None)
# 17: fixed B: rerun with B fixed: shift all accelerations so that B does not move (moment changes by M rGB x aB)
MBfix=sum((m[i]*cr(x[i]-rB,a[i]-aB) for i in range(6)),zeros(3,1))
res[17]=('general (no bolt): %s'%mp.nstr(n(JB*al+cr(w,JB*w)-MB),5), n(JB*al+cr(w,JB*w)-MBfix))
res[18]=(n(T-M*dot(vG,vG)/2-dot(w,JA*w)/2), n(T-M*dot(vG,vG)/2-dot(w,JG*w)/2))
res[19]=(n(Td-dot(F,vG)-dot(MG,w)),None)
res[20]=(n(Td-dot(F,vA)-dot(MG,w)), n(Td-dot(F,vA)-dot(MA,w)))
alt=n(JB*al*0 + Td-dot(F,vG)-dot(MG,w))
res['20alt (M_G, v_G)']=(None,alt)
res['18alt: vA + coupling']=(None,n(T-M*dot(vA,vA)/2-dot(w,JA*w)/2-M*dot(vA,cr(w,rGA))))
out={str(i):[mp.nstr(z,5) if isinstance(z,mpf) else z for z in r] for i,r in res.items()}
for i,r in out.items(): print(i,r)
json.dump(out,open('out_moving_points.json','w'),indent=1)
