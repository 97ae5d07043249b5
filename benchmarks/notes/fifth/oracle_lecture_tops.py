import sys; sys.path.insert(0,'.')
from olib import *
import sympy as sp
u=rng(11); R_=Rec('lecture_tops',18)
E=eye(3); ang=[[u() for _ in range(4)] for _ in range(3)]
poly=lambda c,t:c[0]+c[1]*t+c[2]*t**2+c[3]*t**3
def Rot(t):
    a,b,c=[poly(x,t) for x in ang]
    return matrix([[cos(a),-sin(a),0],[sin(a),cos(a),0],[0,0,1]])*matrix([[cos(b),0,sin(b)],[0,1,0],[-sin(b),0,cos(b)]])*matrix([[1,0,0],[0,cos(c),-sin(c)],[0,sin(c),cos(c)]])
t0=u(); R=Rot(t0); w=vee(d(Rot,t0)*R.T)
b=[matrix([u(-1,1) for _ in range(3)]) for _ in range(6)]; m=[u() for _ in range(6)]
# 1: moving reference point O(t)
Oc=[[u() for _ in range(4)] for _ in range(3)]
O=lambda t:matrix([poly(x,t) for x in Oc])
vP=d(lambda t:O(t)+Rot(t)*b[0],t0); vO=d(O,t0)
R_.put(1,mx(vP-vO-cross(w,R*b[0])))
# fixed O
r=[R*x for x in b]; v=[d(lambda t,x=x:Rot(t)*x,t0) for x in b]
S=lambda vs:sum(vs[1:],vs[0])
L=S([m[a]*cross(r[a],v[a]) for a in range(6)])
mid=S([m[a]*cross(r[a],cross(w,r[a])) for a in range(6)])
wr=S([m[a]*(dot(r[a],r[a])*w-dot(r[a],w)*w) for a in range(6)])
co=S([m[a]*(dot(r[a],r[a])*w-dot(r[a],w)*r[a]) for a in range(6)])
# only if: all particles have r.w=0 -> check with planar set perpendicular to w
rp=[x-w*(dot(x,w)/dot(w,w)) for x in r]
oi=mx(S([m[a]*(cross(rp[a],cross(w,rp[a]))-dot(rp[a],rp[a])*w+dot(rp[a],w)*w) for a in range(6)]))
R_.put(2,mx(L-mid,mid-wr),mx(L-mid,mid-co),only_if=[oi])
def inertia(rs,ms):
    I=matrix(3,3)
    for x,mm in zip(rs,ms):
        for i in range(3):
            for j in range(3): I[i,j]+=mm*((dot(x,x) if i==j else 0)-x[i]*x[j])
    return I
I=inertia(r,m)
R_.put(3,mx(L-I*w),remark='definition; consistent with L=I w')
T=sum(m[a]*dot(v[a],v[a]) for a in range(6))/2
R_.put(4,mx(T-dot(w,I*w)/2))
M=sum(m); Rc=S([m[a]*r[a] for a in range(6)])/M
IC=inertia([x-Rc for x in r],m)
R_.put(5,mx(I-IC-M*(dot(Rc,Rc)*E-Rc*Rc.T)))
# plate
x,y,a,bb,MM,Om=sp.symbols('x y a b M Omega',positive=True)
rr=sp.Matrix([x,y,0]); J=(rr.dot(rr)*sp.eye(3)-rr*rr.T)*MM/(a*bb)
IO=J.applyfunc(lambda e:sp.integrate(e,(x,0,a),(y,0,bb)))
Wm=MM/12*sp.Matrix([[4*bb**2,-3*a*bb,0],[-3*a*bb,4*a**2,0],[0,0,a**2+bb**2]])
Cm=MM/12*sp.Matrix([[4*bb**2,-3*a*bb,0],[-3*a*bb,4*a**2,0],[0,0,4*(a**2+bb**2)]])
sub={a:sp.Rational(13,10),bb:sp.Rational(7,10),MM:sp.Rational(9,5),Om:sp.Rational(11,7)}
num=lambda e:max(abs(mpf(sp.N(q.subs(sub),50))) for q in (e if isinstance(e,sp.MatrixBase) else [e]))
R_.put(6,num(sp.simplify(IO-Wm)),num(sp.simplify(IO-Cm)))
D=sp.sqrt(a**2+bb**2); wv=Om/D*sp.Matrix([a,bb,0]); Lp=IO*wv
R_.put(7,num(Lp-MM*Om*a*bb/(12*D)*sp.Matrix([bb,a,0])))
# T by direct integration of the speeds
vv=wv.cross(rr); Tp=sp.integrate(sp.expand(vv.dot(vv))*MM/(a*bb)/2,(x,0,a),(y,0,bb))
R_.put(8,num(Tp-MM*a**2*bb**2*Om**2/(6*D**2)),num(Tp-MM*a**2*bb**2*Om**2/(12*D**2)))
# 9: body-frame derivative; L space = sum m r x v for the fixed point, N = its derivative
def Lsp(t): return S([m[k]*cross(Rot(t)*b[k],d(lambda s:Rot(s)*b[k],t)) for k in range(6)])
Ib=inertia(b,m)
wb=lambda t:vee(Rot(t).T*d(Rot,t))
N=None
mp.dps=90; H_=mpf(10)**-12
import olib
olib.H=mpf(10)**-12
def dd(f,t): # 8th order, step 1e-6: truncation ~1e-48
    h=mpf(10)**-6; c=[mpf(4)/5,-mpf(1)/5,mpf(4)/105,-mpf(1)/280]
    return sum((c[k]*(f(t+(k+1)*h)-f(t-(k+1)*h)) for k in range(1,4)),c[0]*(f(t+h)-f(t-h)))/h
