from oracle_lib import *
O=Oracle('sol05.tex'); Q=sp.Rational
m,a,ka,Om=sp.symbols('m a kappa Omega',positive=True); z=sp.Matrix([0,0,1])
r=sp.Matrix([*sp.symbols('rx ry'),0]); v=sp.Matrix([*sp.symbols('vx vy'),0]); w=sp.Matrix(sp.symbols('wx wy wz')); wd=sp.Matrix(sp.symbols('wdx wdy wdz')); vd=sp.Matrix([*sp.symbols('vdx vdy'),0]); F=sp.Matrix([*sp.symbols('Fx Fy'),0])
O.ok(1,(v+w.cross(-a*z)-(Om*z).cross(r))-((v-a*w.cross(z))-Om*z.cross(r)),'contact velocity = table velocity')
O.ok(2,(-a*z).cross(F)-(-a*z.cross(F)),'torque of friction at -a z')
t=sp.symbols('t'); fr=lambda s:sp.Matrix([sp.Function(s+c)(t) for c in 'xyz'])
rr=fr('r'); rr[2]=0; ww=fr('w'); con=rr.diff(t)-a*ww.cross(z)-Om*z.cross(rr)
O.ok(3,sp.simplify(con.diff(t)-(rr.diff(t,2)-a*ww.diff(t).cross(z)-Om*z.cross(rr.diff(t)))))
wdF=-z.cross(F)/(ka*m*a)
O.ok(4,[*(a*wdF.cross(z)+F/(ka*m)),*(F/(ka*m)-(F/m)/ka)])
sol=sp.solve([*(m*vd-F)[:2],*(vd-a*wdF.cross(z)-Om*z.cross(v))[:2]],[vd[0],vd[1],F[0],F[1]],dict=True)[0]
vs=sp.Matrix([sol[vd[0]],sol[vd[1]],0])
O.wrong(5,vs-Om/(1+ka)*z.cross(v),vs-ka*Om/(1+ka)*z.cross(v))
wc=Q(2,7)*Om
O.ok(6,vs.subs(ka,Q(2,5))-wc*z.cross(v))
# 7: integrate: r(t) for v'=wc z x v
c=sp.symbols('c',positive=True); rot=lambda A:sp.Matrix([[sp.cos(A),-sp.sin(A),0],[sp.sin(A),sp.cos(A),0],[0,0,1]])
rt=r+sp.Matrix([sp.integrate(y,(t,0,t)) for y in rot(c*t)*v])
def dd(rc): return [sp.simplify(((rt-rc).dot(rt-rc)).diff(t))]
O.wrong(7,dd(r-z.cross(v)/c),dd(r+z.cross(v)/c),'distance from centre constant')
# sleigh
xd,yd,th,u,om,l,I,N=sp.symbols('xd yd th u om l I N',positive=True)
e1=sp.Matrix([sp.cos(th),sp.sin(th)]); e2=sp.Matrix([-sp.sin(th),sp.cos(th)])
V=u*e1
O.wrong(8,V[0]*sp.cos(th)-V[1]*sp.sin(th),V[0]*sp.sin(th)-V[1]*sp.cos(th),'velocity u e1 must satisfy it')
vG=u*e1+l*om*e2
O.ok(9,m*vG.dot(vG)/2+I*om**2/2-(m*(u**2+l**2*om**2)/2+I*om**2/2))
# d'Alembert with multiplier, coordinates x,y,theta of knife
X,Y,TH=[sp.Function(s)(t) for s in 'XYT']; G=sp.Matrix([X+l*sp.cos(TH),Y+l*sp.sin(TH)]); L=m*G.diff(t).dot(G.diff(t))/2+I*TH.diff(t)**2/2
ud,omd=sp.symbols('ud omd')
eqs=[L.diff(q.diff(t)).diff(t)-L.diff(q) for q in (X,Y,TH)]
gen=[N*e2[0],N*e2[1],0]
acc=ud*e1+u*om*e2
sub=[(X.diff(t,2),acc[0]),(Y.diff(t,2),acc[1]),(TH.diff(t,2),omd),(X.diff(t),V[0]),(Y.diff(t),V[1]),(TH.diff(t),om),(TH,th)]
S=sp.solve([sp.simplify(q.subs(sub)-f) for q,f in zip(eqs,gen)],[ud,omd,N],dict=True)[0]
O.ok(10,sp.simplify(S[ud]-l*om**2)); O.ok(11,sp.simplify((I+m*l**2)*S[omd]+m*l*u*om))
O.wrong(12,[S[N]-m*(l*S[omd]+u*om),S[N]-m**2*l**2/(I+m*l**2)*u*om],[S[N]-m*(l*S[omd]+u*om),S[N]-m*I/(I+m*l**2)*u*om])
# raindrop
R,rw,rho,g,vv,h,ac=sp.symbols('R rw rho g vv h ac',positive=True); mm=Q(4,3)*sp.pi*rw*R**3; md=sp.pi*R**2*rho*vv
Rd=sp.solve(mm.diff(R)*sp.Symbol('x')-md,sp.Symbol('x'))[0]
O.ok(13,Rd-rho*vv/(4*rw))
bal=sp.limit(sp.expand(((mm+md*h)*(vv+ac*h)-mm*vv)/h-mm*g),h,0); av=sp.solve(bal,ac)[0]
O.wrong(14,mm*av-(mm*g+md*vv),mm*av-(mm*g-md*vv))
O.ok(15,2*vv*av/Rd+6/R*vv**2-8*rw*g/rho)
v2=8*rw*g*R/(7*rho)
O.ok(16,[v2.diff(R)+6/R*v2-8*rw*g/rho,v2.subs(R,0),av.subs(vv,sp.sqrt(v2))-g/7])
# the general solution: v2 + c/R^6 ; c=0 for start at R=0
# hoop from cartesian
th_=sp.Function('q')(t); Rr=sp.symbols('Rr',positive=True); P=sp.Matrix([Rr*sp.sin(th_)*sp.cos(Om*t),Rr*sp.sin(th_)*sp.sin(Om*t),-Rr*sp.cos(th_)])
L=m*P.diff(t).dot(P.diff(t))/2-m*g*P[2]; qd,q,qdd=sp.symbols('qd q qdd',positive=True)
f=lambda X:X.subs([(th_.diff(t,2),qdd),(th_.diff(t),qd),(th_,q)])
O.ok(17,sp.simplify(f(L))-(m*Rr**2*(qd**2+Om**2*sp.sin(q)**2)/2+m*g*Rr*sp.cos(q)))
rhs=sp.solve(f(sp.simplify(L.diff(th_.diff(t)).diff(t)-L.diff(th_))),qdd)[0]
O.ok(18,rhs-(Om**2*sp.cos(q)-g/Rr)*sp.sin(q))
num={g:Q(981,100),Rr:Q(1,2),Om:Q(6)}
q0=sp.acos(g/(Rr*Om**2)); O.ok(19,rhs.subs(q,q0).subs(num))
w2=-rhs.diff(q).subs(q,q0)
O.wrong(20,(w2-(Om*sp.cos(q0))**2).subs(num),(w2-(Om*sp.sin(q0))**2).subs(num))
O.done()
