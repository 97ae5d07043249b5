import sys; sys.path.insert(0,'.')
from olib import *
import sympy as sp
R=Rec('hw6',18)
M,m,l,k,g,t=sp.symbols('M m l k g t',positive=True)
x=sp.Function('x')(t); th=sp.Function('th')(t); X,T_=x.diff(t),th.diff(t); Q=sp.Rational
vals={M:Q(17,10),m:Q(9,10),l:Q(13,10),k:Q(23,10),g:Q(49,5)}
st={x:Q(3,10),th:Q(7,10),X:Q(11,10),T_:Q(-6,5),x.diff(t,2):Q(4,5),th.diff(t,2):Q(17,10)}
def num(*es):
    r=mpf(0)
    for e in es:
        for q in (e if isinstance(e,sp.MatrixBase) else [e]):
            q=sp.sympify(q)
            for a in (x.diff(t,2),th.diff(t,2),X,T_,x,th): q=q.subs(a,st[a])
            r=max(r,abs(mpf(sp.N(q.subs(vals),50))))
    return r
# truth by integration along the rod
s=sp.Symbol('s',positive=True); px=x+s*sp.sin(th); py=-s*sp.cos(th); lin=m/l
xG=sp.integrate(px,(s,0,l))/l; yG=sp.integrate(py,(s,0,l))/l
R.put(1,num(xG-x-l/2*sp.sin(th),yG+l/2*sp.cos(th)))
R.put(2,num(xG.diff(t)-X-l/2*T_*sp.cos(th),yG.diff(t)-l/2*T_*sp.sin(th)))
vG=xG.diff(t)**2+yG.diff(t)**2
f3=lambda c:X**2+c*X*T_*sp.cos(th)+l**2/4*T_**2
R.put(3,num(vG-f3(l/2)),num(vG-f3(l)))
IG=sp.integrate((s-l/2)**2*lin,(s,0,l)); R.put(4,num(IG-m*l**2/3),num(IG-m*l**2/12),remark='m l^2/3 is about the pin: %s'%num(sp.integrate(s**2*lin,(s,0,l))-m*l**2/3))
Tr=sp.integrate(sp.expand(sp.simplify(px.diff(t)**2+py.diff(t)**2))*lin/2,(s,0,l))+M*X**2/2
Tw=(M+m)*X**2/2+m*l*X*T_*sp.cos(th)/2+m*l**2*T_**2/6
R.put(5,num(Tr-(M*X**2/2+m*vG/2+IG*T_**2/2),Tr-Tw))
V=k*x**2/2+sp.integrate(lin*g*py,(s,0,l)); R.put(6,num(V-k*x**2/2+m*g*l*sp.cos(th)/2))
L=sp.expand(Tr-V)
R.put(7,num(L-(Tw-k*x**2/2-m*g*l*sp.cos(th)/2)),num(L-(Tw-k*x**2/2+m*g*l*sp.cos(th)/2)))
px_=L.diff(X); R.put(8,num(px_-(M+m)*X-m*l*T_*sp.cos(th)/2))
w9=(M+m)*x.diff(t,2)+m*l*th.diff(t,2)*sp.cos(th)/2; D9=px_.diff(t)
R.put(9,num(D9-w9),num(D9-w9+m*l*T_**2*sp.sin(th)/2))
# truth of the motion: solve Lagrange equations
EL1=px_.diff(t)-L.diff(x); EL2=L.diff(T_).diff(t)-L.diff(th)
a,b=sp.symbols('a b'); so=sp.solve([EL1.subs({x.diff(t,2):a,th.diff(t,2):b}),EL2.subs({x.diff(t,2):a,th.diff(t,2):b})],[a,b],dict=True)[0]
# independent: Newton. rod about G with pin force (Fx,Fy), cart: M a=-k x-Fx
Fx,Fy=sp.symbols('Fx Fy'); ax=xG.diff(t,2).subs({x.diff(t,2):a,th.diff(t,2):b}); ay=yG.diff(t,2).subs({th.diff(t,2):b})
# torque about G of force at pin, r=(x-xG, -yG), positive sense of theta: counterclockwise
ne=sp.solve([m*ax-Fx,m*ay-Fy+m*g,M*a+k*x+Fx,IG*b-((x-xG)*Fy-(-yG)*Fx)],[a,b,Fx,Fy],dict=True)[0]
print('Newton vs Lagrange',num(ne[a]-so[a],ne[b]-so[b]))
on=lambda e:num(sp.sympify(e).subs({x.diff(t,2):ne[a],th.diff(t,2):ne[b]}))
R.put(10,on((M+m)*x.diff(t,2)+m*l*th.diff(t,2)*sp.cos(th)/2-m*l*T_**2*sp.sin(th)/2+k*x))
R.put(11,num(L.diff(T_)-m*l*X*sp.cos(th)/2-m*l**2*T_/3))
w12=-m*l*X*T_*sp.sin(th)/2
d12=L.diff(th)-(w12-m*g*l*sp.cos(th)/2)
R.put(12,num(d12),num(L.diff(th)-(w12-m*g*l*sp.sin(th)/2)),only_if=[abs(mpf(sp.N(d12.subs(X,0).subs(T_,0).subs(th,sp.pi/4).subs(vals),50)))])
R.put(13,on(Q(2,3)*l*th.diff(t,2)+x.diff(t,2)*sp.cos(th)+g*sp.sin(th)))
En=Tw+k*x**2/2-m*g*l*sp.cos(th)/2; R.put(14,on(En.diff(t)))
# linear: scale state by eps
eps=sp.Symbol('e'); A0,B0=sp.symbols('A0 B0')
Y=sp.symbols('y0:6'); order=[x.diff(t,2),th.diff(t,2),X,T_,x,th]
def lin1(e):
    for o,y in zip(order,Y): e=e.subs(o,eps*y)
    return sp.expand(sp.series(e,eps,0,2).removeO().coeff(eps,1))
