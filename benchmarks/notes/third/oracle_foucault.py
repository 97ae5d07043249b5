from orc import *
O=Orc('foucault.tex')
def num(x,s):
    n=len(s.split('.')[1]) if '.' in s else 0; q=mp.nint(x*mpf(10)**n)/mpf(10)**n; return eq(q,mpf(s))
for trial in range(3):
    Om,lam,Re,g=rnd(0.5,2),rnd(0.3,1.2),rnd(1,3),rnd(5,10); s,c=mp.sin(lam),mp.cos(lam)
    al=Jet([rnd(-3,3),Om])   # turn about the inertial axis 3
    ez=A([c*cos(al),c*sin(al),Jet([s])]); ex=A([-sin(al),cos(al),Jet([0])]); ey=cross(ez,ex)
    assert eq(cross(ex,ey),ez)<TOL
    W=A([mpf(0),mpf(0),Om])
    O.rec(1,[eq(W,Om*(c*V(ey)+s*V(ez)))])
    O.rec(2,[eq(V(D(ex)),Om*(s*V(ey)-c*V(ez)))]); O.rec(3,[eq(V(D(ey)),Om*s*V(ex))],[eq(V(D(ey)),-Om*s*V(ex))]); O.rec(4,[eq(V(D(ez)),Om*c*V(ex))])
    X=[rjet() for _ in range(3)]; r=ex*X[0]+ey*X[1]+ez*X[2]; rO=ez*Re
    a=V(D(D(rO+r))); rel=lambda k:sum((V(b)*(X[i].d().at() if k==1 else X[i].d().d().at()) for i,b in enumerate((ex,ey,ez))),A([mpf(0)]*3))
    O.rec(5,[eq(a,V(D(D(rO)))+rel(2)+2*cross(W,rel(1))+cross(W,cross(W,V(r))))]); O.definition(6)
    cv=V(D(D(rO)))+rel(2)+cross(W,cross(W,V(r)))-a   # what the balance leaves for the Coriolis force
    xd,yd,zd=(x.d().at() for x in X); cx,cy,cz=(dot(cv,V(b)) for b in (ex,ey,ez))
    O.rec(7,[eq(cx,2*Om*(yd*s-zd*c))]); O.rec(8,[eq(cy,-2*Om*xd*s)]); O.rec(9,[eq(cz,2*Om*xd*s)],[eq(cz,2*Om*xd*c)])
    cf=-V(D(D(rO))); EY,EZ=V(ey),V(ez)
    assert eq(cf,-cross(W,cross(W,Re*EZ)))<TOL
    O.rec(10,[eq(cf,Om**2*Re*c*(c*EZ+s*EY))],[eq(cf,Om**2*Re*c*(c*EZ-s*EY))])
    # fall: v' = -2 Om x v - g e_z, Taylor series; Omega tiny, so the first order is left
    H=rnd(1,3); t=rnd(0.2,0.5)
    def fall(Oms,t):
        w=A([mpf(0),Oms*c,Oms*s]); v=A([mpf(0)]*3); x=A([mpf(0),mpf(0),H]); tk=mpf(1)
        for k in range(40):
            x=x+v*(t**(k+1)/(k+1)); nv=-2*cross(w,v)
            if k==0: nv=nv-A([mpf(0),mpf(0),g])
            v=nv*(mpf(1)/(k+1))
        return x
    with mp.workdps(120):
        e=mpf(10)**-40; O11=fall(e,t)[0]/e; tg=mp.sqrt(2*H/g); f=fall(e,tg); assert abs(f[2])<mpf(10)**-38; O12=f[0]/e
    O.rec(11,[eq(O11,g*t**3*c/3)]); O.rec(12,[eq(O12,c/3*mp.sqrt(2*H**3/g))],[eq(O12,c/3*mp.sqrt(8*H**3/g))])
    # pendulum: Newton with the force S along the thread, amplitude e -> 0
    l=rnd(1,2); w0=mp.sqrt(g/l); x,y,xd,yd=(rnd() for _ in range(4))
    with mp.workdps(160):
        e=mpf(10)**-50; q=Jet([e*x,e*xd]),Jet([e*y,e*yd])
        zz=sqrt(l*l-q[0]*q[0]-q[1]*q[1]); z0,zd0=-zz.c[0],-zz.c[1]
        w=A([mpf(0),Om*c,Om*s]); pos=A([e*x,e*y,z0]); vel=A([e*xd,e*yd,zd0]); cor=-2*cross(w,vel)
        # pos.acc = -vel.vel ; acc = -S pos/l + cor - g ez (S per unit of mass)
        S=(dot(vel,vel)+dot(pos,cor)-g*z0)/l; ac=-S/l*pos+cor-A([0,0,g])
        ax,ay=ac[0]/e,ac[1]/e
    ax,ay=+ax,+ay
    O.rec(13,[eq(ax,-w0**2*x+2*Om*yd*s)]); O.rec(14,[eq(ay,-w0**2*y-2*Om*xd*s)])
    xj,yj=Jet([x,xd,ax/2]),Jet([y,yd,ay/2]); 
    L=(xj*yj.d()-yj*xj.d()).d().at(); O.rec(15,[eq(L,-Om*s*(x*xd+y*yd))],[eq(L,-2*Om*s*(x*xd+y*yd))])
    O.rec(16,[abs((xj.d()*xj.d()+yj.d()*yj.d()+w0**2*(xj*xj+yj*yj)).d().at())])
    rho2=xj*xj+yj*yj; ph=atan(yj/xj); O.rec(17,[abs((rho2*ph.d()+Om*s*rho2).d().at())])
    # through the lowest point: Taylor series of the linear equations from x=y=0
    X0=[mpf(0)]; Y0=[mpf(0)]; X0.append(rnd()); Y0.append(rnd())
    for k in range(90):
        X0.append((-w0**2*X0[k]+2*Om*s*(k+1)*Y0[k+1])/((k+1)*(k+2))); Y0.append((-w0**2*Y0[k]-2*Om*s*(k+1)*X0[k+1])/((k+1)*(k+2)))
    tt=rnd(0.3,0.6); P=lambda C:mp.fsum(a*tt**i for i,a in enumerate(C)); Dv=lambda C:mp.fsum(i*a*tt**(i-1) for i,a in enumerate(C) if i)
    pd=(P(X0)*Dv(Y0)-P(Y0)*Dv(X0))/(P(X0)**2+P(Y0)**2)
    O.rec(18,[eq(pd,-Om*c)],[eq(pd,-Om*s)]); O.rec(19,[eq(2*mp.pi/abs(pd),2*mp.pi/(Om*s))])
    val=2*mp.pi/(mpf('7.292e-5')*mp.sin(mpf('48.85')*mp.pi/180))/3600
    O.rec(20,[num(val,'36.4')],[num(val,'31.8')])
O.done()
