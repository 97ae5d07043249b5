from oracle_lib import *
O=Oracle('exam_solutions_TM.tex'); Q=sp.Rational; t=sp.symbols('t')
I1,I2,I3,Om=sp.symbols('I1 I2 I3 Om',positive=True); w=sp.symbols('w1:4',positive=True); I=(I1,I2,I3)
W=sp.Matrix(w); Lv=sp.Matrix([I[i]*w[i] for i in range(3)]); wd=[(-W.cross(Lv))[i]/I[i] for i in range(3)]
O.ok(1,[I1*wd[0]-(I2-I3)*w[1]*w[2],I2*wd[1]-(I3-I1)*w[2]*w[0],I3*wd[2]-(I1-I2)*w[0]*w[1]])
O.ok(2,[sp.expand(sum(I[i]*w[i]*wd[i] for i in range(3))),sp.expand(sum(I[i]**2*w[i]*wd[i] for i in range(3))),Lv.dot(Lv)-sum(I[i]**2*w[i]**2 for i in range(3)),W.dot(Lv)-sum(I[i]*w[i]**2 for i in range(3))])
def lin(ax):
    j=[i for i in range(3) if i!=ax]; base={w[ax]:Om,w[j[0]]:0,w[j[1]]:0}
    A=sp.Matrix([[wd[i].diff(w[k]).subs(base) for k in j] for i in j]); return A
A=lin(1); k=sp.simplify((A*A)[0,0]); O.ok(3,k-(I2-I3)*(I1-I2)/(I1*I3)*Om**2)
num={I1:Q(1),I2:Q(23,10),I3:Q(31,10),Om:Q(17,10)}
O.wrong(4,(k-Om**2*(I2-I1)*(I3-I2)/(I1*I2)).subs(num),(k-Om**2*(I2-I1)*(I3-I2)/(I1*I3)).subs(num))
A=lin(2); k3=sp.simplify((A*A)[0,0]); O.ok(5,(k3+Om**2*(I3-I1)*(I3-I2)/(I1*I2)).subs(num))
# Q2
m,g,kk,l0=sp.symbols('m g k l0',positive=True); r_,th_=sp.Function('r')(t),sp.Function('th')(t)
P=sp.Matrix([r_*sp.sin(th_),-r_*sp.cos(th_)]); r,th,rd,td,rdd,tdd=sp.symbols('r th rd td rdd tdd',positive=True)
S=lambda e:sp.simplify(e).subs([(r_.diff(t,2),rdd),(th_.diff(t,2),tdd),(r_.diff(t),rd),(th_.diff(t),td),(r_,r),(th_,th)])
L=m*P.diff(t).dot(P.diff(t))/2-m*g*P[1]-kk*(r_-l0)**2/2
O.ok(6,S(L)-(m*(rd**2+r**2*td**2)/2+m*g*r*sp.cos(th)-kk*(r-l0)**2/2))
# Newton, radial and tangential
er=sp.Matrix([sp.sin(th_),-sp.cos(th_)]); et=sp.Matrix([sp.cos(th_),sp.sin(th_)]); net=m*P.diff(t,2)+sp.Matrix([0,m*g])+kk*(r_-l0)*er
R1,R2=S(net.dot(er)),S(net.dot(et)/m)
O.ok(7,sp.simplify(R1-(m*rdd-(m*r*td**2+m*g*sp.cos(th)-kk*(r-l0)))))
O.wrong(8,sp.simplify(R2-(r*tdd+rd*td+g*sp.sin(th))),sp.simplify(R2-(r*tdd+2*rd*td+g*sp.sin(th))))
re=sp.solve(R1.subs({rdd:0,td:0,th:0}),r)[0]; O.ok(9,re-(l0+m*g/kk))
wt2=g/re; x=sp.symbols('x')
lr=-(sp.solve(R1,rdd)[0]).diff(r).subs({td:0,th:0}); lt=-(sp.solve(R2,tdd)[0]).diff(th).subs({td:0,rd:0,th:0,r:re})
O.ok(10,[lr-kk/m,lt-g/re,lt-kk*g/(kk*l0+m*g)])
X=sp.symbols('X'); sol=sp.solve(sp.simplify((lr-4*lt).subs(l0,X/kk)),X)[0]; O.wrong(11,sol-4*m*g,sol-3*m*g)
# Q3
R,y,a=sp.symbols('R y a',positive=True); rh,ph=sp.symbols('rh ph',positive=True); den=2*m/(sp.pi*R**2)
d=sp.integrate(sp.integrate(den*rh**2*sp.sin(ph),(rh,0,R)),(ph,0,sp.pi))/m; O.ok(12,d-4*R/(3*sp.pi))
IG=sp.simplify(sp.integrate(sp.integrate(den*((rh*sp.cos(ph))**2+(rh*sp.sin(ph)-d)**2)*rh,(ph,0,sp.pi)),(rh,0,R)))
O.ok(13,IG-(m*R**2/2-m*d**2),'direct integration about G')
C=sp.Matrix([R*th_,R]); G=C+d*sp.Matrix([-sp.sin(th_),-sp.cos(th_)]); 
vG2=S(G.diff(t).dot(G.diff(t))); T=sp.expand(m*vG2/2+IG*td**2/2)
TT=lambda s:T-(IG+m*(R**2+d**2+s*2*R*d*sp.cos(th)))*td**2/2
O.wrong(14,TT(1),TT(-1),'rolling: C moves R th, body turns by th')
O.ok(15,(m*g*G[1]-m*g*R).subs(th_,th)+m*g*d*sp.cos(th),'up to the constant mgR')
w2=sp.simplify((m*g*d)/(T.subs(th,0)*2/td**2)); O.ok(16,[w2-g*d/(Q(3,2)*R**2-2*R*d),w2-8*g/((9*sp.pi-16)*R)])
# Q4: impulse J
M,c,b,e,v=sp.symbols('M c b e v',positive=True); s_=sp.symbols('s'); J=sp.symbols('J'); Ir=sp.integrate(M/(2*c)*s_**2,(s_,-c,c))
Vv,om,vp=J/M,J*b/Ir,v-J/m; Js=sp.solve(Vv+b*om-vp-e*v,J)[0]; sb=lambda q:sp.simplify(q.subs(J,Js))
V,w_,v1=sb(Vv),sb(om),sb(vp)
O.ok(17,[m*v-(m*v1+M*V),m*v*b-(m*v1*b+M*c**2*w_/3)])
O.wrong(18,V-b*w_-v1-e*v,V+b*w_-v1-e*v,'struck point of the rod: V + b w')
O.ok(19,[V-(1+e)*m*v/(M+m+3*m*b**2/c**2),w_-3*b*V/c**2])
O.ok(20,v1.subs(e,m/M*(1+3*b**2/c**2)))
dE=m*v**2/2-m*v1**2/2-M*V**2/2-Ir*w_**2/2; br=1/(1/m+1/M+3*b**2/(M*c**2))
O.wrong(21,dE-(1-e)**2*v**2*br/2,dE-(1-e**2)*v**2*br/2)
O.ok(22,V.subs({e:1,b:c})-2*m*v/(M+4*m))
O.done()
