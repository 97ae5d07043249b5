from orc import *
O=Orc('sheet7.md')
b_=lambda t:mpf(0) if t else mpf(1)
def close(a,b,dig): return b_(abs(a-b)<=mpf(10)**(-dig)*mpf('0.5')+mpf(10)**-15)
for trial in range(4):
    g=rnd(8,10)
    # ---- Atwood: unknown a, S1, S2 ; disc inertia by integration
    m2=rnd(1,2); m1=m2+rnd(0.5,1.5); M=rnd(0.5,2); R=rnd(0.2,0.5)
    def atwood(M,m1=m1,m2=m2,g=g,R=R):
        ID=mp.quad(lambda r:r**2*2*mp.pi*r*M/(mp.pi*R**2),[0,R])
        # Lagrange: T = (m1+m2) v^2/2 + ID (v/R)^2/2, potential falls at (m1-m2) g v -> a; then the tensions from the masses
        a=(m1-m2)*g/(m1+m2+ID/R**2); return a,m1*(g-a),m2*(g+a),ID
    a,S1,S2,ID=atwood(M)
    O.rec(1,[eq(m1*g-S1,m1*a),eq(S2-m2*g,m2*a)]); O.rec(2,[eq((S1-S2)*R,ID*a/R)])
    O.rec(3,[eq(a,(m1-m2)*g/(m1+m2+M))],[eq(a,(m1-m2)*g/(m1+m2+M/2))],special=[[eq(atwood(mpf(0))[0],(m1-m2)*g/(m1+m2+0))]])
    an=atwood(mpf(1),mpf(3),mpf(2),mpf('9.81'))[0]
    O.rec(4,[close(an,mpf('9.81')/6,2),close(mpf('9.81')/6,mpf('1.64'),2)],[b_(eq(an,mpf('9.81')/mpf('5.5'))<TOL),close(an,mpf('1.78'),2)],bad={0})
    t=2*m1*m2*g/(m1+m2); a0,T1,T2,_=atwood(mpf(0)); den=m1+m2+M/2
    O.rec(5,[eq(S1,S2),eq(S2,t)],under=[eq(T1,T2),eq(T2,t)],general=[eq(S1,m1*g*(2*m2+M/2)/den),eq(S2,m2*g*(2*m1+M/2)/den)])
    # ---- cylinder
    m,r=rnd(1,2),rnd(0.1,0.4); be=rnd(0.3,1.0); mu_=rnd(0.1,0.3)
    IC=mp.quad(lambda x:x**2*2*mp.pi*x*m/(mp.pi*r**2),[0,r])
    def motion(be,mu):
        """rolling if the force needed is available, else slipping with kinetic friction mu N; returns s'', theta'', f, mode"""
        # moment about the contact line: (IC + m r^2) s''/r = m g r sin(beta)
        sdd=m*g*r*mp.sin(be)/(IC+m*r**2)*r; f=m*g*mp.sin(be)-m*sdd; Nn=m*g*mp.cos(be)
        if f<=mu*Nn: return sdd,sdd/r,f,'roll'
        f=mu*Nn; return g*mp.sin(be)-f/m,f*r/IC,f,'slip'
    for mu in (mpf(5),mpf('0.01')):
        sdd,tdd,f,mode=motion(be,mu); O.rec(6,[eq(m*sdd,m*g*mp.sin(be)-f),eq(IC*tdd,f*r)])
    sdd=motion(be,mpf(5))[0]; O.rec(7,[eq(sdd,g*mp.sin(be)/(1+IC/(m*r**2))),eq(sdd,2*g*mp.sin(be)/3)])
    def claim(be,mu,fn): return m*g*mp.sin(be)/3 if mp.tan(be)<=3*mu else mu*m*g*fn(be)
    mu_s=mp.tan(be)/3*rnd(0.3,0.9); mu_r=mp.tan(be)/3*rnd(1.01,1.5); mu_e=mp.tan(be)/3
    assert motion(be,mu_s)[3]=='slip' and motion(be,mu_r)[3]=='roll'
    rr=eq(motion(be,mu_r)[2],claim(be,mu_r,mp.sin))
    O.rec(8,[rr,eq(motion(be,mu_s)[2],claim(be,mu_s,mp.sin))],[rr,eq(motion(be,mu_s)[2],claim(be,mu_s,mp.cos))],bad={1})
    gn,h=mpf('9.81'),mpf('1.2'); v=mp.findroot(lambda v:m*v**2/2+IC*(v/r)**2/2-m*gn*h,3)
    O.rec(9,[b_(abs(v-mp.sqrt(4*gn*h/3))<mpf(10)**-30),close(mp.sqrt(4*gn*h/3),mpf('3.96'),2)])
    # ---- pendulum: plane cloud of particles, hinged at O
    P=[(rnd(0.5,1),rvec(2)) for _ in range(4)]; mt=sum(p[0] for p in P); c=sum((p[0]*p[1] for p in P[1:]),P[0][0]*P[0][1])/mt
    d=norm(c); ax=c/d; P=[(q,A([dot(x,ax),ax[0]*x[1]-ax[1]*x[0]])) for q,x in P]       # first coordinate along OG
    IO=sum(q*dot(x,x) for q,x in P); cg=A([d,mpf(0)]); IG=sum(q*dot(x-cg,x-cg) for q,x in P)
    O.rec(10,[eq(IO,IG-mt*d**2)],[eq(IO,IG+mt*d**2)])
    ph,w=rnd(0.4,1.2),rnd(0.5,2)
    def pts(phj):   # OG at angle phi from the downward vertical (axes: x right, y up), counter-clockwise positive
        s,k=sin(phj),cos(phj); u=A([s,-k]); n=A([k,s]); return [(q,u*x[0]+n*x[1]) for q,x in P]
    def balance(acc):   # moment about O of inertia minus weight
        Q=pts(Jet([ph,w,acc/2])); t=mpf(0)
        for q,x in Q: a_=V(D(D(x))); x0=V(x); t+=q*(x0[0]*(a_[1]+g)-x0[1]*a_[0])
        return t
    b0,b1=balance(mpf(0)),balance(mpf(1)); acc=-b0/(b1-b0)
    O.rec(11,[eq(IO*acc,-mt*g*d*mp.sin(ph))]); O.definition(12)
    lr=IO/(mt*d); Pl=2*mp.pi*mp.sqrt(lr/g)
    per=lambda am:4*mp.sqrt(IO/(mt*g*d))*mp.quad(lambda u:1/mp.sqrt(1-(mp.sin(am/2)*mp.sin(u))**2),[0,mp.pi/2])
    # independent: time from -am to am by the energy, Gauss-Chebyshev like substitution
    def per2(am):
        k=mp.sin(am/2)
        def F(u):
            x=2*mp.asin(k*mp.sin(u)); dx=2*k*mp.cos(u)/mp.sqrt(1-(k*mp.sin(u))**2); qv=2*mt*g*d*2*k**2*mp.cos(u)**2/IO  # from phid^2 = 2mgd(cos x - cos am)/IO
            return dx/mp.sqrt(qv)
        return 2*mp.quad(F,[-mp.pi/2,0,mp.pi/2])
    am=rnd(0.5,1); assert eq(per(am),per2(am))<mpf(10)**-20 and eq(per(am),4*mp.sqrt(IO/(mt*g*d))*mp.ellipk(mp.sin(am/2)**2))<mpf(10)**-20
    e1,e2=abs(per(mpf('1e-3'))/Pl-1),abs(per(mpf('1e-4'))/Pl-1); assert abs(e1/e2-100)<1
    O.rec(13,[eq(mp.sqrt(lr/g),mp.sqrt(IO/(mt*g*d))),eq(per(am),Pl)],under=[mpf(0)],general=[mpf(0)],bad={1})
    Irod=mp.quad(lambda s:s**2,[0,1]); Pn=2*mp.pi*mp.sqrt(Irod/(mpf('0.5')*gn)); assert abs(Pn-2*mp.pi*mp.sqrt(2/(3*gn)))<mpf(10)**-30
    O.rec(14,[mpf(0),close(Pn,mpf('0.43'),2)],[mpf(0),close(Pn,mpf('1.64'),2)],bad={1})
    Q=pts(Jet([ph,w,acc/2])); F=A([mpf(0)]*2)
    for q,x in Q: F=F+q*(V(D(D(x)))+A([0,g]))
    Ft=dot(F,A([mp.cos(ph),mp.sin(ph)])); k=mt*d**2/IO
    O.rec(15,[eq(Ft,mt*g*mp.sin(ph)*(1+k))],[eq(Ft,mt*g*mp.sin(ph)*(1-k))],[[eq(Ft,mt*g*mp.sin(ph)*IG/IO)]])
    # ---- blow
    m,M,L=rnd(0.5,1),rnd(1,2),rnd(1,2); b=rnd(0.1,0.5)*L; IG=mp.quad(lambda s:s**2*M/L,[-L/2,L/2]); v0=rnd(2,4); e=rnd(0.2,0.8)
    def hit(e,b=b):
        """puck and rod as free bodies under the impulse J at P: J from the law of restitution by a linear solve"""
        f=lambda J:(v0-J/m,J/M,b*J/IG)          # v1, u, omega
        g_=lambda J:(f(J)[1]+b*f(J)[2]-f(J)[0])-e*v0
        J=-g_(mpf(0))/(g_(mpf(1))-g_(mpf(0))); return (J,)+f(J)
    J,v1,u,om=hit(e)
    # vector form: rod along x, v0 along y, P at (b,0)
    ey,bx,ez=A([0,mpf(1),0]),A([b,0,0]),A([0,0,mpf(1)])
    # ey at (b,0): omega x b = om*b ey: moves along with v0
    assert eq(cross(ez*om,bx),ey*(om*b))<TOL
    O.definition(16); O.definition(18)
    O.rec(17,[eq(m*v0*ey,m*v1*ey+M*u*ey),eq(cross(bx,m*v0*ey),cross(bx,m*v1*ey)+IG*om*ez)])
    O.rec(19,[eq(J,(1+e)*v0/(1/m+1/M))],[eq(J,(1+e)*v0/(1/m+1/M+b**2/IG))],special=[[eq(hit(e,mpf(0))[0],(1+e)*v0/(1/m+1/M))]])
    En=lambda v1,u,om:m*v1**2/2+M*u**2/2+IG*om**2/2
    T0=m*v0**2/2; T1=En(v1,u,om); K=2*(1/m+1/M+b**2/IG)
    O.rec(20,[eq(T0-T1,(1-e)**2*v0**2/K)],[eq(T0-T1,(1-e**2)*v0**2/K)],special=[[eq(T0-En(*hit(mpf(0))[1:]),v0**2/K)],[abs(T0-En(*hit(mpf(1))[1:]))]])
    xR=IG/(M*b); assert abs(u-om*xR)<mpf(10)**-40
    O.rec(21,[abs(u-om*IG/(M*b)),eq(IG/(M*b),L**2/(12*b))])
    O.rec(22,[eq(T0,T1)],under=[eq(T0,En(*hit(mpf(1))[1:]))],alts=[[eq(T0,En(*hit(mpf(-1))[1:]))]],general=[eq(T0,T1+(1-e**2)*v0**2/K)])
    # ---- tube
    Ri=rnd(0.2,0.5); Ra=Ri+rnd(0.1,0.4); rho,ht=rnd(1,3),rnd(0.5,1); Mt=rho*mp.pi*(Ra**2-Ri**2)*ht
    # inertia by a double integral in Cartesian-like form (polar, x^2+y^2) as a check of the first integral
    I=mp.quad(lambda r:mp.quad(lambda p:((r*mp.cos(p))**2+(r*mp.sin(p))**2)*rho*ht*r,[0,2*mp.pi]),[Ri,Ra]); I1=mp.quad(lambda r:r**2*2*mp.pi*rho*ht*r,[Ri,Ra])
    O.rec(23,[eq(I,I1),eq(I1,mp.pi*rho*ht*(Ra**4-Ri**4)/2),eq(I,Mt*(Ra**2-Ri**2)/2)],[eq(I,I1),eq(I1,mp.pi*rho*ht*(Ra**4-Ri**4)/2),eq(I,Mt*(Ra**2+Ri**2)/2)],bad={2})
O.done()
