"""Trolley with hanging beam: SymPy; energies from integration along the beam, equations from Newton/Lagrange, spot checks at random numbers."""
import sympy as sp, json
t,s=sp.symbols('t s'); M,m,L,k,c,g,a,mh,Om=sp.symbols('M m L k c g a m_h Omega',positive=True)
x=sp.Function('x')(t); th=sp.Function('theta')(t); F=sp.Function('F')(t)
D=lambda z: sp.diff(z,t)
Z=lambda e: sp.simplify(sp.expand_trig(sp.expand(e)))
num=lambda e: 'identically 0' if Z(e)==0 else 'nonzero: '+str(Z(e))
res={}
# beam element at distance s from the pin
px,py=x+s*sp.sin(th),-s*sp.cos(th)
xG,yG=sp.integrate(px,(s,0,L))/L, sp.integrate(py,(s,0,L))/L
res[1]=(num(sp.Abs(0)+ (xG-x-L/2*sp.sin(th))**2+(yG+L/2*sp.cos(th))**2),None)
v2=D(xG)**2+D(yG)**2
res[2]=(num(v2-D(x)**2-L**2/4*D(th)**2-L*D(x)*D(th)*sp.cos(th)),None)
T=M*D(x)**2/2+sp.integrate(sp.expand(m/L*(D(px)**2+D(py)**2)/2),(s,0,L))
res[3]=(num(T-(M+m)*D(x)**2/2-m*L*D(x)*D(th)*sp.cos(th)/2-m*L**2*D(th)**2/6),None)
V=k*x**2/2+sp.integrate(m/L*g*py,(s,0,L))
res[4]=(num(V-k*x**2/2+m*g*L*sp.cos(th)),num(V-k*x**2/2+m*g*L*sp.cos(th)/2))
res[5]=('definition',None)
Dd=c*D(x)**2/2
# independent Newton/Euler equations: reaction at the pin eliminated
xe=M*D(D(x))+m*D(D(xG))+k*x+c*D(x)-F                      # horizontal momentum of trolley + beam
# moment of momentum of the beam about the moving pin: sum s-element  (r - pin) x (a - g)
ax,ay=D(D(px)),D(D(py))
the=sp.integrate(sp.expand(m/L*((px-x)*(ay+g)-py*ax)),(s,0,L))   # = 0
def lag(q,Q,sgn=-1): return D(sp.diff(T,D(q)))+sgn*sp.diff(T,q)+sp.diff(V,q)+sp.diff(Dd,D(q))-Q
res[6]=(num(lag(x,F)-xe)+' / '+num(lag(th,0)-the),None)
res[7]=(num((M+m)*D(D(x))+m*L/2*(D(D(th))*sp.cos(th)-D(th)**2*sp.sin(th))+c*D(x)+k*x-F-xe),None)
te=m*L**2/3*D(D(th))+m*L/2*D(D(x))*sp.cos(th)+m*g*L/2*sp.sin(th)
res[8]=(num(te-m*L/2*D(x)*D(th)*sp.sin(th)-the),num(te-the))
sol=sp.solve([xe,the],[D(D(x)),D(D(th))],dict=True)[0]
Ed=D(T+V).subs(sol)
res[9]=(num(Ed-F*D(x)+Dd),num(Ed-F*D(x)+2*Dd))
e=sp.symbols('e'); X=sp.Function('X')(t); H=sp.Function('H')(t)
lin=lambda q: sp.series(q.subs({F:0,c:0}).subs({x:e*X,th:e*H}).doit(),e,0,2).removeO().coeff(e,1)
res[10]=('to first order: '+num(lin(xe)-((M+m)*D(D(X))+m*L/2*D(D(H))+k*X))+' / '+num(lin(the)-(m*L/2*D(D(X))+m*L**2/3*D(D(H))+m*g*L/2*H)),'finite angle, k X etc. only: '+num((xe-((M+m)*D(D(x))+m*L/2*D(D(th))+k*x)).subs({F:0,c:0}).doit())[:60])
lam=sp.symbols('lambda')
Mm=sp.Matrix([[M+m,m*L/2],[m*L/2,m*L**2/3]]); Km=sp.diag(k,m*g*L/2)
det=(Km-lam*Mm).det()
res[11]=(num(det-((k-(M+m)*lam)*(m*g*L/2-m*L**2/3*lam)-m**2*L**2*lam**2/4)),None)
res[12]=(num(sp.solve((Km-lam*Mm)[1,1],lam)[0]-3*g/(2*L)),None)
fr=[r for r in sp.solve(det.subs(k,0),lam) if r!=0][0]
res[13]=(num(fr-6*g*(M+m)/(L*(M+4*m))),num(fr-6*g*(M+m)/(L*(4*M+m))))
te_a=the.subs(x,a*t**2/2).doit(); th0=sp.symbols('theta_0')
eq=te_a.subs(th,th0).doit()
res[14]=(num((eq/(m*L/2*sp.cos(th0))-(a+g*sp.tan(th0)))),None)
# linearise about th0=-atan(a/g)
y=sp.Function('y')(t); t0=-sp.atan(a/g)
l1=sp.series(te_a.subs(th,t0+e*y).doit(),e,0,2).removeO().coeff(e,1)
w2=sp.simplify(l1.coeff(y)/l1.coeff(D(D(y)))) if l1.coeff(D(D(y)))!=0 else None
l1=sp.expand(sp.simplify(l1)); w2=sp.simplify(l1.coeff(y)/l1.coeff(D(D(y))))
res[15]=(num(w2-3*g/(2*L)*sp.cos(t0)),num(w2-3*g/(2*L)/sp.cos(t0)))
# hook block
l=sp.Function('l')(t); qx,qy=l*sp.sin(th),-l*sp.cos(th); ex,ey=D(D(qx)),D(D(qy))+g
tang=sp.simplify(ex*sp.cos(th)+ey*sp.sin(th))       # must vanish: rope force has no transverse component
res[16]=(num(l*D(D(th))+D(l)*D(th)+g*sp.sin(th)-tang),num(l*D(D(th))+2*D(l)*D(th)+g*sp.sin(th)-tang))
S=mh*(-ex*sp.sin(th)+ey*sp.cos(th))                 # along the rope towards the pin
res[17]=(num(S-mh*(g*sp.cos(th)+l*D(th)**2-D(D(l)))),None)
lc=sp.symbols('l_c',positive=True); yP=sp.Function('y_P')(t)
ex,ey=D(D(lc*sp.sin(th))),D(D(yP-lc*sp.cos(th)))+g
tang=ex*sp.cos(th)+ey*sp.sin(th)
res[18]=(num(lc*D(D(th))+(g-D(D(yP)))*sp.sin(th)-tang),num(lc*D(D(th))+(g+D(D(yP)))*sp.sin(th)-tang))
for i,r in res.items(): print(i,r)
json.dump({str(i):list(r) for i,r in res.items()},open('out_trolley_memo.json','w'),indent=1)
