from orc import *
O=Orc('wheels.md')
def rotm(a,b,c):
    """attitude (inertial into hub) from three jets, 3-1-3 turns; only used as a generator of smooth rotations"""
    def z(x): s,k=sincos(x); return A([[k,s,0*s],[-s,k,0*s],[0*s,0*s,1+0*s]])
    def x_(x): s,k=sincos(x); return A([[1+0*s,0*s,0*s],[0*s,k,s],[0*s,-s,k]])
    return z(c)@x_(b)@z(a)
def spd(n=3): 
    B=A([[rnd() for _ in range(n)] for _ in range(n)]); return B@B.T+eye(n)
def om_of(C):
    W=-(D(C)@C.T); return A([W[2,1],W[0,2],W[1,0]])
def quat(C):
    """scalar and vector part as jets from the geometric meaning: eta = cos(angle/2), epsilon = axis sin(angle/2), rotation that carries inertial axes into hub axes"""
    # active rotation Q (columns: hub axes in inertial components) = C^T
    Q=C.T; tr=Q[0,0]+Q[1,1]+Q[2,2]
    c=(tr-1)/mpf(2)                                   # cos(angle)
    ch=sqrt((1+c)/mpf(2)); sh=sqrt((1-c)/mpf(2))       # half angle, angle in (0, pi)
    ax=A([Q[2,1]-Q[1,2],Q[0,2]-Q[2,0],Q[1,0]-Q[0,1]]); n=sqrt(dot(ax,ax))
    return ch,A([x/n*sh for x in ax])
class Sat:
    """hub and wheels as separate bodies with masses and places"""
    def __init__(s,axes,Jw):
        s.ax=[unit(a) for a in axes]; s.n=len(s.ax); s.Jw=Jw
        s.It=rnd(0.3,0.6)*Jw*2; s.mw=rnd(0.5,1)
        s.pos=[rvec() for _ in s.ax]; s.mh=rnd(3,6)
        s.hubpos=-sum((s.mw*p for p in s.pos[1:]),s.mw*s.pos[0])/s.mh    # system centre at the origin
        s.Jh=spd()*4
        par=lambda m,p:m*(dot(p,p)*eye()-np.outer(p,p))
        s.J=s.Jh+par(s.mh,s.hubpos)
        for a,p in zip(s.ax,s.pos): s.J=s.J+s.It*eye()+(s.Jw-s.It)*np.outer(a,a)+par(s.mw,p)
        s.S=A([[a[i] for a in s.ax] for i in range(3)])
    def momentum(s,C,Om):
        """inertial components, body by body, as jets"""
        w=om_of(C); wi=C.T@w
        def orb(m,p):
            r=C.T@p; return m*cross(r,D(r))
        h=C.T@(s.Jh@w)+orb(s.mh,s.hubpos); hw=[]
        for k,(a,p) in enumerate(zip(s.ax,s.pos)):
            wk=w+a*Om[k]; Iw=s.It*eye()+(s.Jw-s.It)*np.outer(a,a)
            q=C.T@(Iw@wk); hw.append(q); h=h+q+orb(s.mw,p)
        return h,hw
    def energy(s,C,Om):
        w=om_of(C)
        def orb(m,p):
            v=D(C.T@p); return dot(v,v)*(m/2)
        T=dot(w,s.Jh@w)/mpf(2)+orb(s.mh,s.hubpos)
        for k,(a,p) in enumerate(zip(s.ax,s.pos)):
            wk=w+a*Om[k]; Iw=s.It*eye()+(s.Jw-s.It)*np.outer(a,a); T=T+dot(wk,Iw@wk)/mpf(2)+orb(s.mw,p)
        return T
def state(s,w0=None,te=None,tau=None,C=None):
    """jets of attitude and wheel speeds"""
    return rotm(Jet([rnd(0.2,1)]+[rnd() for _ in range(4)]),Jet([rnd(0.3,1)]+[rnd() for _ in range(4)]),rjet(0.2,0.6)),A([rjet(1,5) for _ in range(s.n)])
