from orc import *
O=Orc('coupled.tex')
for trial in range(3):
    m,l,k,g,b=rnd(1,3),rnd(1,2),rnd(5,20),rnd(5,10),rnd(0.5,1); a=l*rnd(0.3,0.9)
    p=[rnd(),rnd()]; pd=[rnd(),rnd()]
    with mp.workdps(200):
        e=mpf(10)**-60
        def Vx(q): # exact potential energy
            el=mp.sqrt((b+a*(mp.sin(q[1])-mp.sin(q[0])))**2+(a*(mp.cos(q[0])-mp.cos(q[1])))**2)-b
            return m*g*l*(2-mp.cos(q[0])-mp.cos(q[1]))+k/2*el**2
        V2=lambda q:Vx([e*q[0],e*q[1]])/e**2
        Vn=V2(p)
        Kn=A([[ (V2([1,0])*2) ,V2([1,1])-V2([1,0])-V2([0,1])],[0,V2([0,1])*2]]); Kn[1,0]=Kn[0,1]
    V_=+Vn; K=A([[+x for x in r] for r in Kn])
    Tn=mpf(0)
    for q,qd in zip(p,pd): 
        J=Jet([q,qd]); x,y=sin(J)*l,cos(J)*(-l); Tn+=m/2*(x.d().at()**2+y.d().at()**2)
    O.rec(1,[eq(Tn,m*l**2/2*(pd[0]**2+pd[1]**2))]); O.rec(2,[eq(V_,m*g*l/2*(p[0]**2+p[1]**2)+k*a**2/2*(p[1]-p[0])**2)])
    Mm=A([[m*l**2,mpf(0)],[mpf(0),m*l**2]]); pv=A(p); acc=solve(Mm,-(K@pv))
    d=p[1]-p[0]
    O.rec(3,[eq(m*l**2*acc[0],-m*g*l*p[0]+k*a**2*d)])
    r=m*l**2*acc[1]; O.rec(4,[eq(r,-m*g*l*p[1]+k*a**2*d)],[eq(r,-m*g*l*p[1]-k*a**2*d)],[[eq(r,-m*g*l*p[1]-k*a**2*d)]])
    O.rec(5,[max(abs(x) for x in Mm@acc+K@pv)]); Tq=lambda qd:m*l**2/2*(qd[0]**2+qd[1]**2)
    O.rec(6,[eq(Mm,A([[2*Tq([1,0]),Tq([1,1])-Tq([1,0])-Tq([0,1])],[mpf(0),2*Tq([0,1])]]))])
    O.rec(7,[eq(K,A([[m*g*l+k*a**2,-k*a**2],[-k*a**2,m*g*l+k*a**2]]))])
    w=rnd(1,5); dt=det(K-w**2*Mm); q2=(m*g*l+k*a**2-m*l**2*w**2)**2
    O.rec(8,[eq(dt,q2+k**2*a**4)],[eq(dt,q2-k**2*a**4)])
    ev,Q=mp.eigsy(mp.matrix([[K[i,j]/(m*l**2) for j in range(2)] for i in range(2)])); o1,o2=sorted([ev[0],ev[1]])
    O.rec(9,[eq(o1,g/l)]); O.rec(10,[eq(o2,g/l+k*a**2/m/l**2)],[eq(o2,g/l+2*k*a**2/m/l**2)])
    u1=A([mpf(1),mpf(1)]); u2=A([mpf(1),mpf(-1)])
    assert eq(K@u1,o1*(Mm@u1))<TOL and eq(K@u2,o2*(Mm@u2))<TOL
    O.definition(11); O.rec(12,[abs(dot(u1,Mm@u2))]); k2=dot(u2,K@u2)
    O.rec(13,[eq(k2,2*m*g*l+2*k*a**2)],[eq(k2,2*m*g*l+4*k*a**2)]); O.definition(14)
    e1,e2=(p[0]+p[1])/2,(p[0]-p[1])/2; d1,d2=(pd[0]+pd[1])/2,(pd[0]-pd[1])/2
    O.rec(15,[eq(p[0],e1+e2),eq(p[1],e1-e2)]); O.rec(16,[eq(Tn,m*l**2*(d1**2+d2**2))])
    O.rec(17,[eq(V_,m*g*l*(e1**2+e2**2)+k*a**2*e2**2)],[eq(V_,m*g*l*(e1**2+e2**2)+2*k*a**2*e2**2)])
    al,t=rnd(0.1,0.2),rnd(1,3); W1,W2=mp.sqrt(o1),mp.sqrt(o2)
    Qm=A([[Q[i,j] for j in range(2)] for i in range(2)])
    ph=Qm@A([mp.cos(mp.sqrt(ev[i])*t)*(Qm.T@A([al,0]))[i] for i in range(2)])
    S,D_=(W1+W2)/2*t,(W2-W1)/2*t
    O.rec(18,[eq(ph[0],al/2*(mp.cos(W1*t)+mp.cos(W2*t))),eq(ph[0],al*mp.cos(D_)*mp.cos(S))])
    x=al/2*(mp.cos(W1*t)-mp.cos(W2*t))
    O.rec(19,[eq(ph[1],x),eq(x,al*mp.sin(D_)*mp.cos(S))],[eq(ph[1],x),eq(x,al*mp.sin(D_)*mp.sin(S))],bad={1})
    f=lambda t:mp.cos((W2-W1)/2*t); t0=mp.findroot(f,mpf('1.6')*2/(W2-W1),tol=mpf(10)**-90,verify=False)
    assert all(f(t0*i/100)>0 for i in range(100))
    O.rec(20,[eq(t0,2*mp.pi/(W2-W1))],[eq(t0,mp.pi/(W2-W1))])
O.done()
