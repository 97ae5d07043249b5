from oracle_lib import *
O=Oracle('memo_vd_0417.tex'); Q=sp.Rational
m,Jz,a,b,Cf,Cr,u,v,r,de,R,vd,rd,h,g,D,w=sp.symbols('m J_z a b C_f C_r u v r delta R vd rd h g D w',positive=True); L=a+b
t=sp.symbols('t')
# 1: acceleration of cg in a frame turning with r: position in inertial frame
ps,xf,yf=[sp.Function(q)(t) for q in('ps','xf','yf')]
V=sp.Matrix([u*sp.cos(ps)-xf*sp.sin(ps),u*sp.sin(ps)+xf*sp.cos(ps)])   # xf(t): lateral velocity
ay=sp.simplify((V.diff(t)).dot(sp.Matrix([-sp.sin(ps),sp.cos(ps)])))
ay=ay.subs([(xf.diff(t),vd),(ps.diff(t),r),(xf,v)])
Ff,Fr=sp.symbols('F_f F_r')
O.ok(1,ay-(vd+u*r),'lateral acceleration')
tz=(sp.Matrix([a,0,0]).cross(sp.Matrix([0,Ff,0]))+sp.Matrix([-b,0,0]).cross(sp.Matrix([0,Fr,0])))[2]
O.ok(2,tz-(a*Ff-b*Fr))
# 3 law; positive slip angle gives positive force: check sign with 4 (front steered left, going straight => force left)
vel=lambda x:sp.Matrix([u,v,0])+sp.Matrix([0,0,r]).cross(sp.Matrix([x,0,0]))
sl=lambda st,x:st-vel(x)[1]/vel(x)[0]
af,ar=sl(de,a),sl(0,-b)
O.ok(3,[(Cf*af).diff(de)-Cf],'linear law, sign: left steer gives left force')
O.wrong(4,[af-(de-(v+a*r)/u),ar+(v+b*r)/u],[af-(de-(v+a*r)/u),ar+(v-b*r)/u])
FF,FR=Cf*af,Cr*ar
O.ok(5,sp.expand(FF+FR-m*u*r-(-(Cf+Cr)/u*v-(m*u+(a*Cf-b*Cr)/u)*r+Cf*de)))
mom=a*FF-b*FR; f6=lambda s:sp.expand(mom-(-(a*Cf+s*b*Cr)/u*v-(a**2*Cf+b**2*Cr)/u*r+a*Cf*de))
O.wrong(6,f6(1),f6(-1))
S=sp.solve([(FF+FR-m*u*r).subs(r,u/R),mom.subs(r,u/R)],[v,de],dict=True)[0]
K=m/L*(b/Cf-a/Cr); K2=m/L*(a/Cf-b/Cr); k=sp.symbols('k')
Ks=sp.simplify(((S[de]-L/R)*R/u**2)); 
O.ok(7,[sp.simplify(Ks.diff(u)),sp.simplify(Ks.diff(R))],'delta-L/R proportional to u^2/R')
O.wrong(8,Ks-K2,Ks-K)
O.ok(9,sp.simplify((u/R)/S[de]-u/(L+K*u**2)))
gain=u/(L+k*u**2); O.ok(10,sp.simplify(gain.diff(u).subs(u,sp.sqrt(L/k))))
# 11 determinant of the (corrected) state matrix
A=sp.Matrix([[-(Cf+Cr)/u/m,-(u+(a*Cf-b*Cr)/u/m)],[-(a*Cf-b*Cr)/u/Jz,-(a**2*Cf+b**2*Cr)/u/Jz]])
det=sp.simplify(A.det()); num={a:Q(17,10),b:Q(13,10),Cf:90000,Cr:50000,m:2000,Jz:3000}
uc=sp.sqrt(-L/K); O.ok(11,[det.subs(num).subs(u,uc.subs(num)),0 if K.subs(num)<0 and det.subs(num).subs(u,uc.subs(num)*Q(9,10))>0 and det.subs(num).subs(u,uc.subs(num)*Q(11,10))<0 else 1],'det changes sign, trace<0')
O.ok(12,sp.simplify(S[v]/u-(b/R-m*a*u**2/(L*Cr*R))))
# B
Nf,Nr,Bf,Br,hh=sp.symbols('N_f N_r B_f B_r hh')
# moments about cg: forces: N up at front x=a, N at x=-b, brake forces backward at z=-h
mo=sp.Matrix([a,0,-h]).cross(sp.Matrix([-Bf,0,Nf]))+sp.Matrix([-b,0,-h]).cross(sp.Matrix([-Br,0,Nr]))
sn=sp.solve([mo[1],Nf+Nr-m*g,Bf+Br-m*D],[Nf,Nr,Br],dict=True)[0]
O.ok(13,[sp.simplify(sn[Nf]-m*(g*b+D*h)/L),sp.simplify(sn[Nr]-m*(g*a-D*h)/L)])
O.ok(14,sp.simplify(sn[Nf]/sn[Nr]-(g*b+D*h)/(g*a-D*h)))
dl=sp.solve(sn[Nr],D)[0]; O.wrong(15,dl-g*b/h,dl-g*a/h)
Ay,No,Ni,Sy=sp.symbols('a_y N_o N_i S'); 
# turn left (a_y to the left, +y): outer wheels right at y=-w/2; side force total m a_y at ground
mo=sp.Matrix([0,-w/2,-h]).cross(sp.Matrix([0,m*Ay,No]))+sp.Matrix([0,w/2,-h]).cross(sp.Matrix([0,0,Ni]))
sn=sp.solve([mo[0],No+Ni-m*g],[No,Ni],dict=True)[0]
O.ok(16,[sp.simplify(sn[No]-m*g/2-m*Ay*h/w),sp.simplify(m*g/2-sn[Ni]-m*Ay*h/w)])
at=sp.solve(sn[Ni],Ay)[0]; O.wrong(17,at-g*w/h,at-g*w/(2*h))
# C by Lagrange with dissipation
ms,mu,ks,kt,cs=sp.symbols('m_s m_u k_s k_t c_s',positive=True); zs,zu,z0,zsd,zud=sp.symbols('z_s z_u z_0 zsd zud')
U=ks*(zs-zu)**2/2+kt*(zu-z0)**2/2; Ra=cs*(zsd-zud)**2/2
fs,fu=-U.diff(zs)-Ra.diff(zsd),-U.diff(zu)-Ra.diff(zud)
O.ok(18,sp.expand(fs-(-ks*(zs-zu)-cs*(zsd-zud))))
f=lambda s:sp.expand(fu-(ks*(zs-zu)+s*cs*(zsd-zud)-kt*(zu-z0)))
O.wrong(19,f(-1),f(1))
x=sp.symbols('x')
stat=sp.solve((fu).subs({zsd:0,zud:0,z0:0}),zu)[0]   # massless wheel
wb2=-(fs.subs({zsd:0,zud:0}).subs(zu,stat)).diff(zs)/ms
O.ok(20,sp.simplify(wb2-ks*kt/((ks+kt)*ms)))
O.ok(21,-fu.subs({zsd:0,zud:0,zs:0,z0:0}).diff(zu)/mu-(ks+kt)/mu)
# 22 rigid tyre, flat road: ms x'' + cs x' + ks x = 0 ; critical damping by zero discriminant
s=sp.symbols('s'); ccrit=sp.solve(cs**2-4*ms*ks,cs)[0]
O.wrong(22,cs/ccrit-cs/sp.sqrt(ks*ms),cs/ccrit-cs/(2*sp.sqrt(ks*ms)))
O.done()
