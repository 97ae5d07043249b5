"""Inertia integrals, SymPy (exact) and a mass-point check."""
import sympy as sp, json
x,y,z,X,al=sp.symbols('x y z xi alpha',real=True); a,b,m,M,R,H,m1,m2,l,s,g,mf,ro,ri,be=sp.symbols('a b m M R H m_1 m_2 l s g m_f r_o r_i beta',positive=True)
num=lambda e: 'identically 0' if sp.simplify(e)==0 else 'nonzero: '+str(sp.factor(sp.simplify(e)))
tri=lambda f: sp.simplify(sp.integrate(sp.integrate(f,(y,0,b*(1-x/a))),(x,0,a)))
res={}
sg=m/tri(1); res[1]=(num(sg-2*m/(a*b)),None)
xC,yC=sg*tri(x)/m,sg*tri(y)/m; res[2]=(num((xC-a/3)**2+(yC-b/3)**2),None)
Ixx,Iyy,Ixy,Izz=sg*tri(y**2),sg*tri(x**2),-sg*tri(x*y),sg*tri(x**2+y**2)
res[3]=(num(Ixx-m*b**2/6),None)
res[4]=(num(Iyy-m*a**2/6)+' / '+num(Iyy-sg*sp.integrate(x**2*b*(1-x/a),(x,0,a))),None)
res[5]=(num(Ixy+m*a*b/24),num(Ixy+m*a*b/12))
res[6]=(num(Izz-Ixx-Iyy)+' / '+num(Izz-m*(a**2+b**2)/6),None)
IxxC,IyyC,IxyC=sg*tri((y-yC)**2),sg*tri((x-xC)**2),-sg*tri((x-xC)*(y-yC))
res[7]=(num(IxxC-Ixx-m*yC**2)+' / '+num(IxxC-5*m*b**2/18),num(IxxC-Ixx+m*yC**2)+' / '+num(IxxC-m*b**2/18))
res[8]=(num(IxyC-Ixy-m*xC*yC)+' / '+num(IxyC-m*a*b/36),None)
J=sp.Matrix([[IxxC,IxyC],[IxyC,IyyC]]); u=sp.Matrix([sp.cos(al),sp.sin(al)]); v=sp.Matrix([-sp.sin(al),sp.cos(al)])
off=(u.T*J*v)[0]                                      # = 0 on principal axes; = (Iyy-Ixx)/2 sin2a + Ixy cos2a
res[9]=(num(off-((IyyC-IxxC)/2*sp.sin(2*al)+IxyC*sp.cos(2*al)))+'  => tan2a = 2Ixy/(Ixx-Iyy)',None)
tt=2*IxyC/(IxxC-IyyC)
res[10]=(num(tt-a*b/(a**2-b**2)),num(tt-a*b/(b**2-a**2)))
ev=lambda sgn: m/36*(a**2+b**2+sgn*sp.sqrt(a**4-a**2*b**2+b**4))
res[11]=(num(ev(1)+ev(-1)-J.trace())+' / '+num(sp.expand(ev(1)*ev(-1))-J.det()),None)
# distance from the hypotenuse bx+ay-ab=0
res[12]=(num(sg*tri((b*x+a*y-a*b)**2/(a**2+b**2))-m*a**2*b**2/(6*(a**2+b**2))),None)
I3=sp.Matrix([[Ixx,Ixy,0],[Ixy,Iyy,0],[0,0,Izz]]); Rm=sp.Matrix([[sp.cos(be),sp.sin(be),0],[-sp.sin(be),sp.cos(be),0],[0,0,1]])
# direct integration on the turned axes
xn,yn=x*sp.cos(be)+y*sp.sin(be),-x*sp.sin(be)+y*sp.cos(be)
Id=sp.Matrix([[sg*tri(yn**2),-sg*tri(xn*yn),0],[-sg*tri(xn*yn),sg*tri(xn**2),0],[0,0,Izz]])
res[13]=('max entry '+num((Id-Rm.T*I3*Rm)[0,1]),'%s'%[num(e) for e in (Id-Rm*I3*Rm.T)[:]].count('identically 0')+' of 9 entries identically 0')
rho=M/(sp.pi*R**2*H/3); r=sp.symbols('r'); ph=sp.symbols('phi')
cone=lambda f: sp.integrate(sp.integrate(sp.integrate(f*r,(ph,0,2*sp.pi)),(r,0,R*z/H)),(z,0,H))*rho
Cz,Cx=cone(r**2),cone(r**2*sp.sin(ph)**2+z**2); zc=cone(z)/M
res[14]=(num(Cz-sp.Rational(3,10)*M*R**2)+' / slices '+num(sp.integrate((R*z/H)**2/2*rho*sp.pi*(R*z/H)**2,(z,0,H))-Cz),None)
res[15]=(num(Cx-sp.Rational(3,20)*M*R**2-sp.Rational(3,5)*M*H**2)+' / slices '+num(sp.integrate(((R*z/H)**2/4+z**2)*rho*sp.pi*(R*z/H)**2,(z,0,H))-Cx),None)
CxC=cone(r**2*sp.sin(ph)**2+(z-zc)**2)
res[16]=(num(CxC-Cx+M*(H/4)**2),num(CxC-Cx+M*(3*H/4)**2)+' / '+num(CxC-sp.Rational(3,20)*M*R**2-sp.Rational(3,80)*M*H**2))
rr=sp.symbols('rr')
rod=sp.integrate(m1/l*x**2,(x,0,l)); ball=sp.integrate(m2/(4*sp.pi*s**3/3)*sp.Rational(2,3)*4*sp.pi*rr**4,(rr,0,s))
IO=rod+ball+m2*(l+s)**2
res[17]=(num(IO-(m1*l**2/3+sp.Rational(2,5)*m2*s**2+m2*l**2)),num(IO-(m1*l**2/3+sp.Rational(2,5)*m2*s**2+m2*(l+s)**2)))
firstm=sp.integrate(m1/l*x,(x,0,l))+sp.integrate((l+s+x)*m2/(4*sp.pi*s**3/3)*sp.pi*(s**2-x**2),(x,-s,s))   # rod + slices of the ball
d=(m1*l/2+m2*(l+s))/(m1+m2); res[18]=(num(firstm/(m1+m2)-d),None)
import mpmath as mp
k0=0.5  # amplitude 1 rad: sin(1/2)
exact=4*mp.ellipk(mp.sin(0.5)**2)/(2*mp.pi)
res[19]=('small amplitude: I th" + (m1+m2) g d sin th = 0 -> omega^2=(m1+m2) g d/I, period ratio at amplitude 1e-6: %s'%mp.nstr(4*mp.ellipk(mp.sin(mp.mpf(5)/10**7)**2)/(2*mp.pi),12),'at amplitude 1 rad the true period is %s times the formula'%mp.nstr(exact,6))
ring=mf/(sp.pi*(ro**2-ri**2))*2*sp.pi*sp.integrate(r**3,(r,ri,ro))
res[20]=(num(ring-mf*(ro**2-ri**2)/2),num(ring-mf*(ro**2+ri**2)/2))
for i,q in res.items(): print(i,q)
json.dump({str(i):list(r) for i,r in res.items()},open('out_inertia_homework.json','w'),indent=1)
