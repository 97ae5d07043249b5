from o6 import *
u=rng(604); R_=Rec('heavy_top',18)
# particle top with fixed point O at the origin, figure axis = body 3
bp=[];bm=[]
for z,rad,mm in ((mpf('.5'),mpf('.6'),mpf('.3')),(mpf('1.1'),mpf('.8'),mpf('.2'))):
    for k in range(4): bp.append(V(rad*cos(k*pi/2+mpf('.3')),rad*sin(k*pi/2+mpf('.3')),z)); bm.append(mm)
bp.append(V(0,0,mpf('.9'))); bm.append(mpf('.5'))
I=inertia(bp,bm); T1,T3=I[0,0],I[2,2]; m=sum(bm); s=sum(bm[i]*bp[i][2] for i in range(9))/m; g=u(8,10)
assert mx(I-matrix([[T1,0,0],[0,T1,0],[0,0,T3]]))<mpf(10)**-100
R=lambda q:Rz(q[0])*Rx(q[1])*Rz(q[2])       # q=(phi,theta,psi)
cs=[[u() for _ in range(4)] for _ in range(3)]
Q=lambda t:[pol(c,t) for c in cs]
t0=mpf('-.2'); q=Q(t0); qd=[D(lambda t,i=i:Q(t)[i],t0) for i in range(3)]
ph,th,ps=q; pd,td,sd=qd
wbody=lambda t:vee(R(Q(t)).T*D(lambda x:R(Q(x)),t)); w=wbody(t0)
R_.put(1,mx(w[0]-(pd*sin(th)*sin(ps)+td*cos(ps)),w[1]-(pd*sin(th)*cos(ps)-td*sin(ps)),w[2]-(pd*cos(th)+sd)))
def Tq(q,qd):           # kinetic energy by the particles
    f=lambda e:R([q[i]+e*qd[i] for i in range(3)]); Rd=D(f,mpf(0))
    return sum(bm[k]*dot(Rd*bp[k],Rd*bp[k]) for k in range(9))/2
def Vq(q):
    r=R(q); return sum(bm[k]*g*(r*bp[k])[2] for k in range(9))
