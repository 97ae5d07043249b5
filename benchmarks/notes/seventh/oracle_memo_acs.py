from oracle_lib import *
O=Oracle('memo_acs.tex'); Q=sp.Rational
t=sp.symbols('t'); Jx,Jy,Jz,n,h0,mu=sp.symbols('Jx Jy Jz n h0 mu',positive=True)
S=lambda v:sp.Matrix([[0,-v[2],v[1]],[v[2],0,-v[0]],[-v[1],v[0],0]])
def Rx(a): return sp.Matrix([[1,0,0],[0,sp.cos(a),-sp.sin(a)],[0,sp.sin(a),sp.cos(a)]])
def Ry(a): return sp.Matrix([[sp.cos(a),0,sp.sin(a)],[0,1,0],[-sp.sin(a),0,sp.cos(a)]])
def Rz(a): return sp.Matrix([[sp.cos(a),-sp.sin(a),0],[sp.sin(a),sp.cos(a),0],[0,0,1]])
vee=lambda A:sp.Matrix([A[2,1],A[0,2],A[1,0]])
# 1: bus + wheel (axis y) from particles: bus frame fixed instantaneously, wheel rim of 4 masses spinning at W about y at offset
w=sp.Matrix(sp.symbols('w1:4')); W=sp.symbols('W')
bus=[(Q(2),sp.Matrix([1,0,0])),(Q(2),sp.Matrix([-1,0,0])),(Q(1),sp.Matrix([0,2,1])),(Q(1),sp.Matrix([0,-2,-1]))]
rim=[(Q(1,2),Q(1,3)*sp.Matrix([a,0,b])) for a,b in((1,0),(0,1),(-1,0),(0,-1))]
Hp=sp.zeros(3,1); J=sp.zeros(3,3); hw=sp.zeros(3,1)
for ms,x in bus: Hp+=ms*x.cross(w.cross(x)); J+=ms*(x.dot(x)*sp.eye(3)-x*x.T)
for ms,x in rim:
    vr=sp.Matrix([0,W,0]).cross(x); Hp+=ms*x.cross(w.cross(x)+vr); hw+=ms*x.cross(vr); J+=ms*(x.dot(x)*sp.eye(3)-x*x.T)
O.ok(1,Hp-J*w-hw,'from particles')
R=Rz(t**2/3+t)*Rx(sp.sin(t))*Ry(2*t-t**3); om=vee(R.T*R.diff(t))
Jn=sp.diag(2,3,Q(7,2)); h=sp.Matrix([sp.sin(t),t**2,1-t]); H=Jn*om+h
T=R.T*(R*H).diff(t); t0=Q(3,10); ev=lambda e:sp.Matrix(e.subs(t,t0).evalf(30))
O.ok(2,ev(H.diff(t)+S(om)*H-T))
O.wrong(3,ev(Jn*om.diff(t)+S(om)*Jn*om-T+h.diff(t)),ev(Jn*om.diff(t)+S(om)*(Jn*om+h)-T+h.diff(t)))
b=sp.Matrix(sp.symbols('b1:4')); O.ok(4,S(w)*b-w.cross(b))
hd=h.diff(t); od=om.diff(t); a,B,c=2,3,Q(7,2)
r5=sp.Matrix([a*od[0]+(c-B)*om[1]*om[2]+om[1]*h[2]-om[2]*h[1]-T[0]+hd[0],B*od[1]+(a-c)*om[2]*om[0]+om[2]*h[0]-om[0]*h[2]-T[1]+hd[1],c*od[2]+(B-a)*om[0]*om[1]+om[0]*h[1]-om[1]*h[0]-T[2]+hd[2]])
O.ok(5,ev(r5))
# 6: exact kinematics, several rotation orders
e=sp.symbols('e'); f,th,ps=sp.Function('f')(t),sp.Function('th')(t),sp.Function('ps')(t)
F,TH,PS,Fd,THd,PSd,Fdd,THdd,PSdd=sp.symbols('F TH PS Fd THd PSd Fdd THdd PSdd')
fin=lambda X:X.subs([(f.diff(t,2),Fdd),(th.diff(t,2),THdd),(ps.diff(t,2),PSdd),(f.diff(t),Fd),(th.diff(t),THd),(ps.diff(t),PSd),(f,F),(th,TH),(ps,PS)])
lin=lambda X:sp.Matrix([sp.simplify(sp.series(y,e,0,2).removeO()) for y in X])
res6=[]
for R_ in (Rz(e*ps)*Ry(e*th)*Rx(e*f), Rx(e*f)*Ry(e*th)*Rz(e*ps), Ry(e*th)*Rx(e*f)*Rz(e*ps)):   # body->local
    wb=vee((R_.T*R_.diff(t)).doit())+R_.T*sp.Matrix([0,-n,0])
    wl=wb.subs(e,0)+e*wb.diff(e).subs(e,0)
    res6+=list((wl-sp.Matrix([e*(f.diff(t)-n*ps),e*th.diff(t)-n,e*(ps.diff(t)+n*f)])).applyfunc(lambda y:fin(y)))
    cb=R_.T*sp.Matrix([0,0,1]); cl=cb.subs(e,0)+e*cb.diff(e).subs(e,0)
O.ok(6,res6)
# 7: gravity gradient by summing Newtonian attraction of point masses; small parameter 1/R0
import mpmath as mp
mp.mp.dps=60
pts=[(2,(1,0,0)),(2,(-1,0,0)),(1,(0,2,1)),(1,(0,-2,-1)),(3,(.5,.5,0)),(3,(-.5,-.5,0))]
cv=sp.Matrix([Q(1,3),Q(2,3),Q(2,3)]); R0=mp.mpf(10)**12
Tn=sp.zeros(3,1); Jn2=sp.zeros(3,3)
for ms,x in pts:
    x=sp.Matrix([sp.nsimplify(y) for y in x]); Jn2+=ms*(x.dot(x)*sp.eye(3)-x*x.T)
    pos=-sp.Float(str(R0),60)*cv+x    # earth centre at +R0 c from CoM
    Tn+=x.cross(-ms*pos/sp.sqrt(pos.dot(pos))**3)   # mu=1
