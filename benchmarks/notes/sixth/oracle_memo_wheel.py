from o6 import *
u=rng(603); R_=Rec('memo_wheel',18)
# particle model: platform 3 pairs on the axes, wheel: square of 4 particles in the xz plane turning about y
class Craft:
    def __init__(s,sym=False,p=None):
        q=[u() for _ in range(3)] if p is None else p
        if sym: q[2]=q[0]
        s.pp=[]; s.pm=[]
        for i in range(3):
            for sg in (1,-1): v=[mpf(0)]*3; v[i]=sg*q[i]; s.pp.append(V(*v)); s.pm.append(mpf('.4') if (sym or i!=1) else mpf('.55'))
        s.rw,s.mw=mpf('.6'),mpf('.21')
        s.Jw=4*s.mw*s.rw**2
        J=inertia(s.pp,s.pm)+inertia([s.w0(k,mpf('.3')) for k in range(4)],[s.mw]*4)
        assert max(abs(J[i,j]) for i in range(3) for j in range(3) if i!=j)<mpf(10)**-100
        s.J=[J[i,i] for i in range(3)]
    def w0(s,k,ga): return Ry(ga+k*pi/2)*V(s.rw,0,0)
    def parts(s,R,ga):       # inertial positions: platform, wheel
        return [R*x for x in s.pp],[R*s.w0(k,ga) for k in range(4)]
    def HE(s,R,ga,t,only=None):
        """angular momentum, kinetic energy from the velocities of the particles; R, ga functions of time"""
        H=V(0,0,0);E=mpf(0)
        P=lambda t:s.parts(R(t),ga(t))
        p=P(t); h=mpf(10)**-9
        lists=[(0,s.pm),(1,[s.mw]*4)]
        for part,ms in lists:
            if only is not None and only!=part: continue
            for k,mm in enumerate(ms):
                v=D(lambda q:P(q)[part][k],t); H=H+mm*X(p[part][k],v); E+=mm*dot(v,v)/2
        return H,E
c=Craft(); Jx,Jy,Jz=c.J; Jw=c.Jw
ang=[[u() for _ in range(4)] for _ in range(4)]
R=lambda t:Rz(pol(ang[0],t))*Ry(pol(ang[1],t))*Rx(pol(ang[2],t)); ga=lambda t:pol(ang[3],t)
wb=lambda t:vee(R(t).T*D(R,t)); nu=lambda t:D(ga,t)
t0=mpf('.37'); w=wb(t0); wd=D(wb,t0); n=nu(t0); nd=D(nu,t0); R0=R(t0)
H,E=c.HE(R,ga,t0); Hb=R0.T*H
# relative momentum of the wheel (platform held)
h=Jw*n
hrel=sum(c.mw*X(c.w0(k,ga(t0)),D(lambda q:c.w0(k,ga(q)),t0))[1] for k in range(4))
R_.put(1,hrel-h,remark='definition; equals the relative momentum of the particles')
R_.put(2,mx(Hb-V(Jx*w[0],Jy*w[1]+h,Jz*w[2])))
e3=lambda w,n,x:(Jx*w[0]**2+Jy*w[1]**2+Jz*w[2]**2)/2+Jw*n**2/2+x*Jw*n*w[1]
wq=V(w[0],0,w[2]); Rq=lambda t:R0*expm(t*matrix([[0,-wq[2],wq[1]],[wq[2],0,-wq[0]],[-wq[1],wq[0],0]]),method='taylor'); gq=lambda t:n*t
E0=c.HE(Rq,gq,mpf(0))[1]
R_.put(3,E-e3(w,n,0),E-e3(w,n,1),only_if=[E0-e3(wq,n,0)])
# torque = dH/dt (particles)
Mb=R0.T*D(lambda t:c.HE(R,ga,t)[0],t0); hd=Jw*nd
r1=lambda w,wd,h:Jx*wd[0]+(Jz-Jy)*w[1]*w[2]-h*w[2]
r2=lambda w,wd,hd:Jy*wd[1]+hd+(Jx-Jz)*w[2]*w[0]
r3=lambda s,w,wd,h:Jz*wd[2]+(Jy-Jx)*w[0]*w[1]+s*h*w[0]
a,b_=r1(w,wd,h)-Mb[0],r2(w,wd,hd)-Mb[1]
R_.put(4,mx(a,b_,r3(-1,w,wd,h)-Mb[2]),mx(a,b_,r3(1,w,wd,h)-Mb[2]),remark='rows 1,2: %s'%mp.nstr(mx(a,b_),3))
# motor torque: y component (body) of dH_wheel/dt
uw=(R0.T*D(lambda t:c.HE(R,ga,t,1)[0],t0))[1]
# only if: omega_y constant -> motion with body y rate frozen: R = Ry(const rate)
Rf=lambda t:Ry(mpf('.8')*t); uf=D(lambda t:c.HE(Rf,ga,t,1)[0],t0)[1]
R_.put(5,uw-Jw*nd,uw-Jw*(nd+wd[1]),only_if=[uf-Jw*nd])
# power: dE/dt = M.omega + P(motor)
Ed=D(lambda t:c.HE(R,ga,t)[1],t0)
R_.put(6,Ed-dot(Mb,w)-uw*n)
R_.put(7,dot(H,H)-(Jx**2*w[0]**2+(Jy*w[1]+h)**2+Jz**2*w[2]**2),remark='magnitude of H; conserved for M=0 since dH/dt=M (4)')
Om=mpf('.8'); Rn=lambda t:Ry(Om*t); gn=lambda t:n*t
Hn=c.HE(Rn,gn,mpf('.2'))[0]; R_.put(8,mx(Hn-V(0,Jy*Om+h,0)))
# 9 linearised, from the exact equations of motion (particle-tested r1,r3 with +h wx)
def lin(ep,Om,sc):
    wx,wz=ep*mpf('.3'),ep*mpf('.7'); dOm=ep*mpf('.5'); wy=Om+dOm
    wdx=-((Jz-Jy)*wy*wz-h*wz)/Jx; wdz=-((Jy-Jx)*wx*wy+h*wx)/Jz
    return max(abs(Jx*wdx-((Jy-Jz)*Om+h)*wz),abs(Jz*wdz+((Jy-Jx)*Om+h)*wx))/ep