for trial in range(3):
    s=Sat([rvec() for _ in range(4)],rnd(0.2,0.6)); C,Om=state(s); S,J,Jw=s.S,s.J,s.Jw
    w=om_of(C); w0,wd=V(w),V(D(w)); O0,Od=V(Om),V(D(Om)); C0=V(C)
    h,hw=s.momentum(C,Om); hb=V(C@h); te=V(C@D(h)); tau=A([dot(V(C@D(hw[k])),s.ax[k]) for k in range(4)])
    T=s.energy(C,Om)
    O.definition(1); O.definition(5); O.definition(12)
    J0=J-Jw*(S@S.T)
    O.rec(2,[eq(hb,J@w0+Jw*(S@O0))])
    lhs=J@wd+Jw*(S@Od)
    # special: wheel momentum parallel to omega: take wheel speeds with S Om = c w
    O.rec(3,[eq(lhs+cross(w0,J@w0),te)],[eq(lhs+cross(w0,J@w0+Jw*(S@O0)),te)],[[eq(lhs+cross(w0,hb),te)]])
    O.rec(4,[eq(tau,Jw*(Od+S.T@wd))])
    O.rec(6,[eq(J0@wd+cross(w0,hb),te+S@tau)],[eq(J0@wd+cross(w0,hb),te-S@tau)])
    O.rec(7,[eq(T,dot(w0,J@w0)/2+Jw*dot(w0,S@O0)+Jw*dot(O0,O0)/2)])
    O.rec(8,[eq(T.d(),dot(w0,te)+dot(O0,tau))])
    # a torque-free motion: free choice of tau, wd from the linear system of the body-by-body balance
    def solve_motion(C,Om,want_te,want_tau,target=None):
        """returns jets of C and Om (to second order) with the same state and given te and tau"""
        n=s.n
        def make(x):
            wq=A([Jet([w0[i],x[i]]) for i in range(3)]); # rebuild C from omega: C' = -w^x C
            Cs=[C0]; Cj=C0
            C1=-skew(w0)@C0; C2=-(skew(x[:3])@C0+skew(w0)@C1)
            Cq=np.empty((3,3),dtype=object)
            for i in range(3):
                for j in range(3): Cq[i,j]=Jet([C0[i,j],C1[i,j],C2[i,j]/2])
            Oq=A([Jet([O0[k],x[3+k]]) for k in range(n)])
            hh,hk=s.momentum(Cq,Oq)
            # om_of is exact to first order here
            tt=V(Cq@D(hh)); ta=A([dot(V(Cq@D(hk[k])),s.ax[k]) for k in range(n)])
            return np.concatenate([tt,ta]),Cq,Oq,hh
        z=A([mpf(0)]*(3+n)); b=make(z)[0]; cols=[]
        for i in range(3+n):
            e=A([mpf(int(i==j)) for j in range(3+n)]); cols.append(make(e)[0]-b)
        M=A([[cols[j][i] for j in range(3+n)] for i in range(3+n)])
        x=solve(M,np.concatenate([want_te,want_tau])-b)
        return x,make(x)
    tw=rvec(4); x,(chk,Cq,Oq,hq)=solve_motion(C,Om,A([mpf(0)]*3),tw); assert eq(chk,np.concatenate([A([mpf(0)]*3),tw]))<TOL
    hn=V(Cq@hq); dh2=lambda wdot,Odot:2*dot(hb,J@wdot+Jw*(S@Odot))
    perp=cross(hb,rvec()); xp,_=solve_motion(C,Om,perp,tw)
    nz=lambda v:abs(v)
    O.rec(9,[nz(dh2(wd,Od))],under=[nz(dh2(x[:3],x[3:]))],alts=[[nz(dh2(xp[:3],xp[3:]))]],general=[eq(dh2(wd,Od),2*dot(hb,te))])
    # attitude
    eta,ep=quat(C); e0,p0=eta.at(),V(ep); assert abs(e0**2+dot(p0,p0)-1)<TOL
    O.rec(10,[eq(C0,(e0**2-dot(p0,p0))*eye()+2*np.outer(p0,p0)-2*e0*skew(p0))])
    ed,pd=eta.c[1],V(D(ep))
    O.rec(11,[eq(ed,-dot(p0,w0)/2),eq(pd,(e0*w0-cross(p0,w0))/2)],[eq(ed,-dot(p0,w0)/2),eq(pd,(e0*w0+cross(p0,w0))/2)],[[eq(ed,-dot(p0,w0)/2),eq(pd,(e0*w0-cross(w0,p0))/2)]],bad={1})
    # control
    KD=spd(); kP=rnd(1,3)
    need=KD@w0+kP*p0-cross(w0,hb)
    tau_c=S.T@inv(S@S.T)@need; assert eq(S@tau_c,need)<TOL
    W=dot(w0,J0@w0)/2+kP*(dot(p0,p0)+(1-e0)**2)
    O.rec(13,[mpf(0),eq(W,dot(w0,J0@w0)/2+kP*(1-e0))],[mpf(0),eq(W,dot(w0,J0@w0)/2+2*kP*(1-e0))],bad={1})
    def Wdot(wdot): # numeric from the kinematics of the true quaternion jets (depends on omega only)
        return dot(w0,J0@wdot)+kP*(2*dot(p0,pd)-2*(1-e0)*ed)
    tex=rvec(); x1,_=solve_motion(C,Om,A([mpf(0)]*3),tau_c); x2,_=solve_motion(C,Om,tex,tau_c); x3,_=solve_motion(C,Om,cross(w0,rvec()),tau_c)
    rhs=-dot(w0,KD@w0)
    O.rec(14,[eq(Wdot(x2[:3]),rhs)],under=[eq(Wdot(x1[:3]),rhs)],alts=[[eq(Wdot(x3[:3]),rhs)]],general=[eq(Wdot(x2[:3]),rhs+dot(w0,tex))])
    # 15: least squares share
    G=S.T@S; assert abs(det(G))<mpf(10)**-40     # singular: the written line has no meaning
    l=rvec(); t=S.T@inv(S@S.T)@l
    null=A([mpf(0)]*4)  # null vector of S
    cof=[(-1)**k*det(A([[S[i,j] for j in range(4) if j!=k] for i in range(3)])) for k in range(4)]; null=A(cof); assert max(abs(y) for y in S@null)<TOL
    O.rec(15,[mpf(1)],[eq(S@t,l),abs(dot(t,null))])
    S3=A([[S[i,j] for j in range(3)] for i in range(3)]); assert eq(S3@(inv(S3.T@S3)@S3.T@l),l)<TOL
    # 16
    be=rnd(0.3,1.2); c,sn=mp.cos(be),mp.sin(be)
    dirs=[A([mpf(1),0,0]),A([mpf(0),1,0]),A([mpf(-1),0,0]),A([mpf(0),-1,0])]; Sp=A([[ (d*c+A([0,0,1])*sn)[i] for d in dirs] for i in range(3)])
    Sw=A([[c,0,-c,0],[0,c,0,-c],[sn]*4])
    dg=lambda a,b,d:A([[a,0*a,0*a],[0*a,b,0*a],[0*a,0*a,d]])
    O.rec(16,[eq(Sp,Sw),eq(Sp@Sp.T,dg(2*c**2,2*c**2,2*sn**2))],[eq(Sp,Sw),eq(Sp@Sp.T,dg(2*c**2,2*c**2,4*sn**2))],bad={1})
    # 17, 18 dual spin: linearization of Euler's equation of the gyrostat (display 3 as corrected), by exact derivative of its polynomial right-hand side
    J1,J2,J3=rnd(1,2),rnd(2,3),rnd(1.5,4); n=rnd(0.5,2); hw_=rnd(8,15)
    # exact nonlinear rates from angular-momentum balance with constant wheel rate
    def rate(w1,w2): 
        ww=A([w1,w2,n]); hh=A([J1*w1,J2*w2,J3*n+hw_]); r=-cross(ww,hh); return A([r[0]/J1,r[1]/J2,r[2]/J3])
    eps=mpf(10)**-20
    a11,a21=rate(eps,mpf(0))[:2]/eps; a12,a22=rate(mpf(0),eps)[:2]/eps; assert abs(a11)+abs(a22)<TOL
    r1=eq(J1*a12,-((J3-J2)*n+hw_))
    O.rec(17,[r1,eq(J2*a21,(J1-J3)*n+hw_)],[r1,eq(J2*a21,(J3-J1)*n+hw_)],bad={1})
    O.rec(18,[eq(-a12*a21,((J3-J1)*n+hw_)*((J3-J2)*n+hw_)/(J1*J2))])
    # full check of the gyrostat: one wheel along b3, body by body
