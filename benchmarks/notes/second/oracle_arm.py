from orc import *
O=Orc('arm.md')
def e(a): return A([cos(a),sin(a)])
def ep(a): return A([-sin(a),cos(a)])
def cr(a,b): return a[0]*b[1]-a[1]*b[0]
class Arm:
    def __init__(s):
        s.l=[rnd(0.5,1.2),rnd(0.4,0.9)]; s.m=[rnd(1.5,3),rnd(1.2,2.5)]; s.a=[rnd(0.2,0.5),rnd(0.2,0.4)]; s.g=rnd(6,10)
        s.pts=[]; s.I=[]
        for k in range(2):   # four unequal particles with the mass centre on the line of the link
            q=[(s.m[k]*mpf('0.3'),A([rnd(-.3,.3),rnd(-.3,.3)])),(s.m[k]*mpf('0.5'),A([rnd(-.3,.3),rnd(-.3,.3)])),(s.m[k]*mpf('0.2'),A([rnd(-.3,.3),rnd(-.3,.3)]))]
            c=sum((m*x for m,x in q[1:]),q[0][0]*q[0][1])/s.m[k]; q=[(m,x-c+A([s.a[k],mpf(0)])) for m,x in q]
            s.pts.append(q); s.I.append(sum(m*dot(x-A([s.a[k],0]),x-A([s.a[k],0])) for m,x in q))
    def place(s,q1,q2):
        """positions of all particles (mass, position, link), elbow, tip"""
        t1,t2=q1,q1+q2; el=s.l[0]*e(t1); P=[(m,e(t1)*x[0]+ep(t1)*x[1],0) for m,x in s.pts[0]]+[(m,el+e(t2)*x[0]+ep(t2)*x[1],1) for m,x in s.pts[1]]
        return P,el,el+s.l[1]*e(t2)
    def T(s,q,qd):
        P,_,_=s.place(Jet([q[0],qd[0]]),Jet([q[1],qd[1]])); r=mpf(0)
        for m,x,_ in P: v=V(D(x)); r+=m*dot(v,v)/2
        return r
    def U(s,q): 
        P,_,_=s.place(Jet([q[0]]),Jet([q[1]])); return sum(m*s.g*V(x)[1] for m,x,_ in P)
    def M(s,q):
        t=lambda a,b:s.T(q,(mpf(a),mpf(b))); m11,m22=2*t(1,0),2*t(0,1); m12=t(1,1)-t(1,0)-t(0,1)
        return A([[m11,m12],[m12,m22]])
    def Mj(s,q1,q2):
        """mass matrix with jets as arguments (any parameter)"""
        P0=[]; 
        J1=[(m,[ep(q1)*x[0]-e(q1)*x[1],A([0*q1,0*q1])]) for m,x in s.pts[0]]
        J2=[(m,[s.l[0]*ep(q1)+ep(q1+q2)*x[0]-e(q1+q2)*x[1],ep(q1+q2)*x[0]-e(q1+q2)*x[1]]) for m,x in s.pts[1]]
        R=[[Jet([0])]*2 for _ in range(2)]
        for m,J in J1+J2:
            for i in range(2):
                for j in range(2): R[i][j]=R[i][j]+m*dot(J[i],J[j])
        return A(R)
    def torque(s,q1,q2,F=None,grav=True):
        """moments about elbow (link 2) and shoulder (both links) from Newton's law of every particle; the surroundings act with -F on the tip"""
        P,el,tip=s.place(q1,q2); t=[mpf(0),mpf(0)]; g=A([mpf(0),s.g if grav else mpf(0)])
        el0,tp0=V(el),V(tip); F=A([mpf(0)]*2) if F is None else F
        for m,x,k in P:
            f=m*(V(D(D(x)))+g); t[0]+=cr(V(x),f)
            if k: t[1]+=cr(V(x)-el0,f)
        # t = motor torque + moment of (-F)
        return A([t[0]+cr(tp0,F),t[1]+cr(tp0-el0,F)])
