from oracle_lib import *
O=Oracle('quadcopter_from_scratch.md'); Q=sp.Rational; t=sp.symbols('t')
def Rz(a): return sp.Matrix([[sp.cos(a),-sp.sin(a),0],[sp.sin(a),sp.cos(a),0],[0,0,1]])
def Ry(a): return sp.Matrix([[sp.cos(a),0,sp.sin(a)],[0,1,0],[-sp.sin(a),0,sp.cos(a)]])
def Rx(a): return sp.Matrix([[1,0,0],[0,sp.cos(a),-sp.sin(a)],[0,sp.sin(a),sp.cos(a)]])
ps,th,ph=sp.symbols('psi theta phi',positive=True)
# 1: intrinsic rotations by Rodrigues about axes already turned
def rod(n,a): 
    K=sp.Matrix([[0,-n[2],n[1]],[n[2],0,-n[0]],[-n[1],n[0],0]]); return sp.eye(3)+sp.sin(a)*K+(1-sp.cos(a))*K*K
ez=sp.Matrix([0,0,1]); A1=rod(ez,ps); y1=A1*sp.Matrix([0,1,0]); A2=rod(y1,th)*A1; x2=A2*sp.Matrix([1,0,0]); R=rod(x2,ph)*A2
O.ok(1,R-Rz(ps)*Ry(th)*Rx(ph),'Rodrigues about the turned axes')
c,s=sp.cos,sp.sin
def M(sg): return sp.Matrix([[c(ps)*c(th),c(ps)*s(th)*s(ph)-s(ps)*c(ph),c(ps)*s(th)*c(ph)+s(ps)*s(ph)],[s(ps)*c(th),s(ps)*s(th)*s(ph)+c(ps)*c(ph),s(ps)*s(th)*c(ph)+sg*c(ps)*s(ph)],[-s(th),c(th)*s(ph),c(th)*c(ph)]])
O.wrong(2,R-M(1),R-M(-1))
R=Rz(ps)*Ry(th)*Rx(ph)
O.ok(3,[*(R.T*R-sp.eye(3)),R.det()-1])
pt,tt,ft=[sp.Function(q)(t) for q in('ps','th','ph')]; Rt=Rz(pt)*Ry(tt)*Rx(ft)
psd,thd,phd=sp.symbols('psd thd phd',positive=True)
sub=lambda e:e.subs([(pt.diff(t),psd),(tt.diff(t),thd),(ft.diff(t),phd),(pt,ps),(tt,th),(ft,ph)])
# angular velocity from geometry: sum of rates about their axes, in body comps
om=R.T*(psd*ez+thd*Rz(ps)*sp.Matrix([0,1,0])+phd*Rz(ps)*Ry(th)*sp.Matrix([1,0,0]))
cr=lambda w:sp.Matrix([[0,-w[2],w[1]],[w[2],0,-w[0]],[-w[1],w[0],0]])
O.ok(4,sub(Rt.diff(t))-R*cr(om))
p,q,r=om
O.ok(5,[p-(phd-psd*s(th)),q-(thd*c(ph)+psd*c(th)*s(ph)),r-(-thd*s(ph)+psd*c(th)*c(ph))])
f=lambda sg:[phd-(p+(q*s(ph)+r*c(ph))*sp.tan(th)),thd-(q*c(ph)+sg*r*s(ph)),psd-(q*s(ph)+r*c(ph))/c(th)]
O.wrong(6,f(1),f(-1))
# quaternion: build from Euler half angles, differentiate
def qm(a,b): return sp.Matrix([a[0]*b[0]-a[1]*b[1]-a[2]*b[2]-a[3]*b[3],a[0]*b[1]+a[1]*b[0]+a[2]*b[3]-a[3]*b[2],a[0]*b[2]-a[1]*b[3]+a[2]*b[0]+a[3]*b[1],a[0]*b[3]+a[1]*b[2]-a[2]*b[1]+a[3]*b[0]])
hq=lambda k,a:sp.Matrix([sp.cos(a/2)]+[sp.sin(a/2) if i==k else 0 for i in range(3)])
q_=qm(qm(hq(2,pt),hq(1,tt)),hq(0,ft)); qd=sub(q_.diff(t)); qs=sub(q_)
prod=qm(qs,sp.Matrix([0,*om])); O.wrong(7,qd-prod,qd-prod/2)
v=sp.Matrix(sp.symbols('v1:4')); rotv=qm(qm(qs,sp.Matrix([0,*v])),sp.Matrix([qs[0],-qs[1],-qs[2],-qs[3]])); O.ok(4,sp.Matrix(rotv[1:])-R*v,'Q is body to world')
kf,km,m,g,J1,J2,J3,Jr,l=sp.symbols('k_f k_m m g J_x J_y J_z J_r l',positive=True); Ws=sp.symbols('W1:5',positive=True); fs=sp.symbols('f1:5',positive=True); ka=km/kf
O.ok(8,[kf*w**2/ (kf*w**2)-1 for w in Ws],'quadratic law: definition of k_f, k_m')
F=sum(fs); O.ok(9,(sp.Matrix([0,0,-m*g])+R*sp.Matrix([0,0,F]))-(-m*g*ez+F*R*ez))
arms=[sp.Matrix([l,0,0]),sp.Matrix([0,l,0]),sp.Matrix([-l,0,0]),sp.Matrix([0,-l,0])]; spin=[1,-1,1,-1]
tau=sum((arms[i].cross(sp.Matrix([0,0,fs[i]]))-spin[i]*ka*fs[i]*ez for i in range(4)),sp.zeros(3,1))
T=lambda sg:tau-sp.Matrix([l*(fs[1]-fs[3]),sg*l*(fs[0]-fs[2]),ka*(-fs[0]+fs[1]-fs[2]+fs[3])])
O.wrong(10,T(1),T(-1))
O.ok(11,[sp.simplify(fs[1]-(F/4+tau[0]/(2*l)+tau[2]/(4*ka))),sp.simplify(fs[3]-(F/4-tau[0]/(2*l)+tau[2]/(4*ka)))])
# 12/13: Euler from d/dt(R J w)=R tau, with body motions as explicit numbers-functions
P,QQ,RR=[sp.Function(x)(t) for x in 'PQR']; w=sp.Matrix([P,QQ,RR]); J=sp.diag(J1,J2,J3); tx=sp.Matrix(sp.symbols('tx ty tz'))
# Rdot=R[w]x => R^T d/dt(R J w)= J wd + [w]x J w ; check using Euler-angle rotation explicitly at a time
A_=dict(zip((pt,tt,ft),(Q(3,10)*t+t**2/5,Q(2,5)*t-t**3/10,t**2/3+Q(1,2)*t)))
Rn=Rt.subs(A_); wn=(Rn.T*Rn.diff(t)); wn=sp.Matrix([wn[2,1],wn[0,2],wn[1,0]]); Jn=sp.diag(2,3,Q(9,2))
need=(Rn.T*(Rn*Jn*wn).diff(t)); t0=Q(6,5); ev=lambda X:sp.Matrix(X).subs(t,t0).evalf(30)
O.ok(12,ev(need-(Jn*wn.diff(t)+wn.cross(Jn*wn))),'tau = d(H)/dt, explicit motion')
wd=wn.diff(t); O.ok(13,ev([2*wd[0]-((3-Q(9,2))*wn[1]*wn[2]+need[0]),3*wd[1]-((Q(9,2)-2)*wn[2]*wn[0]+need[1]),Q(9,2)*wd[2]-((2-3)*wn[0]*wn[1]+need[2])]))
# 14: rotor momentum Jr*WS*e3 carried round by the frame: torque on rotors w x h, on frame the opposite
hr=sp.symbols('hr'); WS=Ws[0]-Ws[1]+Ws[2]-Ws[3]; pw=sp.Matrix(sp.symbols('p q r',positive=True))
rot=Rn*sp.Matrix([0,0,1]); ond=ev(-(Rn.T*rot.diff(t))+wn.cross(ez))
assert all(abs(x)<1e-20 for x in ond)
hrot=sum((spin[i]*Jr*Ws[i]*ez for i in range(4)),sp.zeros(3,1)); gy=-pw.cross(hrot)
O.wrong(14,[*(gy+Jr*WS*pw.cross(ez)),*(gy-Jr*WS*sp.Matrix([pw[1],-pw[0],0]))],[*(gy+Jr*WS*pw.cross(ez)),*(gy-Jr*WS*sp.Matrix([-pw[1],pw[0],0]))])
# 15
xd=sp.Matrix(sp.symbols('xd1:4')); xdd=(-m*g*ez+F*R*ez)/m; wdot=sp.Matrix([((J2-J3)*pw[1]*pw[2]+tx[0])/J1,((J3-J1)*pw[2]*pw[0]+tx[1])/J2,((J1-J2)*pw[0]*pw[1]+tx[2])/J3])
Ed=m*xd.dot(xdd)+sum([J1,J2,J3][i]*pw[i]*wdot[i] for i in range(3))+m*g*xd[2]
O.ok(15,sp.expand(Ed-(F*xd.dot(R*ez)+pw.dot(tx))))
W=sp.symbols('W',positive=True); O.ok(16,sp.solve(4*kf*W**2-m*g,W)[0]-sp.sqrt(m*g/kf)/2)
e=sp.symbols('e'); lin=(g*R*ez).subs({ps:0,th:e*th,ph:e*ph}); l1=lin.diff(e).subs(e,0)
O.ok(17,[l1[0]-g*th,l1[1]+g*ph,l1[2]])
# 18 linearize Euler + Euler rates
wde=wdot.subs({pw[0]:e*pw[0],pw[1]:e*pw[1],pw[2]:e*pw[2],tx[0]:e*tx[0],tx[1]:e*tx[1],tx[2]:e*tx[2]}).diff(e).subs(e,0)
O.ok(18,[J1*wde[0]-tx[0],J2*wde[1]-tx[1]],'with phidot=p, thetadot=q to first order')
kP,kD,fd=sp.symbols('k_P k_D fd',positive=True); O.ok(19,sp.expand((-kP*ph-kD*fd)/J1+kD/J1*fd+kP/J1*ph))
kc=[x for x in sp.solve(kD**2/J1**2-4*kP/J1,kD)][0]; O.wrong(20,kc-sp.sqrt(2*kP*J1),kc-2*sp.sqrt(kP*J1))
Fz=sp.symbols('Fz'); Rl=R.subs({ps:0,ph:0}); fz=sp.solve((-m*g*ez+Fz*Rl*ez)[2],Fz)[0]; ax=(fz*Rl*ez)[0]/m
O.wrong(21,[fz-m*g*c(th),ax-g*sp.tan(th)],[fz-m*g/c(th),ax-g*sp.tan(th)])
O.done()
