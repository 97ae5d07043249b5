from orc import *
O=Orc('hoop.md')
def model(free=False,Om=None,th=None,thd=None):
    M=dict(m=rnd(1,3),R=rnd(1,2),g=rnd(5,10),Om=rnd(1,4) if Om is None else Om,Mh=rnd(1,3))
    return M
def kin(M,th,ph):
    R=M['R']; return A([R*sin(th)*cos(ph),R*sin(th)*sin(ph),-R*cos(th)])
def basis(th,ph):
    er=A([sin(th)*cos(ph),sin(th)*sin(ph),-cos(th)])       # from the centre to the bead
    et=A([cos(th)*cos(ph),cos(th)*sin(ph),sin(th)])
    ep=A([-sin(ph),cos(ph),0*th])                           # sense of growing azimuth
    return er,et,ep
def driven(M,th0,thd0,ph0):
    """theta'' from Newton's law along the tangent of the hoop (no friction)"""
    g=M['g']; m=M['m']
    def resid(c):
        th=Jet([th0,thd0,c/2]); ph=Jet([ph0,M['Om']])
        r=kin(M,th,ph); a=V(D(D(r))); er,et,ep=basis(th0,ph0)
        return dot(a+A([0,0,g]),et)
    r0,r1=resid(mpf(0)),resid(mpf(1)); return -r0/(r1-r0)