for trial in range(4):
    a=Arm(); l1,l2=a.l; m1,m2=a.m; a1,a2=a.a; I1,I2=a.I; g=a.g
    q1,q2=rnd(0.2,1.3),rnd(0.3,2.2)*(1 if trial%2 else -1); d1,d2=rnd(0.5,2),rnd(0.5,2); dd1,dd2=rnd(),rnd()
    c1,s1,c2,s2,c12,s12=mp.cos(q1),mp.sin(q1),mp.cos(q2),mp.sin(q2),mp.cos(q1+q2),mp.sin(q1+q2)
    Q1,Q2=Jet([q1,d1,dd1/2]),Jet([q2,d2,dd2/2]); q=(q1,q2); qd=A([d1,d2]); qdd=A([dd1,dd2])
    O.definition(1); O.definition(14); O.definition(19)
    # 2: columns of R are the axes of {2} in {0}
    Rm=lambda x:A([[mp.cos(x),-mp.sin(x)],[mp.sin(x),mp.cos(x)]])
    ax=A([[V(e(Q1+Q2))[i],V(ep(Q1+Q2))[i]] for i in range(2)])
    O.rec(2,[eq(ax,Rm(q1)@Rm(q2)),eq(ax,A([[c12,-s12],[s12,c12]]))])
    P,el,tip=a.place(Q1,Q2); X=V(tip); x,y=X
    O.rec(3,[eq(X,A([l1*c1+l2*c12,l1*s1+l2*s12]))])
    O.rec(4,[eq(c2,(x**2+y**2-l1**2-l2**2)/(2*l1*l2))])
    at=lambda b,c:mp.atan2(b,c); wrap=lambda z:abs(mp.sin(z/2))
    O.rec(5,[wrap(q1-at(y,x)-at(l2*s2,l1+l2*c2))],[wrap(q1-at(y,x)+at(l2*s2,l1+l2*c2))])
    # Jacobian by unit rates
    def tipv(r1,r2): return V(D(a.place(Jet([q1,r1]),Jet([q2,r2]))[2]))
    J0=A([[tipv(1,0)[i],tipv(0,1)[i]] for i in range(2)]); J2=ax.T@J0
    O.rec(6,[eq(J0,A([[-l1*s1-l2*s12,-l2*s12],[l1*c1+l2*c12,l2*c12]]))])
    O.rec(7,[eq(J2[0],A([-l1*s2,mpf(0)])),eq(J2[1],A([l1*c2+l2,l2]))],[eq(J2[0],A([l1*s2,mpf(0)])),eq(J2[1],A([l1*c2+l2,l2]))],bad={0})
    O.rec(8,[eq(J0[0,0]*J0[1,1]-J0[0,1]*J0[1,0],l1*l2*s2)])
    F=rvec(2); st=a.torque(Jet([q1]),Jet([q2]),F,grav=False)
    O.rec(9,[eq(st,J0@F)],[eq(st,J0.T@F)],[[eq(st,J2.T@(ax.T@F))]])
    C2=sum((m*xx for m,xx,k in P[4:]),P[3][0]*P[3][1])*(1/m2) if False else None
    tot=None
    for m,xx,k in P:
        if k: tot=m*xx if tot is None else tot+m*xx
    vC=V(D(tot))/m2; v2=dot(vC,vC)
    O.rec(10,[eq(v2,l1**2*d1**2+a2**2*(d1+d2)**2+2*l1*a2*c2*d1*(d1+d2))])
    T=a.T(q,qd); base=(I1+m1*a1**2)*d1**2/2+m2*v2/2
    O.rec(11,[eq(T,base+I2*d2**2/2)],[eq(T,base+I2*(d1+d2)**2/2)])
    O.rec(12,[eq(a.U(q),m1*g*a1*s1+m2*g*(l1*s1+a2*s12))])
    M=a.M(q); g1=eq(M[0,0],I1+I2+m1*a1**2+m2*(l1**2+a2**2+2*l1*a2*c2)); g2=eq(M[0,1],I2+m2*(a2**2+l1*a2*c2))
    O.rec(13,[g1,g2,eq(M[1,1],I2+a2**2)],[g1,g2,eq(M[1,1],I2+m2*a2**2)],bad={2})
    # Christoffel
    assert eq(V(a.Mj(Jet([q1]),Jet([q2]))),M)<TOL
    dM=[V(D(a.Mj(Jet([q1,1]),Jet([q2])))),V(D(a.Mj(Jet([q1]),Jet([q2,1]))))]
    C=A([[sum((dM[k][i,j]+dM[j][i,k]-dM[i][j,k])/2*qd[k] for k in range(2)) for j in range(2)] for i in range(2)])
    # velocity terms from Newton: torque with zero acceleration, no gravity
    b=a.torque(Jet([q1,d1]),Jet([q2,d2]),None,grav=False); assert eq(b,C@qd)<TOL
    h=m2*l1*a2*s2
    O.rec(15,[eq(b[0],-h*(d1*d2+d2**2)),eq(b[1],h*d1**2)],[eq(b[0],-h*(2*d1*d2+d2**2)),eq(b[1],h*d1**2)],bad={0})
    Md=V(D(a.Mj(Q1,Q2))); K=Md-2*C
    O.rec(16,[max(abs(z) for z in flat(K+K.T))])
    G=a.torque(Jet([q1]),Jet([q2])); 
    dU=A([mp.diff(lambda z:a.U((z,q2)),q1),mp.diff(lambda z:a.U((q1,z)),q2)]); assert eq(dU,G)<mpf(10)**-25
    ro=(m1*a1+m2*l1)*g*c1+m2*a2*g*c12
    O.rec(17,[eq(G[0],ro),eq(G[1],m2*a2*g*s12)],[eq(G[0],ro),eq(G[1],m2*a2*g*c12)],bad={1})
    lhs=M@qdd+C@qd+G
    O.rec(18,[eq(lhs,a.torque(Q1,Q2,F))],under=[eq(lhs,a.torque(Q1,Q2))],alts=[[eq(lhs,a.torque(Q1,Q2,0*F))]],general=[eq(lhs,a.torque(Q1,Q2,F)-J0.T@F)])
    # 20: closed loop. Given tau by the law, find qdd from Newton (torque is linear in qdd)
    Kv,Kp=A([[rnd(1,2),rnd()],[rnd(),rnd(1,2)]]),A([[rnd(1,2),rnd()],[rnd(),rnd(1,2)]])
    qr,qrd,qrdd=rvec(2),rvec(2),rvec(2); er,erd=qr-A([q1,q2]),qrd-qd
    tau=M@(qrdd+Kv@erd+Kp@er)+C@qd+G
    def qddof(F):
        f=lambda u,v:a.torque(Jet([q1,d1,mpf(u)/2]),Jet([q2,d2,mpf(v)/2]),F); b0=f(0,0); A1,A2=f(1,0)-b0,f(0,1)-b0
        return solve(A([[A1[0],A2[0]],[A1[1],A2[1]]]),tau-b0)
    z=lambda F:qrdd-qddof(F)+Kv@erd+Kp@er
    O.rec(20,[max(abs(t) for t in z(F))],under=[max(abs(t) for t in z(None))],alts=[[max(abs(t) for t in z(0*F))]],general=[eq(M@z(F),J0.T@F)])
    # numbers
    b_=lambda t:mpf(0) if t else mpf(1)
    lam=mpf(4)/mpf('0.5'); Ic=mp.quad(lambda s:lam*(s-mpf('0.25'))**2,[0,mpf('0.5')])
    O.rec(21,[eq(Ic,mpf(4)*mpf('0.25')/3),b_(abs(mpf(4)*mpf('0.25')/3-mpf('0.333'))<mpf('0.0005'))],[eq(Ic,mpf(4)*mpf('0.25')/12),b_(abs(Ic-mpf('0.0833'))<=mpf('0.00005'))],bad={0})
    # holding torque: gravity moment of two uniform bars by integration
    tq=mp.quad(lambda s:mpf('9.81')*(mpf(4)/mpf('.5'))*s,[0,mpf('.5')])+mp.quad(lambda s:mpf('9.81')*(mpf(2)/mpf('.4'))*(mpf('.5')+s),[0,mpf('.4')])
    n2=(mpf('4')*mpf('.25')+2*mpf('.7'))*mpf('9.81')
    O.rec(22,[eq(tq,n2),b_(abs(n2-mpf('23.5'))<mpf('0.05')),eq(tq,(mpf(4)*mpf('.25')+mpf(2)*(mpf('.5')+mpf('.2')))*mpf('9.81'))])
O.done()
