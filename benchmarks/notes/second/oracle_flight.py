from orc import *
O=Orc('flight.tex')
X,Y,Z=[A([mpf(int(i==k)) for i in range(3)]) for k in range(3)]
def frame(psi,th,ph):
    """body axes in Earth components: yaw about down, pitch about the new y, roll about the new x (active turns of the triad)"""
    def turn(tri,k,x):
        n=tri[k]; s,c=sin(x),cos(x)
        out=[]
        for v in tri:
            par=n*dot(n,v); per=v-par; out.append(par+per*c+cross(n,per)*s)
        return out
    tri=[X*(Jet([1])),Y*(Jet([1])),Z*(Jet([1]))]
    tri=turn(tri,2,psi); tri=turn(tri,1,th); tri=turn(tri,0,ph)
    return A([list(t) for t in tri])      # rows: body axes -> takes Earth components into body components
def rates(C):
    W=-(D(C)@C.T)   # skew of omega in body components
    return A([W[2,1],W[0,2],W[1,0]])
def R1(x): s,c=mp.sin(x),mp.cos(x); return A([[1,0,0],[0,c,s],[0,-s,c]])
def R2(x): s,c=mp.sin(x),mp.cos(x); return A([[c,0,-s],[0,1,0],[s,0,c]])
def R3(x): s,c=mp.sin(x),mp.cos(x); return A([[c,s,0],[-s,c,0],[0,0,1]])
# elementary matrices are passive turns of the axes: check against frame()
for k,(Rk,args) in enumerate([(R1,(0,0,1)),(R2,(0,1,0)),(R3,(1,0,0))]):
    x=mpf('0.37'); assert eq(V(frame(*[Jet([x*a]) for a in args])),Rk(x))<TOL
def cloud(n=5):
    """particles symmetric about the plane xz, centred"""
    P=[]
    for _ in range(n):
        q=rvec(3,-2,2); mm=rnd(0.5,2); P+=[(mm,q),(mm,A([q[0],-q[1],q[2]]))]
    mt=sum(p[0] for p in P); c=sum((p[0]*p[1] for p in P[1:]),P[0][0]*P[0][1])/mt
    return [(mm,q-c) for mm,q in P],mt
