import sys; sys.path.insert(0,'.')
from olib import *
u=rng(33); Z=Rec('attitude',18); E=eye(3)
ax=lambda i:matrix([1 if j==i else 0 for j in range(3)])
def ex(wv):  # exponential of a skew matrix by the power series (independent of Rodrigues)
    S=hat(wv); T=E.copy(); P=E.copy()
    for k in range(1,90): P=P*S/k; T=T+P
    return T
R3=lambda x:matrix([[cos(x),-sin(x),0],[sin(x),cos(x),0],[0,0,1]])
R2=lambda x:matrix([[cos(x),0,sin(x)],[0,1,0],[-sin(x),0,cos(x)]])
R1=lambda x:matrix([[1,0,0],[0,cos(x),-sin(x)],[0,sin(x),cos(x)]])
x=u()
Z.put(1,mx(R3(x)-ex(x*ax(2)))); Z.put(2,mx(R2(x)-ex(x*ax(1)),R1(x)-ex(x*ax(0))))
co=[[u(.2,.8) for _ in range(3)] for _ in range(3)]
f=lambda i,t:co[i][0]+co[i][1]*t+co[i][2]*t*t
# truth: intrinsic 3-2-1, by turning the frame about its current axes: frame -> ex(angle*axis) frame
def tr(ps,th,ph):
    B=E.copy(); B=ex(ps*(B*ax(2)))*B; B=ex(th*(B*ax(1)))*B; B=ex(ph*(B*ax(0)))*B; return B   # columns = body axes in inertial components
Rt=lambda t:R3(f(0,t))*R2(f(1,t))*R1(f(2,t))
t=u(.1,.5); ps,th,ph=[f(i,t) for i in range(3)]; R=tr(ps,th,ph)
w_only=[mx(tr(ps,0,0)-R1(0)*R2(0)*R3(ps))]
Z.put(3,mx(R-R1(ph)*R2(th)*R3(ps)),mx(R-R3(ps)*R2(th)*R1(ph)),only_if=w_only)
c,s=cos,sin
Z.put(4,mx(R-matrix([[c(th)*c(ps),s(ph)*s(th)*c(ps)-c(ph)*s(ps),c(ph)*s(th)*c(ps)+s(ph)*s(ps)],[c(th)*s(ps),s(ph)*s(th)*s(ps)+c(ph)*c(ps),c(ph)*s(th)*s(ps)-s(ph)*c(ps)],[-s(th),s(ph)*c(th),c(ph)*c(th)]])))
Z.put(5,mx(tan(ph)-R[2,1]/R[2,2]))
Rd=d(Rt,t); wsp=vee(Rd*R.T); wb=R.T*wsp; p,q,r=wb
y=matrix([u(),u(),u()]); Z.put(6,mx(matrix([[0,-r,q],[r,0,-p],[-q,p,0]])*y-cross(wb,y)),remark='definition; equals the cross product')
Z.put(7,mx(Rd-R*hat(wb)))
pd,td,fd=[d(lambda s_,i=i:f(i,s_),t) for i in range(3)]  # psi',theta',phi'
e1=p-fd+pd*s(th); e2=q-td*c(ph)-pd*s(ph)*c(th); e3=r-td*s(ph)-pd*c(ph)*c(th); e3c=r+td*s(ph)-pd*c(ph)*c(th)
Z.put(8,mx(e1,e2,e3),mx(e1,e2,e3c),only_if=[mx(e3-e3c+2*td*s(ph))],remark='e3=-2 thetadot sin phi: %s; rows 1,2: %s'%(mp.nstr(e3+2*td*s(ph),3),mp.nstr(mx(e1,e2),3)))
Z.put(9,mx(fd-p-(q*s(ph)+r*c(ph))*tan(th),td-q*c(ph)+r*s(ph),pd-(q*s(ph)+r*c(ph))/c(th)))
n=matrix([u(),u(),u()]); n=n/sqrt(dot(n,n)); al=u(); Q=ex(al*n)
Z.put(10,mx(Q-c(al)*E-(1-c(al))*n*n.T-s(al)*hat(n)))
Z.put(11,mx(Q[0,0]+Q[1,1]+Q[2,2]-1-2*c(al)))
q0=c(al/2); qv=n*s(al/2)
Z.put(12,mx(q0**2+dot(qv,qv)-1),remark='definition; unit norm')
F=lambda k:(q0**2-dot(qv,qv))*E+2*qv*qv.T+k*q0*hat(qv)
qp=n # alpha=pi: q0=0
Z.put(13,mx(Q-F(-2)),mx(Q-F(2)),only_if=[mx(ex(pi*n)-(-E+2*n*n.T))])
# quaternion rates: take n(t), alpha(t); R(t) by exponential
an=[[u() for _ in range(3)] for _ in range(2)]
def nt(t): a=an[0][0]+an[0][1]*t; b=an[1][0]+an[1][1]*t*t; return matrix([c(a)*c(b),s(a)*c(b),s(b)])
alf=lambda t:u0+u1*t; u0,u1=u(),u()
Qt=lambda t:ex(alf(t)*nt(t)); Qd=d(Qt,t); QQ=Qt(t); wB=vee(QQ.T*Qd)
q0f=lambda t:c(alf(t)/2); qf=lambda t:nt(t)*s(alf(t)/2); a0=q0f(t); av=qf(t)
Z.put(14,mx(d(q0f,t)+dot(wB,av)/2))
wr=lambda W:d(qf,t)-(a0*W+cross(W,av))/2
# only if omega parallel to q (fixed axis)
q1=lambda t:n*s(alf(t)/2); W1=n*u1
Z.put(15,mx(wr(wB)),mx(d(qf,t)-(a0*wB+cross(av,wB))/2),only_if=[mx(d(q1,t)-(a0*W1+cross(W1,q1(t)))/2)],remark='with inertial components of omega the written form holds: %s'%mp.nstr(mx(wr(QQ*wB)),3))
# gravity gradient by differencing the field
mu,r0=u(),u(1.2,1.8)
ms=[u() for _ in range(5)]; sv=[matrix([u(-1,1) for _ in range(3)]) for _ in range(5)]; Mt=sum(ms)
cm=sum((ms[k]*sv[k] for k in range(1,5)),ms[0]*sv[0])/Mt; sv=[x-cm for x in sv]
e=matrix([u(),u(),u()]); e=e/sqrt(dot(e,e))
fld=lambda X:-mu*X/sqrt(dot(X,X))**3
def torque(e,ms,sv): # exact lowest order: derivative at zero size
    return sum((ms[k]*cross(sv[k],d(lambda ep,k=k:fld(r0*e+ep*sv[k]),mpf(0))) for k in range(1,len(ms))),ms[0]*cross(sv[0],d(lambda ep:fld(r0*e+ep*sv[0]),mpf(0))))
