from oracle_lib import *
O=Oracle('lecture09_earth.tex'); Q=sp.Rational; t=sp.symbols('t',positive=True)
# rotating frame: explicit rotation about a general direction (z), and general Omega(t) by a rotation matrix built from Euler angles
f=[sp.Function(s)(t) for s in('al','be')]
def Rz(a): return sp.Matrix([[sp.cos(a),-sp.sin(a),0],[sp.sin(a),sp.cos(a),0],[0,0,1]])
def Rx(a): return sp.Matrix([[1,0,0],[0,sp.cos(a),-sp.sin(a)],[0,sp.sin(a),sp.cos(a)]])
# concrete time functions so that everything is a number at the end
A_=Q(3,10)*t+Q(1,5)*t**2; B_=Q(7,10)*t-Q(1,10)*t**3
Rm=Rz(A_)*Rx(B_)                       # S' components -> S components
W=(Rm.T*Rm.diff(t)); Om=sp.Matrix([W[2,1],W[0,2],W[1,0]])   # in S' components
r=sp.Matrix([1+t**2,sp.sin(t),2*t-t**3]); v=r.diff(t); a=v.diff(t); Omd=Om.diff(t)
t0=Q(4,5); ev=lambda M:sp.Matrix(M).subs(t,t0).evalf(30)
back=lambda M:Rm.T*M
vS=back((Rm*r).diff(t)); aS=back((Rm*r).diff(t,2))
O.ok(1,ev(vS-(v+Om.cross(r))),'A=r, general rotation'); O.ok(2,ev(vS-(v+Om.cross(r))))
Y=Om.cross(r)+v; O.ok(1,ev(back((Rm*Y).diff(t))-(Y.diff(t)+Om.cross(Y))),'A=another vector')
cor=Om.cross(v); eul=Omd.cross(r); cf=Om.cross(Om.cross(r))
O.ok(3,ev(aS-(a+2*cor+eul+cf)))
m=Q(13,10); F=m*aS
O.wrong(4,ev(m*a-(F+2*m*cor-m*eul-m*cf)),ev(m*a-(F-2*m*cor-m*eul-m*cf)))
# Lagrangian: kinetic energy in S
O.ok(5,[(m*vS.dot(vS)/2-(m*v.dot(v)/2+m*v.dot(Om.cross(r))+m*Om.cross(r).dot(Om.cross(r))/2)).subs(t,t0).evalf(30)])
ms=sp.symbols('ms',positive=True); w1,w2,w3,x,y,z,vx,vy,vz=sp.symbols('w1 w2 w3 x y z vx vy vz',positive=True)
Ov=sp.Matrix([w1,w2,w3]);rv=sp.Matrix([x,y,z]);vv=sp.Matrix([vx,vy,vz])
L=ms*(vv+Ov.cross(rv)).dot(vv+Ov.cross(rv))/2-sp.Function('V')(x,y,z)
p=sp.Matrix([L.diff(q) for q in vv])
O.ok(6,(p-ms*(vv+Ov.cross(rv))).applyfunc(sp.expand))
V=sp.Symbol('Vv'); EJ=sp.expand(p.dot(vv)-L.subs(sp.Function('V')(x,y,z),V)); o2=Ov.cross(rv).dot(Ov.cross(rv))
O.wrong(7,EJ-(ms*vv.dot(vv)/2+ms*o2/2+V),EJ-(ms*vv.dot(vv)/2-ms*o2/2+V),'p.v-L')
# and constancy along a motion: free particle in S (V=0), Omega const
r0=sp.Matrix([1,2,Q(1,2)]);u0=sp.Matrix([Q(3,10),-1,Q(2,5)]); w=Q(7,10); rot=Rz(w*t); rp=rot.T*(r0+u0*t); vp=rp.diff(t); oo=sp.Matrix([0,0,w]).cross(rp)
d=lambda s:(vp.dot(vp)/2+s*oo.dot(oo)/2).diff(t).subs(t,t0).evalf(30)
O.wrong(7,d(1),d(-1),'constant for a free particle')
lam,Og,g,R,g0,h,v0=sp.symbols('lambda Omega g R g0 h v0',positive=True)
# geometry: Earth axis e3; place at latitude lam on the meridian plane xz: up=(cos,0,sin), north=(-sin,0,cos), east=(0,1,0)
up=sp.Matrix([sp.cos(lam),0,sp.sin(lam)]);no=sp.Matrix([-sp.sin(lam),0,sp.cos(lam)]);ea=sp.Matrix([0,1,0]); ax=sp.Matrix([0,0,Og])
O.ok(8,[ax.dot(ea),ax.dot(no)-Og*sp.cos(lam),ax.dot(up)-Og*sp.sin(lam),*(ea.cross(no)-up).applyfunc(sp.simplify)])
# 9: mass at rest: T/m balance: acceleration in S is toward axis
geff=-g0*up+Og**2*R*sp.cos(lam)*sp.Matrix([1,0,0])
O.ok(9,(geff-(-g0*up-ax.cross(ax.cross(R*up)))).applyfunc(sp.simplify))
# 10
eps=sp.symbols('eps',positive=True) # R Om^2 = eps g0
tand=(-geff.dot(no)/(-geff.dot(up))).subs(Og,sp.sqrt(eps*g0/R))
lead=sp.simplify(sp.series(sp.simplify(sp.atan(tand)),eps,0,2).removeO()/eps)
O.wrong(10,lead-sp.cos(lam)**2,lead-sp.sin(lam)*sp.cos(lam),'leading order in eps=R Om^2/g0')
# 11
Ol=sp.Matrix([0,Og*sp.cos(lam),Og*sp.sin(lam)]); acc=sp.Matrix([0,0,-g])-2*Ol.cross(vv)
comp=sp.Matrix([2*Og*(vy*sp.sin(lam)-vz*sp.cos(lam)),-2*Og*vx*sp.sin(lam),-g+2*Og*vx*sp.cos(lam)])
O.ok(11,acc-comp)
# 12-15 first order; independent: exact linear ODE solved by power series in Omega
def first(vz0):
    zt0=vz0-g*t; xdd=sp.expand(acc[0].subs({vy:0,vz:zt0})); return xdd,sp.integrate(sp.integrate(xdd,(t,0,t)),(t,0,t))
