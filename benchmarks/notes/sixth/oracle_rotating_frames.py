from o6 import *
u=rng(601); R_=Rec('rotating_frames',18)
ang=[[u() for _ in range(4)] for _ in range(3)]
Rot=lambda t:Rz(pol(ang[0],t))*Ry(pol(ang[1],t))*Rx(pol(ang[2],t))     # columns: e_i in S
Om=lambda t:vee(D(Rot,t)*Rot(t).T)
t0=u(); R=Rot(t0); O=Om(t0); Od=D(Om,t0)
vecp=lambda:(lambda c:(lambda t:V(*[pol(x,t) for x in c])))([[u() for _ in range(4)] for _ in range(3)])
R_.put(1,mx(*[D(lambda t,i=i:Rot(t)*V(*[mpf(k==i) for k in range(3)]),t0)-X(O,R*V(*[mpf(k==i) for k in range(3)])) for i in range(3)]))
rot=lambda f,t:Rot(t)*D(lambda s:Rot(s).T*f(s),t)     # derivative seen in S', as a vector in S
b=vecp(); R_.put(2,mx(D(b,t0)-rot(b,t0)-X(O,b(t0))))
R_.put(3,mx(Od-rot(Om,t0)))
r=vecp(); R0=vecp(); rp=lambda t:r(t)-R0(t)
vp=lambda t:rot(rp,t); v=D(r,t0); V0=D(R0,t0); x=rp(t0); w=vp(t0)
R_.put(4,mx(v-V0-w-X(O,x)))
a=D(lambda s:D(r,s),t0); A0=D(lambda s:D(R0,s),t0)
ap=R*D(lambda s:D(lambda q:Rot(q).T*rp(q),s),t0)
R_.put(5,mx(a-A0-ap-2*X(O,w)-X(Od,x)-X(O,X(O,x))))
m=u(); F=m*a
eom=lambda sg,O,w,ap,F:m*ap-(F-m*A0+sg*2*m*X(O,w)-m*X(Od,x)-m*X(O,X(O,x)))
# special case: v' parallel to Omega
w_par=O*u(); F_par=m*(A0+ap+2*X(O,w_par)+X(Od,x)+X(O,X(O,x)))
R_.put(6,mx(eom(1,O,w,ap,F)),mx(eom(-1,O,w,ap,F)),only_if=[mx(eom(1,O,w_par,ap,F_par))])
R_.put(7,mx(-X(O,X(O,x))-(dot(O,O)*x-dot(O,x)*O)))
Phi=lambda y:-m*dot(X(O,y),X(O,y))/2
def grad(f,y): return V(*[D(lambda s,i=i:f(y+s*V(*[mpf(k==i) for k in range(3)])),mpf(0)) for i in range(3)])
R_.put(8,mx(-m*X(O,X(O,x))+grad(Phi,x)))
# 9: motion in S' with constant Omega, anisotropic quadratic U in S': linear system, exact solution
K=matrix([[u() if i==j else u(-.3,.3) for j in range(3)] for i in range(3)]); K=(K+K.T)/2
Oc=V(u(),u(),u()); hat=lambda w:matrix([[0,-w[2],w[1]],[w[2],0,-w[0]],[-w[1],w[0],0]])
B=-K/m-hat(Oc)*hat(Oc); C=-2*hat(Oc); M6=matrix(6,6)
for i in range(3):
    M6[i,3+i]=1
    for j in range(3): M6[3+i,j]=B[i,j]; M6[3+i,3+j]=C[i,j]
z0=matrix([u() for _ in range(6)])
def En(t):
    z=expm(M6*t,method='taylor')*z0; y=V(z[0],z[1],z[2]); q=V(z[3],z[4],z[5])
    return m*dot(q,q)/2+dot(y,K*y)/2-m*dot(X(Oc,y),X(Oc,y))/2
y=V(z0[0],z0[1],z0[2]); q=V(z0[3],z0[4],z0[5])
R_.put(9,max(abs(En(mpf(s)/3)-En(mpf(0))) for s in (1,2)),general=-m*dot(q,X(Od,y))+dot(q,-m*A0),remark='general: power with Omega-dot and A_0 (partial)')
# 10, 11: local axes on the sphere, Earth axis k
la=u(.3,1.2); k=V(0,0,1); up=V(cos(la),0,sin(la)); ea=V(0,1,0); no=V(-sin(la),0,cos(la)); W=u()
assert mx(X(ea,no)-up)<mpf(10)**-100
loc=lambda f,g,no,up:mx(W*k-W*(f*no+g*up))
l4=pi/4; n4=V(-sin(l4),0,cos(l4)); u4=V(cos(l4),0,sin(l4))
R_.put(10,loc(sin(la),cos(la),no,up),loc(cos(la),sin(la),no,up),only_if=[loc(sin(l4),cos(l4),n4,u4)])
xd,yd,zd=u(),u(),u(); cor=-2*X(W*k,xd*ea+yd*no+zd*up)
c11=lambda s,xd:2*W*((yd*sin(la)-zd*cos(la))*ea-xd*sin(la)*no+s*xd*cos(la)*up)
R_.put(11,mx(cor-c11(-1,xd)),mx(cor-c11(1,xd)),only_if=[mx(-2*X(W*k,yd*no+zd*up)-c11(-1,mpf(0)))])
# 12, 13: exact fall in uniform g with Coriolis force, Omega small
g=u(8,10)
def fall(W,t):
    O=W*V(0,cos(la),sin(la)); M=matrix(7,7); H=-2*hat(O)
    for i in range(3):
        M[i,3+i]=1
        for j in range(3): M[3+i,3+j]=H[i,j]
    M[5,6]=-g
    z=expm(M*t,method='taylor')*matrix([0]*6+[1]); acc=H*V(z[3],z[4],z[5])
    return z,acc