R_.put(9,lin(mpf(10)**-60,Om,1),general=lin(mpf(1),Om,1))
al,be=((Jy-Jz)*Om+h)/Jx,-((Jy-Jx)*Om+h)/Jz     # wxdot=al wz, wzdot=be wx
lam2=-al*be
# numerical check by exponential: period 2pi/lambda returns
assert lam2>0
ph=expm(matrix([[0,al],[be,0]])*(2*pi/sqrt(lam2)),method='taylor')-eye(2)
ph2=expm(matrix([[0,al],[be,0]])*(pi/sqrt(lam2)),method='taylor')-eye(2)
lw=((Jy-Jz)*Om+h)*((Jy-Jx)*Om+h)/(Jx*Jz)
ph=expm(matrix([[0,al],[be,0]])*(2*pi/sqrt(lw)),method='taylor')-eye(2)
assert mx(ph2)>0.5
R_.put(10,mx(ph))
# symmetric craft
cs=Craft(sym=True); Jt,Jys=cs.J[0],cs.J[1]; assert abs(Jt-cs.J[2])<mpf(10)**-100
lam=sqrt(((Jys-Jt)*Om+h)**2/Jt**2); assert (Jys-Jt)*Om+h>0
R_.put(11,lam-((Jys-Jt)/Jt*Om+h/Jt),general=sqrt(lw)-((Jy-Jx)/Jx*Om+h/Jx))
# transverse rate in inertial axes: body (wz,wx) solution, platform turned by Om t about y
A2=matrix([[0,((Jys-Jt)*Om+h)/Jt],[-((Jys-Jt)*Om+h)/Jt,0]])    # (wx,wz)
def inert(t):
    s=expm(A2*t,method='taylor')*matrix([mpf('.2'),mpf('.9')]); v=Ry(Om*t)*V(s[0],0,s[1]); return atan2(v[0],v[2])  # angle about +y from z to x
rate=D(inert,mpf('.1')); H0=Jys*Om+h
R_.put(12,mx(rate-lam-Om,rate-H0/Jys),mx(rate-lam-Om,rate-H0/Jt),remark='lambda+Omega right: %s'%mp.nstr(abs(rate-lam-Om),3))
# 13 slew: H=0 by particles
n1=mpf('2.3')
def Hy(wy): return c.HE(lambda t:Ry(wy*t),lambda t:n1*t,mpf(0))[0][1]
wy=-Hy(mpf(0))/(Hy(mpf(1))-Hy(mpf(0))); assert abs(Hy(wy))<mpf(10)**-80
R_.put(13,wy+Jw/(Jy-Jw)*n1,wy+Jw/Jy*n1,general=(wy+1)+Jw/Jy*n1,remark='Jw/(Jy-Jw) is right for the absolute speed of the wheel: %s'%mp.nstr(abs(wy+Jw/(Jy-Jw)*(n1+wy)),3))
prof=lambda t:n1*sin(t)**2; aw=quad(prof,[0,1]); th=quad(lambda t:wy/n1*prof(t),[0,1])
R_.put(14,th+Jw/(Jy-Jw)*aw,th+Jw/Jy*aw)
# 15: pitch held: row 2 of the true equations with wd=0, wx=wz=0: hdot=My
My=u(); hm=h+5; ts=(hm-h)/My
hh=h+quad(lambda t:My-r2(V(0,Om,0),V(0,0,0),mpf(0)),[0,ts]); R_.put(15,hh-hm,general=h+quad(lambda t:My-Jy*mpf('.1'),[0,ts])-hm)
# 16
H0=u(); Mp,ta=u(.1,.4),u(); Hf=V(0,H0,0)+Mp*ta*V(1,0,0); H0v=V(0,1,0)
tn=nm(X(H0v,Hf))/dot(H0v,Hf); sn=nm(X(H0v,Hf))/nm(Hf)
R_.put(16,sn-Mp*ta/H0,tn-Mp*ta/H0)
num=mpf('.04')*2*pi*3000/60; R_.put(17,0 if mp.nstr(num,3)=='12.6' else 1,remark=mp.nstr(num,8))
R_.n=17; R_.save()
