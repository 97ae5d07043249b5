from orc import *
O=Orc('kepler.md')
for trial in range(3):
    mu,a,e=rnd(1,3),rnd(1,2),rnd(0.2,0.7); b=a*mp.sqrt(1-e*e); n=mp.sqrt(mu/a**3)
    E0=rnd(0.4,2.5)
    # eccentric anomaly as a series in time: E' (1 - e cos E) = n
    EJ=Jet([E0])
    for _ in range(5):
        r=n/(1-e*cos(EJ)); EJ=Jet([E0]+[r.c[i]/(i+1) for i in range(4)])
    z=mpf(0)
    R=A([a*(cos(EJ)-e),b*sin(EJ),Jet([0])]); v=D(R); acc=D(v); rr=sqrt(dot(R,R)); r0=rr.at()
    assert eq(acc,-mu*V(R)/r0**3)<TOL   # the motion obeys Newton's law
    r_d,r_dd=rr.d().at(),rr.d().d().at(); ph=atan(R[1]/R[0]); phd=ph.d().at(); phi=mp.atan2(V(R[1]),V(R[0]))
    hv=V(cross(R,v)); h=norm(hv); En=V(dot(v,v))/2-mu/r0; v2=V(dot(v,v))
    O.definition(1); O.rec(2,[eq(h,r0**2*phd)])
    O.rec(3,[eq(r_dd+r0*phd**2,-mu/r0**2)],[eq(r_dd-r0*phd**2,-mu/r0**2)])
    assert eq(En,(r_d**2+r0**2*phd**2)/2-mu/r0)<TOL; O.definition(4)
    Ve=En-r_d**2/2; O.rec(5,[eq(Ve,h**2/2/r0-mu/r0)],[eq(Ve,h**2/2/r0**2-mu/r0)])
    rad=lambda q:(h/q**2)**2*q-mu/q**2   # radial acceleration at given h
    rc=mp.findroot(rad,h**2/mu*mpf('1.01'),tol=mpf(10)**-90,verify=False); O.rec(6,[eq(rc,h**2/mu)])
    with mp.workdps(120):
        d=mpf(10)**-40; w2=-(rad(rc+d)-rad(rc-d))/(2*d)
    O.rec(7,[eq(w2,2*mu/rc**3)],[eq(w2,mu/rc**3)],[[eq(w2,h**2/rc**4)]])
    p=h**2/mu; rp,ra=a*(1-e),a*(1+e)   # extreme distances of the motion
    rs=[mp.sqrt((a*(mp.cos(x)-e))**2+(b*mp.sin(x))**2) for x in (mpf(0),mp.pi)]; assert eq(rs,[rp,ra])<TOL
    ecc=(ra-rp)/(ra+rp); prm=2*ra*rp/(ra+rp)
    O.rec(8,[eq(r0,prm/(1+ecc*mp.cos(phi)))]); O.rec(9,[eq(prm,h**2/mu)]); O.rec(10,[eq(ecc**2,1+2*En*h**2/mu**2)])
    O.rec(11,[eq((ra+rp)/2,prm/(1-ecc**2))]); O.rec(12,[eq(En,-mu/a)],[eq(En,-mu/2/a)])
    O.rec(13,[eq(v2,mu*(2/r0-1/a))]); sp=mp.sqrt(v2)
    O.rec(14,[eq(sp,h/r0)],under=[eq(h/rp,mp.sqrt(2*(En+mu/rp))),eq(h/ra,mp.sqrt(2*(En+mu/ra)))],general=[eq(v2,r_d**2+h**2/r0**2)])
    vp2=2*(En+mu/rp)
    O.rec(15,[eq(vp2,mu/a*(1-e)/(1+e))],[eq(vp2,mu/a*(1+e)/(1-e))],[[eq(vp2,mu/a*(2/(1-e)-1))]])
    dA=V(R[0]*v[1]-R[1]*v[0])/2
    O.rec(16,[eq(dA,r0**2*phd),eq(r0**2*phd,h)],[eq(dA,r0**2*phd/2),eq(dA,h/2)],[[eq(2*dA,r0**2*phd),eq(2*dA,h)]],bad={0})
    per=mp.quad(lambda x:(1-e*mp.cos(x))/n,[0,mp.pi,2*mp.pi]); O.rec(17,[eq(per**2,4*mp.pi**2*a**3/mu)])
    ev=cross(v,cross(R,v))*(1/mu); ev=A([ev[i]-R[i]/rr for i in range(3)]); O.definition(18)
    O.rec(19,[max(abs(x) for x in V(D(ev)))]); assert eq(norm(V(ev)),e)<TOL and eq(V(ev),A([e,z,z]))<TOL
    er=V(dot(ev,R)); O.rec(20,[eq(er,h**2/mu+r0)],[eq(er,h**2/mu-r0)])
O.done()
