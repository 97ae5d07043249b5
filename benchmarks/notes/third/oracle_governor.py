from orc import *
O=Orc('governor.md')
for trial in range(3):
    m,M,l,g=rnd(1,2),rnd(1,4),rnd(0.5,1.5),rnd(5,10); om=mp.sqrt((m+M)*g/(m*l))*rnd(1.1,1.6)
    def bodies(ph,ps):
        out=[]
        for sg in (1,-1): out.append((m,A([sg*l*sin(ph)*cos(ps),sg*l*sin(ph)*sin(ps),-l*cos(ph)])))
        # sleeve: below the balls by the vertical leg of an arm of length l whose horizontal leg is the radius
        rad=l*sin(ph); out.append((M,A([0*ph,0*ph,-l*cos(ph)-sqrt(l*l-rad*rad)])))
        return out
    def resid(p0,pd,c):
        """virtual work of inertia and weight for a change of phi at held turn angle"""
        ph=Jet([p0,pd,c/2]); ps=Jet([mpf('0.3'),om]); t=mpf(0)
        dj=Jet([p0,1]); dB=bodies(dj,Jet([mpf('0.3')]))
        for (mm,r),(_,rv) in zip(bodies(ph,ps),dB):
            t+=mm*dot(V(D(D(r)))+A([0,0,g]),V(D(rv)))
        return t
    def acc(p0,pd): r0,r1=resid(p0,pd,mpf(0)),resid(p0,pd,mpf(1)); return -r0/(r1-r0)
    p0,pd=rnd(0.4,1.2),rnd(0.5,1.5); s,c=mp.sin(p0),mp.cos(p0); pdd=acc(p0,pd)
    ph=Jet([p0,pd,pdd/2]); ps=Jet([rnd(),om]); B=bodies(ph,ps)
    T=sum(dot(D(r),D(r))*(mm/2) for mm,r in B); Vp=sum(r[2]*(mm*g) for mm,r in B)
    O.rec(1,[eq(norm(V(B[0][1])[:2]),l*s),eq(-V(B[0][1][2]),l*c)])
    O.rec(2,[eq(-B[2][1][2].d().at(),-2*l*pd*s)])
    O.rec(3,[eq(T,m*l**2*(pd**2+om**2*s**2)+2*M*l**2*pd**2*s**2)])
    O.rec(4,[eq(Vp,-(2*m+M)*g*l*c)],[eq(Vp,-(2*m+2*M)*g*l*c)],[[eq(Vp,-2*(m+M)*g*l*c)]])
    def Tn(x): q=bodies(Jet([p0,x]),Jet([mpf(0),om])); return V(sum(dot(D(r),D(r))*(mm/2) for mm,r in q))
    pphi=(Tn(mpf(1))-Tn(mpf(-1)))/2*pd   # quadratic in the rate: slope is exact
    pphi=((Tn(pd+1)-Tn(pd-1))/2); O.rec(5,[eq(pphi,(2*m+4*M*s**2)*l**2*pd)])
    rhs=2*m*l**2*om**2*s*c-2*(m+M)*g*l*s; lh=lambda f:(2*m+4*M*s**2)*l**2*pdd+f*M*l**2*pd**2*s*c
    O.rec(6,[eq(lh(8),rhs)],[eq(lh(4),rhs)]); O.definition(7)
    K=m*l**2*ph.d()*ph.d()+2*M*l**2*ph.d()*ph.d()*sin(ph)**2-m*l**2*om**2*sin(ph)**2-2*(m+M)*g*l*cos(ph)
    O.rec(8,[abs(K.d().at())])
    f=lambda x:acc(x,mpf(0))
    x0=mp.findroot(f,mp.acos((m+M)*g/(m*l*om**2))*mpf('1.01'),tol=mpf(10)**-90,verify=False)
    O.rec(9,[eq(mp.cos(x0),(m+M)*g/(m*l*om**2))]); s,c=mp.sin(x0),mp.cos(x0)
    O.rec(10,[eq(l*c,(1+m/M)*g/om**2)],[eq(l*c,(1+M/m)*g/om**2)])
    # sensitivity: implicit derivative of acc(phi0, omega) = 0 by central differences at high precision
    with mp.workdps(140):
        d=mpf(10)**-40; x1=mp.findroot(f,x0,tol=mpf(10)**-250,verify=False); om0=om
        fx=(f(x1+d)-f(x1-d))/(2*d); om=om0+d; up=f(x1); om=om0-d; dn=f(x1); om=om0; fo=(up-dn)/(2*d); sens=-fo/fx; slope=-fx
    O.rec(11,[eq(sens,2/om*mp.tan(x0))],[eq(sens,2/om*mp.cot(x0))],[[eq(sens,2/om*c/s)]])
    # arm forces: sleeve and ball, along the arms
    q=bodies(Jet([x0]),Jet([mpf(0),om])); rb=V(q[0][1]); rs=V(q[2][1]); ab=V(D(D(q[0][1])))
    up1=-rb/norm(rb); dn=(rs-rb)/norm(rs-rb)
    # ball: m a = S1 up1 + S2 dn - m g ez (x and z)
    x=solve(A([[up1[0],dn[0]],[up1[2],dn[2]]]),A([m*ab[0],m*ab[2]+m*g])); S1,S2=x
    assert abs(-2*S2*dn[2]-M*g)<mpf(10)**-38   # sleeve in balance
    O.rec(12,[eq(S2,M*g/2/c)]); O.rec(13,[eq(S1,(m+M)*g/2/c)],[eq(S1,(2*m+M)*g/2/c)]); O.rec(14,[eq(S1+S2,m*l*om**2)])
    O.rec(15,[eq(slope,m*om**2*s**2/(m+2*M*s**2))])
    s,c=mp.sin(p0),mp.cos(p0)
    Dm=sum((r[0]*D(r)[1]-r[1]*D(r)[0])*mm for mm,r in B).d().at()
    O.rec(16,[eq(Dm,2*m*l**2*om*pd*s*c)],[eq(Dm,4*m*l**2*om*pd*s*c)],[[eq(Dm,2*m*l**2*om*pd*mp.sin(2*p0))]])
    O.rec(17,[eq((T+Vp).d().at(),4*m*l**2*om**2*pd*s*c)])
O.done()