Tw=lambda q,qd:T1/2*(qd[1]**2+qd[0]**2*sin(q[1])**2)+T3/2*(qd[2]+qd[0]*cos(q[1]))**2
R_.put(2,Tq(q,qd)-Tw(q,qd))
Lq=lambda q,qd:Tq(q,qd)-Vq(q)
R_.put(3,Lq(q,qd)-(Tq(q,qd)-m*g*s*cos(th)))
ch=lambda v,i,e:[v[k]+(e if k==i else 0) for k in range(3)]
pj=lambda i,q,qd:D(lambda e:Lq(q,ch(qd,i,e)),mpf(0))
pps=pj(2,q,qd); w3=w[2]
R_.put(4,mx(pps-T3*(sd+pd*cos(th)),pps-T3*w3))
pph=pj(0,q,qd)
q9=[ph,pi/2,ps]
R_.put(5,pph-(T1*pd*sin(th)+pps*cos(th)),pph-(T1*pd*sin(th)**2+pps*cos(th)),only_if=[pj(0,q9,qd)-T1*pd-pj(2,q9,qd)*cos(pi/2)])
R_.put(6,pd-(pph-pps*cos(th))/(T1*sin(th)**2))
x=(pph-pps*cos(th))/(T1*sin(th)**2)
qd0=[mpf(0),td,sd]
R_.put(7,sd-(pps/T3-x),sd-(pps/T3-cos(th)*x),only_if=[sd-(pj(2,q,qd0)/T3-(pj(0,q,qd0)-pj(2,q,qd0)*cos(th))/(T1*sin(th)**2))])
E=Tq(q,qd)+Vq(q)
R_.put(8,E-(T1/2*td**2+(pph-pps*cos(th))**2/(2*T1*sin(th)**2)+pps**2/(2*T3)+m*g*s*cos(th)))
uu,a,b,al,be=cos(th),pps/T1,pph/T1,2/T1*(E-pps**2/(2*T3)),2*m*g*s/T1
ud=D(lambda t:cos(Q(t)[1]),t0)
R_.put(9,0,remark='definition (used in 10)')
R_.put(10,ud**2-((1-uu**2)*(al-be*uu)-(b-a*uu)**2))
# 11 Lagrange's derivative for theta along an arbitrary trajectory
tdd=D(lambda t:D(lambda x:Q(x)[1],t),t0)
vel=lambda t:[D(lambda x,i=i:Q(x)[i],t) for i in range(3)]
EL=D(lambda t:pj(1,Q(t),vel(t)),t0,mpf(10)**-5)-D(lambda e:Lq(ch(q,1,e),qd),mpf(0))
eq=lambda sg:T1*tdd-(T1*pd**2*sin(th)*cos(th)-pps*pd*sin(th)+sg*m*g*s*sin(th))
R_.put(11,EL-eq(-1),EL-eq(1),remark='difference of the written equation and Lagrange derivative')
# 12 steady precession: choose phi-dot, the p_psi that makes dL/dtheta = 0 (particles); theta-dot=0
P=mpf('1.7')
def dLdth(sdv): return D(lambda e:Lq(ch(q,1,e),[P,mpf(0),sdv]),mpf(0))
f0,f1=dLdth(mpf(0)),dLdth(mpf(1)); sdv=-f0/(f1-f0); assert abs(dLdth(sdv))<mpf(10)**-70
pp=pj(2,q,[P,mpf(0),sdv])
R_.put(12,T1*cos(th)*P**2-pp*P+m*g*s,general=T1*cos(th)*pd**2-pps*pd+m*g*s)
# 13
pbig=pp*2
root=lambda sg,p:p/(2*T1*cos(th))*(1+sg*sqrt(mpc(1-4*T1*m*g*s*cos(th)/p**2)))
quadr=lambda y,p:T1*cos(th)*y**2-p*y+m*g*s
R_.put(13,max(abs(quadr(root(sg,p),p)) for sg in (1,-1) for p in (pp,pbig)))
# 14 fast top, ratio
W=mpf(10)**25
def slow(th,W):
    p=T3*W; A=T1*cos(th); return 2*m*g*s/(p*(1+sqrt(1-4*A*m*g*s/p**2)))
assert abs(T1*cos(th)*slow(th,W)**2-T3*W*slow(th,W)+m*g*s)<mpf(10)**-100
R_.put(14,slow(th,W)/(m*g*s*sin(th)/(T3*W))-1,slow(th,W)/(m*g*s/(T3*W))-1,general=slow(th,mpf(40))/(m*g*s/(T3*40))-1,only_if=[slow(pi/2,W)/(m*g*s*sin(pi/2)/(T3*W))-1],remark='ratio-1 for omega_3=1e25')
# 15 sleeping top: second derivative of the effective potential with p_phi=p_psi at theta->0
def U2(W):
    e=mpf(10)**-30; p=T3*W
    return ((p*(1-cos(e)))**2/(2*T1*sin(e)**2)+m*g*s*(cos(e)-1))/e**2
wc=findroot(U2,2*sqrt(m*g*s*T1)/T3*mpf('1.05'),tol=mpf(10)**-55); assert U2(wc*mpf('1.01'))>0>U2(wc*mpf('.99'))
R_.put(15,wc-2/T1*sqrt(m*g*s*T3),wc-2/T3*sqrt(m*g*s*T1))
# 16 vectors
L=lambda t:S([bm[k]*X(R(Q(t))*bp[k],D(lambda x:R(Q(x))*bp[k],t)) for k in range(9)])
e3=lambda t:R(Q(t))*V(0,0,1); ed=D(e3,t0); ez=V(0,0,1)
Lv=L(t0)
R_.put(16,mx(Lv-T1*X(ed,e3(t0))-T3*w3*e3(t0)),mx(Lv-T1*X(e3(t0),ed)-T3*w3*e3(t0)))
tq=S([bm[k]*X(R(q)*bp[k],V(0,0,-bm[k]*0-g)) for k in range(9)])
R_.put(17,mx(tq+m*g*s*X(e3(t0),ez)),remark='torque of the weights of the particles about O; Ldot = torque is the law')
R_.put(18,mx(dot(Lv,ed),dot(tq,e3(t0))),remark='L.e3dot = 0 and torque.e3 = 0')
R_.save()