Lsp2=lambda t:Rot(t)*(Ib*vee(Rot(t).T*dd(Rot,t)))
N=dd(Lsp2,t0); Lb=lambda t:Rot(t).T*Lsp2(t); w2=vee(dd(Rot,t0)*Rot(t0).T)
R_.put(9,mx(Rot(t0)*dd(Lb,t0)+cross(w2,Lsp2(t0))-N))
# 10: principal moments
P=[u(),u(),u()]; Pd=matrix([[P[0],0,0],[0,P[1],0],[0,0,P[2]]])
wbf=lambda t:vee(Rot(t).T*dd(Rot,t))
Nb=Rot(t0).T*dd(lambda t:Rot(t)*(Pd*wbf(t)),t0); ww=wbf(t0); wd=dd(wbf,t0)
e1=P[0]*wd[0]-(P[1]-P[2])*ww[1]*ww[2]-Nb[0]
e2=P[1]*wd[1]-(P[0]-P[2])*ww[2]*ww[0]-Nb[1]
e2c=P[1]*wd[1]-(P[2]-P[0])*ww[2]*ww[0]-Nb[1]
e3=P[2]*wd[2]-(P[0]-P[1])*ww[0]*ww[1]-Nb[2]
Q=matrix([[P[0],0,0],[0,P[1],0],[0,0,P[0]]])
Nq=Rot(t0).T*dd(lambda t:Rot(t)*(Q*wbf(t)),t0)
R_.put(10,mx(e1,e2,e3),mx(e1,e2c,e3),only_if=[mx(P[1]*wd[1]-Nq[1])],remark='rows 1,3: %s; row 2: %s'%(mp.nstr(mx(e1,e3),3),mp.nstr(e2,3)))
# 11 bearing
an,bn,Mn,On=[mpf(sp.N(sub[k],80)) for k in (a,bb,MM,Om)]
Ln=matrix([mpf(sp.N(q.subs(sub),80)) for q in Lp]); nrm=sqrt(an**2+bn**2); n=matrix([an,bn,0])/nrm
rodr=lambda al:cos(al)*E+(1-cos(al))*n*n.T+sin(al)*hat(n)
Nn=dd(lambda t:rodr(On*t)*Ln,mpf(0))
R_.put(11,mx(Nn-matrix([0,0,Mn*On**2*an*bn*(an**2-bn**2)/(12*nrm**2)])),general=mx(dd(lambda t:(On+t)*(rodr(On*t+t*t/2)*Ln)/On,mpf(0))-matrix([0,0,Mn*On**2*an*bn*(an**2-bn**2)/(12*nrm**2)])),remark='general: Omega(t)=On+t, the torque has also I*dw/dt')
# free symmetric top
A,C,w3,wp,t=u(),u(),u(),u(),u(); lam=(C-A)/A*w3
Sy=matrix([[A,0,0],[0,A,0],[0,0,C]])
w0=matrix([u(),u(),u()]); wdt=(Sy**-1)*(-cross(w0,Sy*w0))
R_.put(12,mx(A*wdt[0]-(A-C)*w0[1]*w0[2],A*wdt[1]-(C-A)*w0[2]*w0[0],C*wdt[2]),general=mx(A*(C-u())/A-(A-C)*w0[1]*w0[2]),remark='needs N=0 and I1=I2 (general: a random angular acceleration)')
R_.put(13,mx(wdt[0]+(C-A)/A*w0[2]*w0[1],wdt[1]-(C-A)/A*w0[2]*w0[0]),remark='definition; with it w1dot=-lam w2, w2dot=lam w1')
def freeres(sg,lm,Av,Cv):
    f=lambda s:matrix([wp*cos(lm*s),sg*wp*sin(lm*s),w3]); I_=matrix([[Av,0,0],[0,Av,0],[0,0,Cv]])
    return mx(I_*dd(f,t)+cross(f(t),I_*f(t)))
R_.put(14,freeres(-1,lam,A,C),freeres(1,lam,A,C),only_if=[freeres(-1,mpf(0),A,A)])
Lf=Sy*w0; l0=(C-A)/A*w0[2]; e3v=matrix([0,0,1])
R_.put(15,mx(w0-Lf/A+l0*e3v),general=mx(w0-matrix([A*w0[0],P[1]*w0[1],C*w0[2]])/A+l0*e3v),remark='needs I1=I2')
Lm=sqrt(dot(Lf,Lf)); cth=Lf[2]/Lm; sth=sqrt(1-cth**2)
# rate of the figure axis about L: de3/dt = w x e3 ; component along (Lhat x e3) / |Lhat x e3|^2
k=cross(Lf/Lm,e3v); ph=dot(cross(w0,e3v),k)/dot(k,k)
wq=matrix([w0[0],w0[1],w0[2]])
# theta = 45 deg: C w3 = A w_perp
w45=matrix([C*w3/A,0,w3]); L45=sqrt((A*w45[0])**2+(C*w3)**2)
R_.put(16,mx(ph-Lm/A,ph-C*w0[2]/(A*sth)),mx(ph-Lm/A,ph-C*w0[2]/(A*cth)),only_if=[mx(L45/A-C*w3/(A*sin(pi/4)))])
ta=sqrt(w0[0]**2+w0[1]**2)/w0[2]
R_.put(17,mx(ta-A/C*sth/cth),mx(ta-C/A*sth/cth),only_if=[mx(ta-sqrt((A*w0[0])**2+(A*w0[1])**2)/(A*w0[2]))])
R_.put(18,mx((A/(C-A)*2*pi/w0[2])-2*pi/l0),remark='305 x 1 day = 305 days')
R_.save()