def inertia(ms,sv):
    I=matrix(3,3)
    for x,m in zip(sv,ms): I=I+m*(dot(x,x)*E-x*x.T)
    return I
J=inertia(ms,sv); N=torque(e,ms,sv)
Z.put(16,mx(N-3*mu/r0**5*cross(e,J*e)),mx(N-3*mu/r0**3*cross(e,J*e)))
# pitch: principal body = three pairs of masses on the axes
ms2=[]; sv2=[]
for i in range(3):
    m_,l_=u(),u()
    for sg in (1,-1): ms2.append(m_); sv2.append(sg*l_*ax(i))
Jp=inertia(ms2,sv2); n2=mu/r0**3
def Ny(th): # orbit frame z along the vertical, body turned by th about y
    B=R2(th); return torque(ax(2),ms2,[B*x for x in sv2])[1]
thd=Ny(th)/Jp[1,1]
Z.put(17,mx(Jp[1,1]*thd+mpf(3)/2*n2*(Jp[0,0]-Jp[2,2])*s(2*th)),general=mx(torque(ax(2),ms2,[R2(th)*R1(mpf('.4'))*x for x in sv2])[1]+mpf(3)/2*n2*(Jp[0,0]-Jp[2,2])*s(2*th)))
mp.dps=120
k=-d(Ny,mpf(0))/Jp[1,1]  # omega^2
Z.put(18,mx(k-3*n2*(Jp[0,0]-Jp[2,2])/(2*Jp[1,1])),mx(k-3*n2*(Jp[0,0]-Jp[2,2])/Jp[1,1]),remark='squares compared')
Z.save()