e=mpf(10)**-35; t=u(); zz,acc=fall(e,t); zg,ag=fall(mpf('0.3'),t)
R_.put(12,acc[0]/e-2*g*t*cos(la),general=ag[0]/mpf('0.3')-2*g*t*cos(la))
h=u(2,5); tf=findroot(lambda s:fall(e,s)[0][2]+h,sqrt(2*h/g)); xh=fall(e,tf)[0][0]/e
R_.put(13,xh-cos(la)*sqrt(2*h**3/g)/3,xh-cos(la)*sqrt(8*h**3/g)/3)
# 14
Rr=u(5,7); g0=u(9,10); W=u(.3,.5)
def eps(la):
    up=V(cos(la),0,sin(la)); rho=V(1,0,0); ge=-g0*up+W**2*Rr*cos(la)*rho
    n=-ge; return nm(X(n,up))/dot(n,up)
pl=lambda la,p:eps(la)-W**2*Rr*sin(la)*cos(la)/(g0-W**2*Rr*cos(la)**p)
R_.put(14,pl(la,1),pl(la,2),only_if=[pl(mpf(0),1),abs(pl(pi/2,1))])
# 15: pendulum on the sphere, d'Alembert in the rotating frame, amplitude eps
def fouc(W,ep,sg=(1,1)):
    l=mpf('1.3'); w2=g/l; x,y,xd,yd=[ep*v for v in (mpf('.7'),mpf('-.4'),mpf('.5'),mpf('.9'))]
    O=W*V(0,cos(la),sin(la)); s=sin(la)
    xdd=2*W*s*yd-w2*x; ydd=-2*W*s*xd-w2*y
    z=lambda x,y:-sqrt(l*l-x*x-y*y)
    f=lambda t:(lambda X_,Y_:V(X_,Y_,z(X_,Y_)))(x+xd*t+xdd*t*t/2,y+yd*t+ydd*t*t/2)
    # derivatives at t=0 analytically (z is even, tiny): 
    Z=z(x,y); zx,zy=-x/Z,-y/Z; zd=zx*xd+zy*yd
    zdd=-(xd*xd+yd*yd+x*xdd+y*ydd+zd*zd)/Z
    pos=V(x,y,Z); vel=V(xd,yd,zd); ac=V(xdd,ydd,zdd)
    f=ac+2*X(O,vel)+X(O,X(O,pos-V(0,0,-l)))+V(0,0,g)
    return max(abs(dot(f,V(1,0,zx))),abs(dot(f,V(0,1,zy))))/ep/W
R_.put(15,fouc(mpf(10)**-40,mpf(10)**-60),general=fouc(mpf('.3'),mpf(10)**-60),remark='residual / (amplitude*Omega), limit amplitude->0, Omega->0')
# 16
W=u(.2,.6); s=sin(la); w0=u(1,2); x,y,xd,yd=[u() for _ in range(4)]
xdd=2*W*s*yd-w0**2*x; ydd=-2*W*s*xd-w0**2*y
z_,zd_,zdd_=mpc(x,y),mpc(xd,yd),mpc(xdd,ydd); im=mpc(0,1)
R_.put(16,abs(zdd_+2*im*W*s*zd_+w0**2*z_))
A,Bc=mpc(u(),u()),mpc(u(),u())
def sol(W,s,sg):
    w1=sqrt(w0**2+sg*(W*s)**2); f=lambda t:exp(-im*W*t*s)*(A*cos(w1*t)+Bc*sin(w1*t))
    fd=lambda t:D(f,t); return abs(D(fd,t0)+2*im*W*s*fd(t0)+w0**2*f(t0))
R_.put(17,sol(W,s,-1),sol(W,s,1),only_if=[sol(W,mpf(0),-1)])
rate=D(lambda t:arg(exp(-im*W*t*s)),mpf('.2'))
R_.put(18,2*pi/abs(rate)-2*pi/(W*s))
R_.save()