for trial in range(4):
    psi,th,ph=Jet([rnd(-3,3)]+[rnd() for _ in range(4)]),Jet([rnd(0.2,1.2)]+[rnd() for _ in range(4)]),Jet([rnd(0.2,1.2)]+[rnd() for _ in range(4)])
    C=frame(psi,th,ph); w=rates(C); p,q,r=[x.at() for x in w]; C0=V(C)
    ps,t0,f0=psi.at(),th.at(),ph.at(); psd,td,fd=psi.c[1],th.c[1],ph.c[1]
    sf,cf,st,ct=mp.sin(f0),mp.cos(f0),mp.sin(t0),mp.cos(t0); sp,cp=mp.sin(ps),mp.cos(ps)
    g=rnd(5,12); m=rnd(1,3)
    O.definition(1)
    sB=lambda a,b,c:V(frame(Jet([a]),Jet([b]),Jet([c])))
    O.rec(2,[eq(C0,R3(ps)@R2(t0)@R1(f0))],[eq(C0,R1(f0)@R2(t0)@R3(ps))],special=[[eq(sB(0,t0,0),R3(0)@R2(t0)@R1(0))]])
    O.rec(3,[eq(C0,A([[ct*cp,ct*sp,-st],[sf*st*cp-cf*sp,sf*st*sp+cf*cp,sf*ct],[cf*st*cp+sf*sp,cf*st*sp-sf*cp,cf*ct]]))])
    O.rec(4,[eq(p,fd-psd*ct),eq(q,td*cf+psd*ct*sf),eq(r,psd*ct*cf-td*sf)],[eq(p,fd-psd*st),eq(q,td*cf+psd*ct*sf),eq(r,psd*ct*cf-td*sf)],bad={0})
    O.rec(5,[eq(fd,p+(q*sf+r*cf)*mp.tan(t0)),eq(td,q*cf-r*sf),eq(psd,(q*sf+r*cf)/ct)])
    # 6 with phi = theta = 0 at the instant
    w6=V(rates(frame(psi,Jet([0]+th.c[1:]),Jet([0]+ph.c[1:])))); 
    O.rec(6,[eq(psd,r)],under=[eq(psd,w6[2])],general=[eq(psd,(q*sf+r*cf)/ct)])
    # translation: Earth position as jets
    xE=A([rjet() for _ in range(3)]); vE=D(xE); aE=D(vE); vb=C@vE; u,v,wv=V(vb); Vb=D(vb); ud,vd,wd=V(Vb)
    uvw=A([u,v,wv])
    O.rec(7,[eq(V(vE),C0@uvw)],[eq(V(vE),C0.T@uvw)],[[eq(V(vE),inv(C0)@uvw)]])
    O.rec(8,[eq(-V(vE)[2],u*st-v*sf*ct-wv*cf*ct)])
    F=V(C@(m*(aE-A([0,0,g]))))     # resultant without weight, body components
    gb=C0@A([0,0,g])
    O.rec(9,[eq(m*V(Vb)+m*cross(V(w),uvw),F+m*gb)])
    x=[F[0]-m*g*st,F[1]+m*g*ct*sf,F[2]+m*g*ct*cf]
    good=[eq(x[0],m*(ud+q*wv-r*v)),eq(x[1],m*(vd+r*u-p*wv)),eq(x[2],m*(wd+p*v-q*u))]
    O.rec(10,[good[0],eq(x[1],m*(vd+r*u+p*wv)),good[2]],good,bad={1})
    O.definition(11)
    # 12, 13 with u > 0
    uj,vj,wj=Jet([rnd(1,3)]+[rnd() for _ in range(4)]),rjet(),rjet(); Vj=sqrt(uj*uj+vj*vj+wj*wj)
    al=atan(wj/uj); be=mp.asin(vj.at()/Vj.at()); V0=Vj.at()
    O.rec(12,[eq(uj.at(),V0*mp.cos(al.at())*mp.cos(be)),eq(vj.at(),V0*mp.sin(be)),eq(wj.at(),V0*mp.sin(al.at())*mp.cos(be))])
    num=uj.at()*wj.c[1]-wj.at()*uj.c[1]
    O.rec(13,[eq(al.c[1],num/V0**2)],[eq(al.c[1],num/(uj.at()**2+wj.at()**2))],[[eq(al.c[1],num/(V0**2*mp.cos(be)**2))]])
    O.definition(14)
    # particles
    P,mt=cloud(); Ix=sum(mm*(s[1]**2+s[2]**2) for mm,s in P); Iy=sum(mm*(s[0]**2+s[2]**2) for mm,s in P); Iz=sum(mm*(s[0]**2+s[1]**2) for mm,s in P); Ixz=sum(mm*s[0]*s[2] for mm,s in P)
    Ct=C.T
    def HE(C):
        h=A([Jet([0])]*3)
        for mm,s in P:
            rr=C.T@s; h=h+mm*cross(rr,D(rr))
        return h
    h=HE(C); hb=V(C@h)
    O.rec(15,[eq(hb,A([Ix*p-Ixz*r,Iy*q,Iz*r-Ixz*p]))])
    Mb=V(C@D(h)); pd,qd,rd=V(D(w))
    Lm,Mm,Nm=Mb
    gd=[eq(Lm,Ix*pd-Ixz*rd+q*r*(Iz-Iy)-Ixz*p*q),eq(Mm,Iy*qd+r*p*(Ix-Iz)+Ixz*(p**2-r**2)),eq(Nm,Iz*rd-Ixz*pd+p*q*(Iy-Ix)+Ixz*q*r)]
    O.rec(16,[gd[0],eq(Mm,Iy*qd+r*p*(Ix-Iz)+Ixz*(r**2-p**2)),gd[2]],gd,bad={1})
    # 17: with q = 0 at the instant: choose theta' so that q = 0
    td6=-psd*ct*sf/cf; th6=Jet([t0,td6]+th.c[2:]); C6=frame(psi,th6,ph); w6=rates(C6); assert abs(w6[1].at())<TOL
    M6=V(C6@D(HE(C6))); den=Ix*Iz-Ixz**2
    O.rec(17,[eq(pd,(Iz*Lm+Ixz*Nm)/den)],under=[eq(w6[0].c[1],(Iz*M6[0]+Ixz*M6[2])/den)],
      general=[eq(pd,(Iz*(Lm-q*r*(Iz-Iy)+Ixz*p*q)+Ixz*(Nm-p*q*(Iy-Ix)-Ixz*q*r))/den)])
    T=mpf(0)
    for mm,s in P:
        vv=V(D(C.T@s))+V(vE); T+=mm*dot(vv,vv)/2
    V2=dot(uvw,uvw)
    base=mt*V2/2+(Ix*p**2+Iy*q**2+Iz*r**2)/2
    O.rec(18,[eq(T,base-Ixz*p*r/2)],[eq(T,base-Ixz*p*r)])
    # 19, 21: steady level coordinated turn
    def turn(t0,f0,V0):
        """v = 0, body velocity constant and horizontal, speed V0; find psi' with Y = 0; returns psi', Z"""
        ct,st,cf,sf=mp.cos(t0),mp.sin(t0),mp.cos(f0),mp.sin(f0)
        C=V(frame(Jet([ps]),Jet([t0]),Jet([f0])))
        k=A([C[0,2],C[1,2],C[2,2]])                         # down in body components
        d=unit(A([k[2],mpf(0),-k[0]]))                      # in the plane xz and horizontal
        if d[0]<0: d=-d
        vel=V0*d
        def Fb(psd):
            om=psd*k; return m*cross(om,vel)-m*g*k          # force without weight
        y0,y1=Fb(mpf(0))[1],Fb(mpf(1))[1]; psd=-y0/(y1-y0)
        Cj=frame(Jet([ps,psd]),Jet([t0]),Jet([f0])); vE=Cj.T@vel; assert abs(V(vE)[2])<TOL
        a=V(D(vE)); F=V(Cj)@(m*(a-A([0,0,g]))); assert abs(F[1])<TOL*100 and eq(F,Fb(psd))<TOL
        return psd,F[2]
    V0=rnd(20,60)
    pa,Za=turn(t0,f0,V0); pb,Zb=turn(mpf(0),f0,V0)
    O.rec(19,[eq(mp.tan(f0),V0*pa/g)],under=[eq(mp.tan(f0),V0*pb/g)],general=[eq(ct*sf,V0*pa/g*mp.sqrt(1-ct**2*sf**2))])
    n=-Zb/(m*g); O.rec(21,[eq(n,cf+V0*pb/g*sf),eq(n,1/cf)])
    # 20 worked example
    pe=mpf('9.81')*mp.tan(mp.pi/6)/60; deg=pe*180/mp.pi
    rd=lambda a,b,t:mpf(0) if abs(a-b)<=t else mpf(1)
    p1=[rd(mpf('9.81')*mpf('0.577')/60,pe,mpf('1e-4')),rd(pe,mpf('0.0944'),mpf('0.00005')+mpf('1e-9'))]
    O.rec(20,p1+[rd(deg,mpf('9.44'),mpf('0.005'))],p1+[rd(deg,mpf('5.41'),mpf('0.005'))],bad={2})
O.done()
