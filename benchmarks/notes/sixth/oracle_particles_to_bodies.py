from o6 import *
import sympy as sp
u=rng(605); R_=Rec('particles_to_bodies',20)
N=5; m=[u() for _ in range(N)]; M=sum(m)
cf=[[[u(-1,1) for _ in range(4)] for _ in range(3)] for _ in range(N+1)]
x=lambda i,t:V(*[pol(c,t) for c in cf[i]])
XX=lambda t:S([m[i]*x(i,t) for i in range(N)])/M
y=lambda i,t:x(i,t)-XX(t)
t0=mpf('.6'); xd=[D(lambda t,i=i:x(i,t),t0) for i in range(N)]; yd=[D(lambda t,i=i:y(i,t),t0) for i in range(N)]; Xd=D(XX,t0)
dd=lambda f,t:D(lambda s:D(f,s),t); a=[dd(lambda t,i=i:x(i,t),t0) for i in range(N)]; Xdd=dd(XX,t0)
Y=[y(i,t0) for i in range(N)]; P=[x(i,t0) for i in range(N)]
R_.put(1,mx(M*XX(t0)-S([m[i]*P[i] for i in range(N)])),remark='definition')
R_.put(2,mx(S([m[i]*Y[i] for i in range(N)])))
# central pair forces k_ij (x_i-x_j); external forces = m a - internal
k=[[u() for _ in range(N)] for _ in range(N)]
fi=lambda i,sym:S([(k[min(i,j)][max(i,j)] if sym else k[i][j])*(P[i]-P[j]) for j in range(N) if j!=i])
F=[m[i]*a[i]-fi(i,True) for i in range(N)]; Fn=[m[i]*a[i]-fi(i,False) for i in range(N)]
R_.put(3,mx(M*Xdd-S(F)),general=mx(M*Xdd-S(Fn)))
# two particles
m1,m2=m[0],m[1]; C2=lambda t:(m1*x(0,t)+m2*x(1,t))/(m1+m2); r=P[0]-P[1]; y1=P[0]-C2(t0)
Ce=(P[0]+P[1])/2
R_.put(4,mx(y1-m1/(m1+m2)*r),mx(y1-m2/(m1+m2)*r),only_if=[mx(P[0]-Ce-r/2)])
v1=D(lambda t:x(0,t)-C2(t),t0); v2=D(lambda t:x(1,t)-C2(t),t0); rd=xd[0]-xd[1]
R_.put(5,m1*dot(v1,v1)/2+m2*dot(v2,v2)/2-m1*m2/(m1+m2)*dot(rd,rd)/2)
LO=S([m[i]*X(P[i],xd[i]) for i in range(N)]); sp_=S([m[i]*X(Y[i],yd[i]) for i in range(N)])
R_.put(6,mx(LO-M*X(XX(t0),Xd)-sp_))
R_.put(7,mx(sp_-S([m[i]*X(Y[i],xd[i]) for i in range(N)])))
xq=lambda t:x(N,t); LQ=lambda t,xq:S([m[i]*X(x(i,t)-xq(t),D(lambda s:x(i,s),t)) for i in range(N)])
def q(sg,xq):
    xqd=D(xq,t0); return mx(D(lambda t:LQ(t,xq),t0)-S([X(P[i]-xq(t0),F[i]) for i in range(N)])-sg*M*X(xqd,Xd))
R_.put(8,q(1,xq),q(-1,xq),only_if=[q(1,lambda t:V(1,2,3)),q(1,XX)])
# rigid body
ang=[[u() for _ in range(4)] for _ in range(3)]
R=lambda t:Rz(pol(ang[0],t))*Ry(pol(ang[1],t))*Rx(pol(ang[2],t))
b=[Y[i] for i in range(N)]       # body vectors, sum m b = 0
w=vee(D(R,t0)*R(t0).T); Z=[R(t0)*v for v in b]; Zd=[D(lambda t,v=v:R(t)*v,t0) for v in b]
I=inertia(Z,m); spin=S([m[i]*X(Z[i],Zd[i]) for i in range(N)])
Ih=matrix(3,3)
for i in range(N): Ih=Ih+m[i]*(dot(Z[i],Z[i])*eye(3)-Z[i]*Z[i].T)
R_.put(9,mx(spin-Ih*w),remark='definition; spin = I omega with it')
c=lambda t:V(*[pol(v,t) for v in cf[N]]); cd=D(c,t0)
T=sum(m[i]*dot(cd+Zd[i],cd+Zd[i]) for i in range(N))/2
R_.put(10,T-M*dot(cd,cd)/2-dot(w,I*w)/2)
# 11: axis through S with moment I about it: principal axis / arbitrary axis
from mpmath import eigsy
ev,Qm=eigsy(I); n=V(Qm[0,1],Qm[1,1],Qm[2,1]); al=u()
def fa(n): 
    n=n/nm(n); In=sum(m[i]*dot(X(n,Z[i]),X(n,Z[i])) for i in range(N)); Ls=S([m[i]*X(Z[i],X(al*n,Z[i])) for i in range(N)]); return mx(Ls-In*al*n),dot(Ls,n)-In*al