l1=lin1(EL1); l2=lin1(EL2); 
def n6(e): return abs(mpf(sp.N(sp.sympify(e).subs(dict(zip(Y,[Q(4,5),Q(17,10),Q(11,10),Q(-6,5),Q(3,10),Q(7,10)]))).subs(vals),50)))
R.put(15,n6(l1-((M+m)*Y[0]+m*l*Y[1]/2+k*Y[4])),general=num(EL1-((M+m)*x.diff(t,2)+m*l*th.diff(t,2)/2+k*x)))
row=lambda c:m*l*Y[0]/2+m*l**2*Y[1]/3+c*Y[5]
R.put(16,max(n6(l1-((M+m)*Y[0]+m*l*Y[1]/2+k*Y[4])),n6(l2-row(m*g*l))),max(n6(l1-((M+m)*Y[0]+m*l*Y[1]/2+k*Y[4])),n6(l2-row(m*g*l/2))))
w=sp.Symbol('w',positive=True); D=sp.Matrix([[l1.coeff(Y[4])-w**2*l1.coeff(Y[0]),-w**2*l1.coeff(Y[1])],[-w**2*l2.coeff(Y[0]),l2.coeff(Y[5])-w**2*l2.coeff(Y[1])]])
det=sp.expand(D.det()); pr=(k-(M+m)*w**2)*(m*g*l/2-m*l**2*w**2/3)
W2=[mpf(0)]; 
roots=sp.Poly(det.subs(w,sp.sqrt(s)).subs(vals),s).nroots(n=40)
ev=lambda e:max(abs(mpf(sp.N(e.subs(vals).subs(w,sp.sqrt(r)),40))) for r in roots)
ev1=lambda e,wv:abs(mpf(sp.N(e.subs(vals).subs(w,wv),40)))
R.put(17,ev(pr-m**2*l**2*w**2/4),ev(pr-m**2*l**2*w**4/4),only_if=[ev1(m**2*l**2*w**2/4-m**2*l**2*w**4/4,1)])
d0=sp.factor(det.subs(k,0)/w**2); W=sp.solve(d0.subs(w,sp.sqrt(s)),s); print(W)
R.put(18,min(ev1(q-6*(M+m)*g/((4*M+m)*l),1) for q in W),general=min(abs(mpf(sp.N(r-(6*(M+m)*g/((4*M+m)*l)).subs(vals),40))) for r in roots))
R.save()
