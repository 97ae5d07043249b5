from oracle_lib import *
O=Oracle('hw7.md'); Q=sp.Rational
M,m,L,d,v0,g,J,K,w,th,z,t=sp.symbols('M m L d v0 g J K w th z t',positive=True)
I=sp.integrate(M/L*z**2,(z,0,L))+m*d**2
O.ok(1,I-(M*L**2/3+m*d**2))
# impulsive Newton-Euler for rod and clay separately
Ic=M*L**2/12
sol=sp.solve([M*w*L/2-J-K, Ic*w-(K*(d-L/2)-J*L/2), m*(d*w-v0)+K],[w,J,K],dict=True)[0]
O.ok(2,m*v0*d-I*sol[w])
PE=sp.integrate(M/L*g*z*(1-sp.cos(th)),(z,0,L))+m*g*d*(1-sp.cos(th))
O.wrong(3,(M*g*L+m*g*d)*(1-sp.cos(th))-PE,(M*g*L/2+m*g*d)*(1-sp.cos(th))-PE)
O.ok(4,sol[J]-((M*L/2+m*d)*sol[w]-m*v0))
O.ok(5,[sol[J]-m*v0*((M*L/2+m*d)*d/(M*L**2/3+m*d**2)-1),sol[J]-M*m*v0*L*(d/2-L/3)/(M*L**2/3+m*d**2)])
O.ok(6,[x-2*L/3 for x in sp.solve(sol[J],d)])
# coupled pendula, exact Lagrangian expanded
l,a,k,D,e,p1,p2,u1,u2=sp.symbols('l a k D e p1 p2 u1 u2',positive=True)
dist=sp.sqrt((D+a*sp.sin(e*p2)-a*sp.sin(e*p1))**2+(a*sp.cos(e*p2)-a*sp.cos(e*p1))**2)
V=-m*g*l*(sp.cos(e*p1)+sp.cos(e*p2)-2)+k*(dist-D)**2/2
V2=sp.diff(V,e,2).subs(e,0)/2
O.zero(sp.diff(V,e).subs(e,0)) or exit('lin')
Lg=m*l**2*(u1**2+u2**2)/2-V2
O.ok(7,Lg-(m*l**2*(u1**2+u2**2)/2-m*g*l*(p1**2+p2**2)/2-k*a**2*(p2-p1)**2/2))
r1,r2=Lg.diff(p1),Lg.diff(p2)
w1=-m*g*l*p1+k*a**2*(p2-p1)
O.wrong(8,[r1-w1,r2-(-m*g*l*p2+k*a**2*(p2-p1))],[r1-w1,r2-(-m*g*l*p2-k*a**2*(p2-p1))])
Km=-sp.Matrix([[r1.diff(p1),r1.diff(p2)],[r2.diff(p1),r2.diff(p2)]])/(m*l**2)
sy=Km*sp.Matrix([1,1]); an=Km*sp.Matrix([1,-1])
O.ok(9,sy-g/l*sp.Matrix([1,1]))
O.wrong(10,an-(g/l+k*a**2/(m*l**2))*sp.Matrix([1,-1]),an-(g/l+2*k*a**2/(m*l**2))*sp.Matrix([1,-1]))
ws,wa,f0=sp.symbols('ws wa f0',positive=True); vals={ws:sp.sqrt(g/l),wa:sp.sqrt(g/l+2*k*a**2/(m*l**2))}
F1=f0*sp.cos((wa-ws)*t/2)*sp.cos((wa+ws)*t/2); F2=f0*sp.sin((wa-ws)*t/2)*sp.sin((wa+ws)*t/2); F2w=f0*sp.sin((wa-ws)*t/2)*sp.cos((wa+ws)*t/2)
def res(A,B):
    X=sp.Matrix([A,B]).subs(vals); r=X.diff(t,2)+Km*X
    ic=[X[0].subs(t,0)-f0,X[1].subs(t,0),X.diff(t)[0].subs(t,0),X.diff(t)[1].subs(t,0)]
    return list(r)+ic
O.ok(11,[res(F1,F2)[0],res(F1,F2)[2],res(F1,F2)[4]])
O.wrong(12,res(F1,F2w),res(F1,F2))
# bowling ball: friction -mu m g at bottom; torque about centre. x forward, z up, rolling omega about +y
mu,R=sp.symbols('mu R',positive=True)
Fv=sp.Matrix([-mu*m*g,0,0]); tau=sp.Matrix([0,0,-R]).cross(Fv)   # about +y : rolling forward
dv=Fv[0]/m; r_,c1,c2=sp.symbols('r_ c1 c2'); rho=m/(Q(4,3)*sp.pi*R**3)
Ib=sp.integrate(sp.integrate(rho*r_**4*sp.sin(c1)**3*2*sp.pi,(r_,0,R)),(c1,0,sp.pi))
dw=tau[1]/Ib
O.ok(13,m*dv+mu*m*g)
O.ok(14,Q(2,5)*m*R**2*dw-mu*m*g*R,'I=2/5 m R^2 by integration, rolling direction +y: contact v = v - w R')
v=v0+dv*t; om=dw*t
O.wrong(15,[v-(v0-mu*g*t),om-2*mu*g*t/(5*R)],[v-(v0-mu*g*t),om-5*mu*g*t/(2*R)])
tr=sp.solve(v-R*om,t)[0]
O.ok(16,tr-2*v0/(7*mu*g))
vf=v.subs(t,tr); O.ok(17,[vf-Q(5,7)*v0,vf-(v0-mu*g*tr)])
Qh=m*v0**2/2-m*vf**2/2-Ib*(vf/R)**2/2
# independent: work of friction on the slip distance
Qs=sp.integrate(mu*m*g*(v-R*om),(t,0,tr)); assert O.zero(Qs-Qh)
O.wrong(18,Qh-Q(2,7)*m*v0**2,Qh-Q(1,7)*m*v0**2)
# rocket: momentum balance to first order in h=dt with mass flow dM/dt = -b
b,h,vv,Mm,u,acc,M0=sp.symbols('b h vv Mm u acc M0',positive=True)
bal=((Mm-b*h)*(vv+acc*h)+b*h*(vv-u)-Mm*vv)/h+Mm*g
acc0=sp.solve(sp.limit(sp.expand(bal),h,0),acc)[0]
O.ok(19,Mm*acc0-(-u*(-b)-Mm*g))
Mt=M0-b*t
f=lambda x:[x.diff(t)-acc0.subs(Mm,Mt),x.subs(t,0)]
sub={M0:7,b:Q(3,2)}
O.wrong(20,[y.subs(sub) for y in f(u*sp.log(Mt/M0)-g*t)],[y.subs(sub) for y in f(u*sp.log(M0/Mt)-g*t)])
O.done()
