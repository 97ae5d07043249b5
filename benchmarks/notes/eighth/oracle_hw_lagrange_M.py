from oracle_lib import *
O=Oracle('hw_lagrange_M.md'); Q=sp.Rational; t=sp.symbols('t')
M,m,g,al=sp.symbols('M m g alpha',positive=True); X,s=[sp.Function(q)(t) for q in 'Xs']
pos=sp.Matrix([X+s*sp.cos(al),-s*sp.sin(al)])
T=M*X.diff(t)**2/2+m*pos.diff(t).dot(pos.diff(t))/2; U=m*g*pos[1]
Xd,sd,Xdd,sdd=sp.symbols('Xd sd Xdd sdd',positive=True); X0,s0_=sp.symbols('X0 s0')
F=lambda e:sp.simplify(e).subs([(X.diff(t,2),Xdd),(s.diff(t,2),sdd),(X.diff(t),Xd),(s.diff(t),sd),(X,X0),(s,s0_)])
O.ok(1,F(T)-((M+m)*Xd**2/2+m*sd**2/2+m*Xd*sd*sp.cos(al))); O.ok(2,F(U)+m*g*s0_*sp.sin(al))
# 3-6 from Newton with the normal force N (independent of Lagrange)
N=sp.symbols('N'); n=sp.Matrix([sp.sin(al),sp.cos(al)])   # normal out of the slope
a=sp.Matrix([Xdd+sdd*sp.cos(al),-sdd*sp.sin(al)])
sol=sp.solve([*(m*a-N*n-sp.Matrix([0,-m*g])),M*Xdd+N*n[0]],[Xdd,sdd,N],dict=True)[0]
O.ok(3,[F(T).diff(Xd)-((M+m)*Xd+m*sd*sp.cos(al)),(M+m)*sol[Xdd]+m*sol[sdd]*sp.cos(al)])
O.ok(4,sol[sdd]+sol[Xdd]*sp.cos(al)-g*sp.sin(al))
O.ok(5,sol[sdd]-(M+m)*g*sp.sin(al)/(M+m*sp.sin(al)**2))
w=lambda d:sol[Xdd]+m*g*sp.sin(al)*sp.cos(al)/(M+m*d)
O.wrong(6,w(sp.cos(al)**2),w(sp.sin(al)**2))
# ladder: Newton-Euler with both normal forces
l=sp.symbols('l',positive=True); th=sp.Function('th')(t); td,tdd,th0,q=sp.symbols('td tdd th0 q',positive=True)
B=sp.Matrix([l*sp.cos(th),0]);Aw=sp.Matrix([0,l*sp.sin(th)]);c=(Aw+B)/2
G=lambda e:e.subs([(th.diff(t,2),tdd),(th.diff(t),td),(th,q)])
O.ok(7,G(c-sp.Matrix([l/2*sp.cos(th),l/2*sp.sin(th)])))
y=sp.symbols('y'); I=sp.integrate(m/l*y**2,(y,-l/2,l/2))
T=sp.simplify(G(m*c.diff(t).dot(c.diff(t))/2+I*th.diff(t)**2/2))
O.ok(8,[T-(m*l**2/4*td**2/2+m*l**2/12*td**2/2),T-m*l**2*td**2/6])
Nw,Nf=sp.symbols('Nw Nf'); cdd=G(c.diff(t,2)); rot=lambda r,f:r[0]*f[1]-r[1]*f[0]
# orientation angle of the ladder from floor end: direction (-cos, sin): turns clockwise as th grows => ang. velocity = -td
tor=rot(G(Aw-c),sp.Matrix([Nw,0]))+rot(G(B-c),sp.Matrix([0,Nf]))
S=sp.solve([m*cdd[0]-Nw,m*cdd[1]-Nf+m*g,-I*tdd-tor],[Nw,Nf,tdd],dict=True)[0]
td2=3*g/l*(sp.sin(th0)-sp.sin(q))
# 9: d/dt of the energy with the Newton acceleration
O.ok(9,[sp.simplify(m*l**2/6*2*S[tdd]+m*g*l/2*sp.cos(q)),(m*l**2*td2/6-m*g*l/2*(sp.sin(th0)-sp.sin(q)))],'energy rate 0 with Newton-Euler acceleration; value from rest at th0')
O.wrong(10,sp.simplify(S[tdd])+3*g/(2*l)*sp.sin(q),sp.simplify(S[tdd])+3*g/(2*l)*sp.cos(q))
O.ok(11,cdd[0]*m+m*l/2*(tdd*sp.sin(q)+td**2*sp.cos(q)))
nw=sp.simplify(S[Nw]).subs(td,sp.sqrt(td2))
O.wrong(12,nw-Q(3,4)*m*g*sp.cos(q)*(3*sp.sin(q)-sp.sin(th0)),nw-Q(3,4)*m*g*sp.cos(q)*(3*sp.sin(q)-2*sp.sin(th0)))
O.ok(13,sp.simplify(nw.subs(sp.sin(q),Q(2,3)*sp.sin(th0))))
# yo-yo: virtual work / energy for the acceleration
r,R,Iy,h,aa=sp.symbols('r R I h a',positive=True)
ay=sp.solve(sp.Eq((m+Iy/r**2)*aa,m*g),aa)[0]     # d/dt of (m+I/r^2)v^2/2 = m g v
Sy=m*g-m*ay
O.ok(14,[m*ay-(m*g-Sy),sp.simplify(Iy*ay/r-Sy*r)]); O.ok(15,sp.simplify(ay-g/(1+Iy/(m*r**2))))
O.wrong(16,Sy-m*r**2/(Iy+m*r**2)*m*g,Sy-Iy/(Iy+m*r**2)*m*g)
ph,rr=sp.symbols('ph rr',positive=True); Id=sp.integrate(sp.integrate(m/(sp.pi*R**2)*rr**3,(rr,0,R)),(ph,0,2*sp.pi))
ad=ay.subs(Iy,Id); O.ok(17,ad-2*r**2*g/(2*r**2+R**2))
vv=sp.sqrt(2*m*g*h/(m+Id/r**2))
O.wrong(18,[vv-sp.sqrt(2*ad*h),vv-r*sp.sqrt(2*g*h/(2*r**2+R**2))],[vv-sp.sqrt(2*ad*h),vv-2*r*sp.sqrt(g*h/(2*r**2+R**2))],'energy')
# cone
rf,pf=sp.Function('rf')(t),sp.Function('pf')(t); P=sp.Matrix([rf*sp.cos(pf),rf*sp.sin(pf),rf*sp.cos(al)/sp.sin(al)])
L=m*P.diff(t).dot(P.diff(t))/2-m*g*P[2]; rd,pd,rdd,pdd,Lam=sp.symbols('rd pd rdd pdd Lam',positive=True)
H=lambda e:e.subs([(rf.diff(t,2),rdd),(pf.diff(t,2),pdd),(rf.diff(t),rd),(pf.diff(t),pd),(rf,r),(pf,ph)])
O.ok(19,sp.simplify(H(L)-(m/2*(rd**2/sp.sin(al)**2+r**2*pd**2)-m*g*r*sp.cos(al)/sp.sin(al))))
# vertical angular momentum of the particle
Lz=m*(P[0]*P[1].diff(t)-P[1]*P[0].diff(t)); O.ok(20,[sp.simplify(H(Lz))-m*r**2*pd,sp.simplify(H(L.diff(pf.diff(t))))-m*r**2*pd])
# Newton along the generatrix
e=sp.Matrix([sp.sin(al)*sp.cos(pf),sp.sin(al)*sp.sin(pf),sp.cos(al)])
rhs=sp.solve(sp.simplify(H((P.diff(t,2)+sp.Matrix([0,0,g])).dot(e))),rdd)[0].subs(pd,Lam/(m*r**2))
rad=lambda k:m*rhs/sp.sin(al)**2-(Lam**2/(m*r**k)-m*g*sp.cos(al)/sp.sin(al))
O.wrong(21,rad(2),rad(3),'Newton along the generatrix')
p0=g*sp.cos(al)/sp.sin(al)/r; O.ok(22,rhs.subs(Lam,m*r**2*sp.sqrt(p0)))
om2=-rhs.diff(r).subs(Lam,m*r**2*sp.sqrt(p0))
O.wrong(23,om2-3*g*sp.cos(al)/r,om2-3*g*sp.sin(al)*sp.cos(al)/r)
O.ok(22,sp.sqrt(om2/p0)-sp.sqrt(3)*sp.sin(al),'text: ratio sqrt3 sin(alpha)')
O.done()