for trial in range(4):
    M=model(); m,R,g,Om,Mh=(M[k] for k in('m','R','g','Om','Mh'))
    th0,thd0,ph0=rnd(0.3,1.2),rnd(0.5,2),rnd(-3,3)
    s,c=mp.sin(th0),mp.cos(th0)
    thdd=driven(M,th0,thd0,ph0)
    th=Jet([th0,thd0,thdd/2]); ph=Jet([ph0,Om])
    r=kin(M,th,ph); v=D(r)
    # 1: position built by turning: from the lowest point, rotate by theta about the horizontal normal, then by phi about the vertical
    low=A([mpf(0),mpf(0),-R]); p=rot_about([mpf(0),mpf(-1),mpf(0)],th0)(low); p=rot_about([mpf(0),mpf(0),mpf(1)],ph0)(p)
    O.rec(1,[eq(p,R*A([s*mp.cos(ph0),s*mp.sin(ph0),-c]))])
    v2=V(dot(v,v)); O.rec(2,[eq(v2,R**2*thd0**2+R**2*Om**2*s**2)])
    Tk=dot(v,v)*(m/2); Vp=m*g*r[2]; L=V(Tk-Vp)
    Lf=lambda x,xd: m*R**2/2*(xd**2+Om**2*mp.sin(x)**2)+m*g*R*mp.cos(x)
    O.rec(3,[eq(L,Lf(th0,thd0))])
    def Lnum(x,xd):   # from the positions
        rr=kin(M,Jet([x,xd]),Jet([ph0,Om])); vv=V(D(rr)); return m/2*dot(vv,vv)-m*g*V(rr[2])
    ptheta=mp.diff(lambda xd:Lnum(th0,xd),thd0); O.definition(4)
    dLdth=mp.diff(lambda x:Lnum(x,thd0),th0)
    ddt=m*R**2*thdd   # d/dt of dL/dthetadot: check against the true momentum along the trajectory
    pj=[mp.diff(lambda xd:Lnum(th.c[0]+thd0*tt+thdd/2*tt**2,xd),thd0+thdd*tt) for tt in (mpf(10)**-12,-mpf(10)**-12)]
    assert abs((pj[0]-pj[1])/(2*mpf(10)**-12)-ddt)<mpf(10)**-8
    r30=lambda x:mp.mpf(x) if abs(x)>mpf(10)**-25 else mpf(0)   # mp.diff is good to about 1e-30
    O.rec(5,[eq(ddt,m*R**2*thdd),r30(eq(dLdth,m*R**2*Om**2*s*c+m*g*R*s))],[r30(eq(dLdth,m*R**2*Om**2*s*c-m*g*R*s))],bad={1})
    O.rec(6,[eq(thdd,(Om**2*c-g/R)*s)]); O.definition(7)
    f=lambda x:driven(M,x,mpf(0),ph0)
    # 8
    Mf=dict(M); Oc=mp.sqrt(g/R); Mf['Om']=Oc*rnd(1.2,2); ff=lambda x:driven(Mf,x,mpf(0),ph0); Of=Mf['Om']
    zeros=lambda h:sum(1 for i in range(200) if h(mpf('0.0077')+mpf(i)*mpf('0.0156'))*h(mpf('0.0077')+mpf(i+1)*mpf('0.0156'))<0)
    assert zeros(ff)==1
    Ms=dict(M); Ms['Om']=Oc*rnd(0.3,0.8); assert zeros(lambda x:driven(Ms,x,mpf(0),ph0))==0
    for h in (ff,lambda x:driven(Ms,x,mpf(0),ph0)): assert abs(h(mpf(0)))<TOL and abs(h(mp.pi))<TOL
    ts=mp.acos(g/(R*Of**2)); arg=g/(R*Of)
    wr=abs(ff(mp.acos(arg))) if abs(arg)<=1 else mpf(1)
    O.rec(8,[mpf(0),wr],[abs(ff(ts))],[[abs(ff(mp.acos(Oc**2/Of**2)))]],bad={1})
    # 9, 10
    # stiffness from the slope of Newton's equation: exact through a jet in the angle
    def slope(Mx,x0):
        h=mpf(10)**-16; # symmetric difference with 50 digits, error about h^2
        return -(driven(Mx,x0+h,mpf(0),ph0)-driven(Mx,x0-h,mpf(0),ph0))/(2*h)
    O.rec(9,[max(eq(slope(Ms,mpf(0)),g/R-Ms['Om']**2)-mpf(10)**-29,0)])
    w2=slope(Mf,ts); tr=lambda x:max(x-mpf(10)**-28,mpf(0))
    O.rec(10,[tr(eq(w2,Of**2*mp.sin(ts)**2)),tr(eq(Of**2*mp.sin(ts)**2,Of**2-g/R))],[tr(eq(w2,Of**2*mp.sin(ts)**2)),tr(eq(Of**2*mp.sin(ts)**2,Of**2-g**2/(R**2*Of**2)))],bad={1})
    # 11: period by quadrature of the exact motion
    Os=Ms['Om']
    def period(am):   # with sin(theta/2) = k sin(u)
        k=mp.sin(am/2)
        # Jacobi integral: thd^2 = Os^2 (sin^2 th - sin^2 am) + 2 g/R (cos th - cos am)
        def F(u):
            x=2*mp.asin(k*mp.sin(u)); dx=2*k*mp.cos(u)/mp.sqrt(1-(k*mp.sin(u))**2)
            # cos x - cos am = 2k^2 cos^2 u ; sin^2 x - sin^2 am = (cos am - cos x)(cos am + cos x)
            q=2*k**2*mp.cos(u)**2*(2*g/R-Os**2*(mp.cos(am)+mp.cos(x)))
            return dx/mp.sqrt(q) if mp.cos(u)!=0 else mpf(0)
        return 2*mp.quad(F,[-mp.pi/2,0,mp.pi/2])
    Pl=2*mp.pi/mp.sqrt(g/R-Os**2)
    with mp.workdps(30):
        e1,e2,e3=(abs(period(a)/Pl-1) for a in (mpf('0.5'),mpf('0.001'),mpf('0.0001')))
        assert e3<mpf('1e-6') and mpf(90)<e2/e3<mpf(110)
        # general form against the Newton equation, integrated by a Runge-Kutta run (rough)
        am=mpf('0.5'); P=period(am); n=400; h=P/n; x,w=am,mpf(0)
        FF=lambda x:(Os**2*mp.cos(x)-g/R)*mp.sin(x)
        for _ in range(n):
            k1=(w,FF(x));k2=(w+h/2*k1[1],FF(x+h/2*k1[0]));k3=(w+h/2*k2[1],FF(x+h/2*k2[0]));k4=(w+h*k3[1],FF(x+h*k3[0]))
            x+=h/6*(k1[0]+2*k2[0]+2*k3[0]+k4[0]); w+=h/6*(k1[1]+2*k2[1]+2*k3[1]+k4[1])
        assert abs(x-am)<mpf('1e-5') and abs(w)<mpf('1e-4'),(x,w)
    O.rec(11,[e1],under=[mpf(0)],general=[mpf(0)])
    # 12..14
    h=thd0*ptheta-L
    O.rec(12,[r30(eq(h,thd0*ptheta-L)),r30(eq(h,m*R**2*thd0**2/2+m*R**2*Om**2*s**2/2-m*g*R*c))],[r30(eq(h,m*R**2*thd0**2/2-m*R**2*Om**2*s**2/2-m*g*R*c))],bad={1})
    O.rec(13,[eq((Tk+Vp).d(),2*m*R**2*Om**2*thd0*s*c)])
    Lz=m*(r[0]*v[1]-r[1]*v[0]); tz=Lz.d().at()
    O.rec(14,[eq(tz,m*R**2*Om*thd0*s*c)],[eq(tz,2*m*R**2*Om*thd0*s*c)],[[eq(tz,m*R**2*Om*thd0*mp.sin(2*th0))]])
    assert abs((Tk+Vp).d().at()-tz*Om)<TOL*100
    Fc=m*(V(D(v))+A([0,0,g])); er,et,ep=basis(th0,ph0); N=-dot(Fc,er)
    assert abs(dot(Fc,et))<mpf(10)**-40
    O.rec(15,[eq(N,m*g*c+m*R*thd0**2)],[eq(N,m*g*c+m*R*thd0**2+m*R*Om**2*s**2)],[[eq(N,m*g*c+m*R*(thd0**2+Om**2*s**2))]])
    O.rec(16,[eq(dot(Fc,ep),2*m*R*Om*thd0*c)])
    # 17..20 free hoop
    Ih=mp.quad(lambda a:Mh/(2*mp.pi)*(R*mp.sin(a))**2,[0,mp.pi,2*mp.pi])
    O.rec(17,[eq(Ih,Mh*R**2)],[eq(Ih,Mh*R**2/2)])
    phd0=rnd(1,3)
    def free(tau):
        # unknown theta'', phi'': tangent equation of the bead and vertical angular momentum of hoop and bead
        def res(c1,c2):
            tj=Jet([th0,thd0,c1/2]); pj=Jet([ph0,phd0,c2/2]); rr=kin(M,tj,pj); vv=D(rr); aa=V(D(vv))
            Lz=(m*(rr[0]*vv[1]-rr[1]*vv[0])+Ih*pj.d()).d().at()
            return A([dot(aa+A([0,0,g]),et),Lz-tau])
        b=res(mpf(0),mpf(0)); c1=res(mpf(1),mpf(0))-b; c2=res(mpf(0),mpf(1))-b
        return solve(A([[c1[0],c2[0]],[c1[1],c2[1]]]),-b)
    for tau in (rnd(1,2),):
        out={}
        for tt in (tau,mpf(0)):
            x=free(tt); tj=Jet([th0,thd0,x[0]/2]); pj=Jet([ph0,phd0,x[1]/2]); rr=kin(M,tj,pj); vv=D(rr)
            Lz=m*(rr[0]*vv[1]-rr[1]*vv[0])+Ih*pj.d(); out[tt]=(x,tj,pj,rr,vv,Lz)
        def pphi(tj,pj): return (Ih+m*R**2*sin(tj)**2)*pj.d()
        W=out[tau]; Z=out[mpf(0)]
        O.rec(18,[eq(W[5],pphi(W[1],W[2])),abs(W[5].d().at())],under=[eq(Z[5],pphi(Z[1],Z[2])),abs(Z[5].d().at())],general=[eq(W[5],pphi(W[1],W[2])),eq(W[5].d().at(),tau)],bad={1})
        x,tj,pj,rr,vv,Lz=W; pp=Lz.at(); pt=m*R**2*thd0
        E=V(dot(vv,vv))*m/2+Ih*phd0**2/2+m*g*V(rr[2])
        Hf=lambda q:pt**2/(2*m*R**2)+pp**2/(2*(Ih+m*R**2*mp.sin(q)**2))-m*g*R*mp.cos(q)
        O.rec(19,[eq(E,Hf(th0))])
        pd=m*R**2*x[0]; dH=-mp.diff(Hf,th0)
        O.rec(20,[r30(eq(pd,dH)),eq(pd,m*R**2*pp**2*s*c/(Ih+m*R**2*s**2)-m*g*R*s)],[r30(eq(pd,dH)),eq(pd,m*R**2*pp**2*s*c/(Ih+m*R**2*s**2)**2-m*g*R*s)],bad={1})
O.done()