xdd,xt=first(0)
O.ok(12,xdd-2*Og*g*t*sp.cos(lam)); O.ok(13,xt-Og*g*t**3*sp.cos(lam)/3)
xf=xt.subs(t,sp.sqrt(2*h/g)); mid=Og*g*sp.cos(lam)*(2*h/g)**Q(3,2)/3
O.wrong(14,[xf-mid,xf-Q(2,3)*Og*h*sp.cos(lam)*sp.sqrt(h/g)],[xf-mid,xf-Q(2,3)*Og*h*sp.cos(lam)*sp.sqrt(2*h/g)])
# check with the inertial-frame (angular momentum) at the equator numerically, small Omega
import mpmath as mp
def equator(h_,Om_,g_,R_): # uniform-ish: exact Kepler at equator gives 1/3 Om g t^3 to first order (R large)
    mp.mp.dps=30; T=mp.sqrt(2*h_/g_); ang=mp.quad(lambda s:Om_*(R_+h_)**2/(R_+h_-g_*s*s/2)**2-Om_,[0,T]); return R_*ang
val=equator(mp.mpf(100),mp.mpf('1e-5'),mp.mpf('9.81'),mp.mpf(10)**12)
assert abs(val/(mp.mpf(1)/3*mp.mpf('1e-5')*mp.mpf('9.81')*(200/mp.mpf('9.81'))**mp.mpf(1.5))-1)<1e-6
_,xu=first(v0); O.ok(15,sp.simplify(xu.subs(t,2*v0/g))+Q(4,3)*Og*v0**3*sp.cos(lam)/g**2)
# Foucault
w0,x_,y_=sp.symbols('w0 x_ y_',positive=True); Oz=Og*sp.sin(lam)
hor=sp.Matrix([-w0**2*x_,-w0**2*y_,0])-2*Ol.cross(sp.Matrix([vx,vy,0]))
O.ok(16,[hor[0]-(-w0**2*x_+2*Oz*vy),hor[1]-(-w0**2*y_-2*Oz*vx)])
xdd_,ydd_=hor[0],hor[1]
O.ok(17,sp.expand(xdd_+sp.I*ydd_+2*sp.I*Oz*(vx+sp.I*vy)+w0**2*(x_+sp.I*y_)))
c1,c2,oz=sp.symbols('c1 c2 oz',positive=True)
S=lambda w1_:sp.exp(-sp.I*oz*t)*(c1*sp.exp(sp.I*w1_*t)+c2*sp.exp(-sp.I*w1_*t)); ode=lambda s:sp.simplify(s.diff(t,2)+2*sp.I*oz*s.diff(t)+w0**2*s)
num={w0:Q(13,10),oz:Q(1,5),c1:Q(2,3),c2:Q(5,4),t:Q(7,5)}
w1s=sp.symbols('w1s'); res=sp.solve(sp.simplify(ode(S(w1s)).subs({c2:0})),w1s); print('omega_1 roots',res)
O.ok(18,ode(S(sp.sqrt(w0**2+oz**2))).subs(num),'form with the right omega_1')
O.wrong(19,ode(S(sp.sqrt(w0**2-oz**2))).subs(num),ode(S(sp.sqrt(w0**2+oz**2))).subs(num))
O.ok(20,[oz*2*sp.pi/oz-2*sp.pi,(2*sp.pi/(Og*sp.sin(lam)))*Oz-2*sp.pi],'phase Omega_z T = 2 pi')
# inertial circle: a_perp = |2 Oz v|
vsp=sp.symbols('vsp',positive=True); rho=vsp**2/(2*Oz*vsp)
O.wrong(21,rho-vsp/(Og*sp.sin(lam)),rho-vsp/(2*Og*sp.sin(lam)))
O.done()