R_.put(11,fa(n)[0],general=fa(V(1,2,-1))[0],remark='component along any axis: %s'%mp.nstr(abs(fa(V(1,2,-1))[1]),3))
# parallel axes: direction n, points A,B relative to S
n=V(u(),u(),u()); n=n/nm(n)
def Iax(p): return sum(m[i]*dot(X(n,Z[i]-p),X(n,Z[i]-p)) for i in range(N))
A=V(u(),u(),u()); B=V(u(),-u(),2*u()); dist=lambda p:nm(X(n,p)); z=V(0,0,0)
R_.put(12,Iax(A)-Iax(z)-M*dist(A)**2)
e1=X(n,V(1,0,0)); e1=e1/nm(e1); e2=X(n,e1); A2=dist(B)*e2    # same distance as B
R_.put(13,Iax(B)-Iax(A)-M*(dist(B)-dist(A))**2,Iax(B)-Iax(A)-M*(dist(B)**2-dist(A)**2),only_if=[Iax(B)-Iax(z)-M*(dist(B)-dist(z))**2,Iax(B)-Iax(A2)-M*(dist(B)-dist(A2))**2],others=[Iax(B)-(Iax(z)+M*dist(B)**2)],remark='for B on the line S-A on the same side, I_A+M*AB^2: %s'%mp.nstr(abs(Iax(2*A)-Iax(A)-M*dist(A)**2),3))
l,Ms,h,rr=[sp.Rational(k,7) for k in (9,5,11,4)]; s,ph,zz,ro=sp.symbols('s phi z rho')
rod=lambda p:sp.integrate((s-p)**2,(s,-l/2,l/2))*Ms/l
n_=lambda v:abs(mpf(sp.Rational(v).p)/sp.Rational(v).q)
R_.put(14,max(n_(rod(l/4)-sp.Rational(7,48)*Ms*l**2),n_(sp.Rational(1,12)+sp.Rational(1,16)-sp.Rational(7,48))))
def cone(z0):
    dens=Ms/(sp.pi*rr**2*h/3); f=((ro*sp.sin(ph))**2+(zz-z0)**2)*ro
    return sp.simplify(sp.integrate(sp.integrate(sp.integrate(sp.expand(f),(ro,0,rr*zz/h)),(ph,0,2*sp.pi)),(zz,0,h))*dens)
R_.put(15,n_(cone(0)-sp.Rational(3,20)*Ms*rr**2-sp.Rational(3,5)*Ms*h**2))
R_.put(16,n_(cone(3*h/4)-sp.Rational(3,20)*Ms*rr**2-sp.Rational(43,80)*Ms*h**2),n_(cone(3*h/4)-sp.Rational(3,20)*Ms*rr**2-sp.Rational(3,80)*Ms*h**2))
# Euler, about the c.m., body components
Ib=inertia(b,m); wb=lambda t:vee(R(t).T*D(R,t)); Lsp=lambda t:S([m[i]*X(R(t)*b[i],D(lambda q:R(q)*b[i],t)) for i in range(N)])
Nb=R(t0).T*D(Lsp,t0); W=wb(t0); Wd=D(wb,t0)
pr=V(Qm[0,0],Qm[1,0],Qm[2,0]); wp=R(t0).T*pr*al; 
R_.put(17,mx(Ib*Wd+X(Ib*W,W)-Nb),mx(Ib*Wd+X(W,Ib*W)-Nb),only_if=[mx(X(Ib*wp,wp))])
R_.put(18,D(lambda t:dot(wb(t),Ib*wb(t))/2,t0)-dot(Nb,W))
# blow on a rod: impulse p at c, rigid continuous rod: momentum and angular momentum about the middle
lf,Mf,p,cc=[u() for _ in range(4)]; Im=quad(lambda s:s**2*Mf/lf,[-lf/2,lf/2]); om=p*cc/Im
R_.put(19,om-3*p*cc/(Mf*lf**2),om-12*p*cc/(Mf*lf**2))
T=quad(lambda s:(p/Mf+om*s)**2*Mf/lf/2,[-lf/2,lf/2]); R_.put(20,T-p**2/(2*Mf)*(1+12*cc**2/lf**2))
R_.save()
