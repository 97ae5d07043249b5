from o6 import *
import sympy as sp
u=rng(602); R_=Rec('hw_rolling',19)
m,R,d,g=u(),u(),u(.3,1.2),u(8,10)
# 1: integral over the disc of the squared distance from P
rho,al,ms,Rs,ds=sp.symbols('rho al m R d',positive=True)
I_s=sp.integrate(sp.integrate(sp.expand(((rho*sp.cos(al)+ds)**2+(rho*sp.sin(al))**2)*rho),(al,0,2*sp.pi)),(rho,0,Rs))*ms/(sp.pi*Rs**2)
assert sp.simplify(I_s-(ms*Rs**2/2+ms*ds**2))==0
If=sp.lambdify((ms,Rs,ds),sp.simplify(I_s),'mpmath'); IP=If(m,R,d)
R_.put(1,IP-(m*R**2/2+m*d**2))
# 2: torque about P of the weight (vertical y, P at origin, phi from the downward vertical, counterclockwise)
phi=u(.2,1.2)
tor=lambda p:X(V(d*sin(p),-d*cos(p),0),V(0,-m*g,0))[2]
R_.put(2,tor(phi)+m*g*d*sin(phi),remark='torque by cross product; I_P phi-ddot = torque is the law')
# 3: exact period 4 K(k)/omega
per=lambda p0,d_:4*ellipk(sin(p0/2)**2)*sqrt(If(m,R,d_)/(m*g*d_))
T0=2*pi*sqrt((R**2+2*d**2)/(2*g*d))
R_.put(3,per(mpf(10)**-40,d)-T0,general=per(mpf(1),d)-T0)
# 4: length with the same equation of motion
lr=IP/(m*d); R_.put(4,lr-R**2/(2*d),lr-(d+R**2/(2*d)))
dm=findroot(lambda x:D(lambda y:per(mpf(10)**-40,y),x),mpf('.7')*R)
assert per(mpf(10)**-40,dm*mpf('1.01'))>per(mpf(10)**-40,dm) and per(mpf(10)**-40,dm*mpf('.99'))>per(mpf(10)**-40,dm)
R_.put(5,dm-R/sqrt(2))
# 6: work of the torque from pi/2
W=lambda p:quad(tor,[pi/2,p]); w2=2*W(phi)/IP
ph3=pi/3
R_.put(6,IP*w2/2-m*g*d*(1-cos(phi)),IP*w2/2-m*g*d*cos(phi),only_if=[W(ph3)-m*g*d*(1-cos(ph3))])
# force of the axis
def force(p,w2,add=0):
    a=tor(p)/IP; er=V(sin(p),-cos(p),0); et=V(cos(p),sin(p),0)
    F=m*(d*a*et-d*w2*er)-V(0,-m*g,0)
    return dot(F,-er),dot(F,et)
Nr,Nt=force(phi,w2); wx=u(); Nx,_=force(phi,wx)
R_.put(7,max(abs(Nr-m*g*cos(phi)-m*d*w2),abs(Nx-m*g*cos(phi)-m*d*wx)))
R_.put(8,Nr-m*g*cos(phi)*(1+2*d**2/(R**2+2*d**2)),Nr-m*g*cos(phi)*(1+4*d**2/(R**2+2*d**2)),only_if=[force(pi/2,2*W(pi/2)/IP)[0]-m*g*cos(pi/2)*(1+2*d**2/(R**2+2*d**2))])
R_.put(9,max(abs(Nt-m*g*sin(phi)*R**2/(R**2+2*d**2)),abs(force(phi,wx)[1]-m*g*sin(phi)*R**2/(R**2+2*d**2))),remark='does not need the release from rest')
# Problem 2
r,al_,I=u(),u(.2,.8),u(); w=u()
# contact point: centre moves with v downhill (x), turns clockwise: omega vector -z, contact at -r y
vc=V(r*w,0,0)+X(V(0,0,-w),V(0,-r,0))
vs=V(r*w*2,0,0)+X(V(0,0,-w),V(0,-r,0))
R_.put(10,mx(vc),general=mx(vs),remark='rolling condition <=> velocity of the contact point zero')
# Lagrange: T=(m v^2+I v^2/r^2)/2, power of gravity m g sin(al) v
acc=lambda I:m*g*sin(al_)/(m+I/r**2)
a=acc(I); F=m*g*sin(al_)-m*a
R_.put(11,max(abs(m*a-m*g*sin(al_)+F),abs(I*a/r-F*r)))
R_.put(12,a-g*sin(al_)/(1+I/(m*r**2)))
th=sp.symbols('th'); Ish=sp.integrate((sp.sin(th))**2*sp.sin(th)*2*sp.pi,(th,0,sp.pi))/(4*sp.pi)  # /m r^2
assert Ish==sp.Rational(2,3)
Is=mpf(2)/3*m*r**2; ash=acc(Is)
R_.put(13,ash-mpf(5)/7*g*sin(al_),ash-mpf(3)/5*g*sin(al_))
Fs=m*g*sin(al_)-m*ash; R_.put(14,Fs-mpf(2)/5*m*g*sin(al_))
mu=Fs/(m*g*cos(al_)); R_.put(15,mu-mpf(2)/5*sin(al_),mu-mpf(2)/5*tan(al_))
# Problem 3
a_,b_=u(.3,.6),u(1.2,1.9); thd=u(); t_=u(.2,1)
cen=lambda s:V((b_-a_)*sin(s),-(b_-a_)*cos(s),0)
vcen=D(lambda q:cen(t_+thd*q),mpf(0)); er=V(sin(t_),-cos(t_),0)
# contact at centre + a er ; v + Omega_z z x a er = 0 -> Omega_z
et=V(cos(t_),sin(t_),0); Oz=-dot(vcen,et)/a_; assert mx(vcen+X(V(0,0,Oz),a_*er))<mpf(10)**-80
Om=abs(Oz)
R_.put(16,a_*Om-b_*thd,a_*Om-(b_-a_)*thd,remark='b theta-dot would be right for the turning relative to the line of centres')
assert abs(a_*(Om+thd)-b_*thd)<mpf(10)**-80
E=m*dot(vcen,vcen)/2+m*a_**2/2*Om**2/2
R_.put(17,E-mpf(3)/4*m*(b_-a_)**2*thd**2,general=m*dot(vcen,vcen)/2+m*a_**2/4*(Om+1)**2-mpf(3)/4*m*(b_-a_)**2*thd**2)
# equation of motion by Newton: tangential and torque, unknown friction f: m s dd = -m g sin + f ; I Omdd = -f a, s=(b-a)theta, Om=(b-a)thetad/a (reversed sense)
s_=b_-a_; Ic=m*a_**2/2
M2=matrix([[m*s_,-1],[Ic*s_/a_,a_]]); sol=M2**-1*matrix([-m*g*sin(t_),0])
R_.put(18,sol[0]+2*g/(3*s_)*sin(t_))
th0=u(.5,1.4); wb2=2*quad(lambda x:2*g/(3*s_)*sin(x),[0,th0]); N=m*g+m*s_*wb2
R_.put(19,N-m*g/3*(7-4*cos(th0)),general=m*g+m*s_*(wb2+1)-m*g/3*(7-4*cos(th0)))
R_.save()