Tn*=sp.Float(str(R0),60)**3
O.ok(7,(1 if max(abs(y) for y in (Tn-3*cv.cross(Jn2*cv)).evalf(40))>1e-9 else 0),'n^2=mu/R^3')
cl=fin(cl)
O.wrong(8,cl-sp.Matrix([e*TH,e*F,1]),cl-sp.Matrix([-e*TH,e*F,1]))
Jd=sp.diag(Jx,Jy,Jz); tg=3*n**2*cl.cross(Jd*cl); tg=sp.Matrix([y.diff(e).subs(e,0) for y in tg.applyfunc(sp.expand)])
O.ok(9,tg-sp.Matrix([-3*n**2*(Jy-Jz)*F,-3*n**2*(Jx-Jz)*TH,0]))
# linearised full equations
dh,dhd=sp.symbols('dh dhd')
wv=sp.Matrix([e*(Fd-n*PS),e*THd-n,e*(PSd+n*F)]); wd=sp.Matrix([e*(Fdd-n*PSd),e*THdd,e*(PSdd+n*Fd)])
hv=sp.Matrix([0,-h0+e*dh,0]); hdv=sp.Matrix([0,e*dhd,0])
eq=Jd*wd+S(wv)*(Jd*wv+hv)+hdv; eq=sp.Matrix([sp.expand(y).diff(e).subs(e,0) for y in eq])-tg   # = T_d
O.ok(10,eq[1]-(Jy*THdd+3*n**2*(Jx-Jz)*TH+dhd))
wp2=sp.solve((eq[1].subs({dhd:0})).subs(THdd,-sp.Symbol('W2')*TH),sp.Symbol('W2'))[0]
O.wrong(11,wp2-n**2*3*(Jx-Jz)/Jz,wp2-n**2*3*(Jx-Jz)/Jy)
he=h0-n*(Jx-Jy+Jz)
ez=eq[2]-(Jz*PSdd+(n**2*(Jy-Jx)+n*h0)*PS-he*Fd)
O.wrong(12,[eq[0]-(Jx*Fdd+(3*n**2*(Jy-Jz)+n*h0)*F+he*PSd),ez],[eq[0]-(Jx*Fdd+(4*n**2*(Jy-Jz)+n*h0)*F+he*PSd),ez])
# 13: h0 -> infinity with the remaining coefficients kept to leading order
ld=lambda X:[sp.limit(X.coeff(v)/h0,h0,sp.oo) for v in (F,Fd,PS,PSd)]
X0,X2=sp.expand(eq[0]),sp.expand(eq[2])
O.ok(13,[x-y for x,y in zip(ld(X0)+ld(X2),[n,0,0,1,0,-1,n,0])]+[X0.coeff(Fdd)-Jx,X2.coeff(PSdd)-Jz,X0.coeff(PSdd),X2.coeff(Fdd)])
s=sp.symbols('s'); num={Jx:2,Jy:3,Jz:Q(5,2),n:Q(1,1000)}
char=sp.expand((Jx*s**2+n*h0)*(Jz*s**2+n*h0)+h0**2*s**2).subs(num)
rt=max(abs(complex(z)) for z in sp.Poly(char.subs(h0,Q(50)),s).nroots(n=30))
O.ok(14,0 if abs(rt/(50/float(sp.sqrt(5)))-1)<1e-3 else 1,'ratio fast root %.8f'%(rt/(50/float(sp.sqrt(5)))))
Tx,Tz=sp.symbols('Tx Tz',positive=True)
ss=sp.solve([n*h0*F-Tx,n*h0*PS-Tz],[F,PS]); O.ok(15,[ss[F]-Tx/(n*h0),ss[PS]-Tz/(n*h0)])
T0=sp.symbols('T0',positive=True); I=sp.integrate(T0*sp.sin(n*t),(t,0,sp.pi/n))
O.wrong(16,I-T0/n,I-2*T0/n)
# spin
Jt,Om,wt,g=sp.symbols('Jt Om wt g',positive=True); lam=(Jz-Jt)/Jt*Om
v=sp.Matrix([wt*sp.cos(lam*t),wt*sp.sin(lam*t),Om]); D=sp.diag(Jt,Jt,Jz)
r17=D*v.diff(t)+v.cross(D*v); O.ok(17,r17.subs({Jt:2,Jz:3,Om:Q(3,2),wt:Q(1,2),t:Q(7,10)}))
Hv=D*sp.Matrix([wt,0,Om]); O.ok(18,Hv[0]/Hv[2]-Jt*wt/(Jz*Om))
H2=Hv.dot(Hv); sin2=Hv[0]**2/H2; E=(Jt*wt**2+Jz*Om**2)/2
O.wrong(19,E-H2/(2*Jz)*(1+(Jt-Jz)/Jt*sin2),E-H2/(2*Jz)*(1+(Jz-Jt)/Jt*sin2))
Hs,gd=sp.symbols('Hs gd',positive=True)
Eg=(Hs*sp.sin(g))**2/(2*Jt)+(Hs*sp.cos(g))**2/(2*Jz)
O.ok(20,Eg.diff(g)*gd-Hs**2/Jz*(Jz-Jt)/Jt*sp.sin(g)*sp.cos(g)*gd)
O.done()
