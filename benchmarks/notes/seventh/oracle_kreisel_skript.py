from oracle_lib import *
O=Oracle('kreisel_skript.tex'); t=sp.symbols('t'); Q=sp.Rational
def Rz(a): return sp.Matrix([[sp.cos(a),-sp.sin(a),0],[sp.sin(a),sp.cos(a),0],[0,0,1]])
def Rx(a): return sp.Matrix([[1,0,0],[0,sp.cos(a),-sp.sin(a)],[0,sp.sin(a),sp.cos(a)]])
psi=Q(3,10)+Q(7,10)*t+Q(1,5)*t**2; th=Q(4,5)-Q(3,10)*t+Q(1,7)*t**2; ph=Q(1,9)+2*t-Q(1,3)*t**2
R=Rz(psi)*Rx(th)*Rz(ph)
def vee(S): return sp.Matrix([S[2,1],S[0,2],S[1,0]])
om=vee(R.diff(t)*R.T); omb=vee(R.T*R.diff(t)); X=lambda a,b:a.cross(b)
t0=Q(37,100); ev=lambda e: sp.Matrix(e.subs(t,t0).evalf(30)) if isinstance(e,sp.MatrixBase) else sp.N(sp.sympify(e).subs(t,t0),30)
rA=sp.Matrix([sp.sin(t)+t**2,t**3-t/2,sp.cos(2*t)]); x=sp.Matrix([Q(1,2),-Q(3,4),Q(2,3)])
d=lambda e:e.diff(t)
rP=rA+R*x; rAP=R*x
O.ok(1,ev(d(rP)-d(rA)-X(om,rAP)))
O.ok(2,ev(d(d(rP))-d(d(rA))-X(d(om),rAP)-X(om,X(om,rAP))))
cb=sp.Matrix([t**2,sp.sin(t),1-t]); c=R*cb
O.ok(3,ev(d(c)-R*d(cb)-X(om,c)))
rQ=rA+R*cb; base=d(d(rA))+X(d(om),c)+X(om,X(om,c))+R*d(d(cb)); w=X(om,R*d(cb))
O.wrong(4,ev(d(d(rQ))-base-w),ev(d(d(rQ))-base-2*w))
# body of point masses, A at body origin
ms=[Q(1),Q(2),Q(3,2),Q(5,4),Q(3,4)]; xs=[sp.Matrix(v) for v in ([1,0,Q(1,2)],[-Q(1,3),1,0],[Q(1,5),-Q(1,2),1],[0,Q(1,4),-1],[1,1,1])]
m=sum(ms); rs=[rA+R*v for v in xs]; vs=[d(r) for r in rs]; as_=[d(v) for v in vs]
Z=sp.zeros(3,1)
S=sum((mi*r for mi,r in zip(ms,rs)),Z)/m; vS=d(S); vA=d(rA)
O.ok(5,ev(sum((mi*v for mi,v in zip(ms,vs)),Z)-m*vS))
L=lambda P:sum((mi*X(r-P,v) for mi,r,v in zip(ms,rs,vs)),Z)
M=lambda P:sum((mi*X(r-P,a) for mi,r,a in zip(ms,rs,as_)),Z)
O.ok(6,ev(L(rA)-L(S)-m*X(S-rA,vS)))
O.wrong(7,ev(d(L(rA))-M(rA)-m*X(vA,vS)),ev(d(L(rA))-M(rA)+m*X(vA,vS)))
O.ok(8,ev(d(L(S))-M(S)))
Th=lambda P:sum((mi*((r-P).dot(r-P)*sp.eye(3)-(r-P)*(r-P).T) for mi,r in zip(ms,rs)),sp.zeros(3,3))
O.ok(9,ev(Th(S)*om-L(S)),'definition gives L=Theta omega')
s=S-rA
O.ok(10,ev(Th(rA)-Th(S)-m*(s.dot(s)*sp.eye(3)-s*s.T)))
O.ok(11,ev(sum(mi*v.dot(v) for mi,v in zip(ms,vs))/2-m*vS.dot(vS)/2-(om.T*Th(S)*om)[0]/2))
A,B,C=Q(2),Q(3),Q(7,2); D=sp.diag(A,B,C); Lb=D*omb; Mb=R.T*d(R*Lb); p,q,r=omb; dp,dq,dr=d(omb)
rows=lambda k:sp.Matrix([A*dp+(C-B)*q*r-Mb[0],B*dq+k*r*p-Mb[1],C*dr+(B-A)*p*q-Mb[2]])
O.wrong(12,ev(rows(C-A)),ev(rows(A-C)))
P,T_,F=d(psi),d(th),d(ph)
eul=lambda sg:sp.Matrix([P*sp.sin(th)*sp.sin(ph)+T_*sp.cos(ph)-p,P*sp.sin(th)*sp.cos(ph)+sg*T_*sp.sin(ph)-q,P*sp.cos(th)+F-r])
O.wrong(13,ev(eul(1)),ev(eul(-1)))
D2=sp.diag(A,A,C); T=(omb.T*D2*omb)[0]/2
O.ok(14,ev(T-A*(P**2*sp.sin(th)**2+T_**2)/2-C*(P*sp.cos(th)+F)**2/2))
O.ok(15,ev((R*sp.Matrix([0,0,1]))[2]-sp.cos(th)),'height of S / s')
Dz=(R*D2*omb)[2]; D3=C*r
O.wrong(16,ev(Dz-A*P*sp.sin(th)**2-C*(P*sp.cos(th)+F)),ev(Dz-A*P*sp.sin(th)**2-C*(P*sp.cos(th)+F)*sp.cos(th)))
O.ok(17,ev(P-(Dz-D3*sp.cos(th))/(A*sp.sin(th)**2)))
mgs=Q(13,10); E=T+mgs*sp.cos(th); rhs=E-D3**2/(2*C)
f=lambda k:A*T_**2/2+(Dz-D3*sp.cos(th))**2/(2*A*sp.sin(th)**k)+mgs*sp.cos(th)-rhs
O.wrong(18,ev(f(1)),ev(f(2)))
# Lagrange in theta
a,c_,g_,th_,P_,F_,r_=sp.symbols('a c g th P F r',positive=True)
Lg=a*P_**2*sp.sin(th_)**2/2+c_*(P_*sp.cos(th_)+F_)**2/2-g_*sp.cos(th_)
eq=(Lg.diff(th_)).subs(F_,r_-P_*sp.cos(th_))   # = A theta'' = 0
O.ok(19,sp.simplify(eq/sp.sin(th_)-(a*P_**2*sp.cos(th_)-c_*r_*P_+g_)))
k=sp.cos(th_); root=(c_*r_-sp.sqrt(c_**2*r_**2-4*a*k*g_))/(2*a*k)
lim=sp.limit(root.subs({a:2,c_:3,g_:Q(13,10),th_:sp.acos(Q(1,3))})*r_,r_,sp.oo)
O.wrong(20,lim-Q(13,10)/2,lim-Q(13,10)/3,'limit of r*psi_dot of slow root')
O.done()