# one-wheel satellite with principal axes: the rate formula above against separate bodies
s=Sat([A([mpf(0),mpf(0),mpf(1)])],rnd(0.2,0.6)); 
Jt=dict(); s.Jh=s.Jh-(s.J-np.diag([s.J[0,0]+3,s.J[1,1]+3,s.J[2,2]+3])); s.J=A([[s.J[i,i]+3 if i==j else mpf(0) for j in range(3)] for i in range(3)])
C,Om=state(s); Om=A([Jet([rnd(1,5)])]); h,_=s.momentum(C,Om); w=om_of(C); w0,wd=V(w),V(D(w)); te=V(C@D(h)); hh=s.J@w0+A([0,0,s.Jw*Om[0].at()])
assert eq(s.J@wd+cross(w0,hh),te)<TOL
# 19, 20 numbers and units (kg, m, s)
omg=mpf(6000)*2*mp.pi/60; hwv=mpf('0.020')*omg
assert abs(omg-mpf('628.3'))<mpf('0.05') and abs(hwv-mpf('12.6'))<mpf('0.05')
kgm2=(1,2,0); rads=(0,0,-1); Nm=(1,2,-2); Nms=(1,2,-1); prod=tuple(a+b for a,b in zip(kgm2,rads))
b=lambda t:mpf(0) if t else mpf(1)
O.rec(19,[b(prod==Nm)],[b(prod==Nms)])
ts=mpf('12.6')/mpf('1e-4'); O.rec(20,[b(abs(hwv/mpf('1e-4')-mpf('1.26e5'))<=mpf('0.005e5')),b(abs(ts/3600-35)<=mpf('0.5')),b(tuple(a-c for a,c in zip(Nms,Nm))==(0,0,1))])
O.done()
