from common import *; from vec import *
from mpmath import mp, mpf, sin, cos, sqrt, pi
N=Note('arm.tex'); TOL=mpf('1e-12')
class Mod: pass
h_=mpf(1)/2
# ---- Newton-Euler of the planar arm: torques for given motion; Fw = force of the wall on the tip ----
def NE(o,q,qd,qdd,Fw=(0,0),g=None):
    g=o.g if g is None else g
    t1,t12=q[0],q[0]+q[1]; w1,w2=qd[0],qd[0]+qd[1]; a1,a2=qdd[0],qdd[0]+qdd[1]
    u=lambda t:(cos(t),sin(t)); n=lambda t:(-sin(t),cos(t))
    acc=lambda r,t,w,a:(r*(a*n(t)[0]-w*w*u(t)[0]),r*(a*n(t)[1]-w*w*u(t)[1]))
    cz=lambda a,b:a[0]*b[1]-a[1]*b[0]
    A1=acc(o.r1,t1,w1,a1); AJ=acc(o.l1,t1,w1,a1); A2=acc(o.r2,t12,w2,a2); A2=(A2[0]+AJ[0],A2[1]+AJ[1])
    f2=(o.m2*A2[0]-Fw[0],o.m2*(A2[1]+g)-Fw[1])       # joint 2 on link 2
    e2=u(t12)
    tau2=o.I2*a2-cz((-o.r2*e2[0],-o.r2*e2[1]),f2)-cz(((o.l2-o.r2)*e2[0],(o.l2-o.r2)*e2[1]),Fw)
    e1=u(t1); f1=(o.m1*A1[0]+f2[0],o.m1*(A1[1]+g)+f2[1])
    tau1=o.I1*a1+tau2-cz((-o.r1*e1[0],-o.r1*e1[1]),f1)+cz(((o.l1-o.r1)*e1[0],(o.l1-o.r1)*e1[1]),f2)
    return matrix([tau1,tau2])
def model(**k):
    o=Mod(); o.g=rnd(5,10)
    for s in('m1','m2','l1','l2','I1','I2'): setattr(o,s,rnd())
    o.q=[rnd(.2,1.2),rnd(.3,1.3)]; o.qd=[rnd(.3,2,True),rnd(.3,2,True)]; o.qdd=[rnd(.3,2,True),rnd(.3,2,True)]
    o.__dict__.update(k); o.r1=o.l1*rnd(.3,.7); o.r2=o.l2*rnd(.3,.7)
    o.c1,o.s1=cos(o.q[0]),sin(o.q[0]); o.c2,o.s2=cos(o.q[1]),sin(o.q[1]); o.c12,o.s12=cos(sum(o.q)),sin(sum(o.q)); return o
z=[mpf(0),mpf(0)]
def Mt(o,q): 
    a=NE(o,q,z,[1,0],g=0); b=NE(o,q,z,[0,1],g=0); return matrix([[a[0],b[0]],[a[1],b[1]]])
def Gt(o,q): return NE(o,q,z,z)
def Ct(o,q,qd):
    dM=[D(lambda s:Mt(o,[s,q[1]]),q[0]),D(lambda s:Mt(o,[q[0],s]),q[1])]
    G=lambda i,j,k:(dM[k][i,j]+dM[j][i,k]-dM[i][j,k])/2
    return matrix([[sum(G(i,j,k)*qd[k] for k in(0,1)) for j in(0,1)] for i in(0,1)])
def tip(o,q): return matrix([o.l1*cos(q[0])+o.l2*cos(q[0]+q[1]),o.l1*sin(q[0])+o.l2*sin(q[0]+q[1])])
def Jt(o,q):
    a=D(lambda s:tip(o,[s,q[1]]),q[0]); b=D(lambda s:tip(o,[q[0],s]),q[1]); return matrix([[a[0],b[0]],[a[1],b[1]]])
col=matrix
# ---- frames ----
def hom(R,p):
    T=mp.eye(4)
    for i in range(3):
        T[i,3]=p[i]
        for j in range(3): T[i,j]=R[i,j]
    return T
N.definition(1)
def f2(ok,case=None):
    def f():
        R=randrot(); p=rv()
        if case=='p0': p=V(0,0,0)
        if case=='R1': R=eye(3)
        if case=='ax': a=rv(); q=randrot(); R=q*Rz(rnd())*q.T; p=q*V(0,0,1)
        return nrm(hom(R,p)**-1-hom(R.T,-(R.T*p) if ok else -p))
    return f
N.wrong(2,f2(0),(r'-\,{}^{A}P_{B\,ORG}',r'-\,{}^{A}_{B}R^{T}\;{}^{A}P_{B\,ORG}'),f2(1),'missing rotation matrix at the translation of the inverse transform',
  special=[('the origins coincide (P = 0)',f2(0,'p0')),('the frames are parallel (R = identity)',f2(0,'R1')),('P lies along the axis of the rotation R',f2(0,'ax'))])
def f3():
    q=rnd(); e=V(cos(q),sin(q),0); k=V(0,0,1); n=cross(k,e)
    R=matrix([[e[i],n[i],k[i]] for i in range(3)]); return nrm(R-matrix([[cos(q),-sin(q),0],[sin(q),cos(q),0],[0,0,1]]))
N.holds(3,f3)
def chain(planar=False,zero=None):
    """general revolute step i -> i+1: fixed offset, fixed twist, rotation about the third axis of {i+1}"""
    o=Mod(); t=o.t=mpf('0.3'); o.Ri=rrot(); o.pi=rvfun(); o.P=rv(); o.K=Rx(rnd(.3,1.3)); o.th=rfun()
    if zero is not None: o.K=eye(3); th=o.th; o.th=lambda s:zero+(th(s)-th(t))
    o.step=lambda s:o.K*Rz(o.th(s))          # {i}_{i+1}R
    o.Rn=lambda s:o.Ri(s)*o.step(s); o.pn=lambda s:o.pi(s)+o.Ri(s)*o.P
    o.wi=o.Ri(t).T*angvel(o.Ri,t); o.wn=o.Rn(t).T*angvel(o.Rn,t)
    o.vi=o.Ri(t).T*D(o.pi,t); o.vn=o.Rn(t).T*D(o.pn,t); return o
N.holds(4,lambda:(lambda o:nrm(o.wn-o.step(o.t).T*o.wi-D(o.th,o.t)*V(0,0,1)))(chain()),tol=TOL)
f5=lambda tr,zero=None:lambda:(lambda o:nrm(o.vn-(o.step(o.t).T if tr else o.step(o.t))*(o.vi+cross(o.wi,o.P))))(chain(zero=zero))
N.wrong(5,f5(0),(r'{}^{\ \ \ i}_{i+1}R',r'{}^{i+1}_{\ \ \ i}R'),f5(1),'transposed rotation matrix',tol=TOL,
  others=[(r'{}^{i+1}v_{i+1}={}^{\ \ \ i}_{i+1}R^{T}\left({}^{i}v_i+{}^{i}\omega_i\times{}^{i}P_{i+1}\right)',f5(1))],
  special=[('theta_{i+1} = 0 (no twist)',f5(0,mpf(0))),('theta_{i+1} = 180 degrees (no twist)',f5(0,+pi))])
def f6():
    o=model(); p=hom(Rz(o.q[0]),V(0,0,0))*hom(Rz(o.q[1]),V(o.l1,0,0))*matrix([o.l2,0,0,1])
    return nrm(V(p[0],p[1],p[2])-V(o.l1*o.c1+o.l2*o.c12,o.l1*o.s1+o.l2*o.s12,0))
N.holds(6,f6)
f7=lambda ok:lambda o:nrm(Jt(o,o.q)-matrix([[-o.l1*o.s1-o.l2*o.s12,-o.l2*o.s12],[o.l1*o.c1+o.l2*o.c12,(o.l2 if ok else o.l1)*o.c12]]))
R=lambda f,**k:(lambda:f(model(**k)))
N.wrong(7,R(f7(0)),(r'l_1c_{12}',r'l_2c_{12}'),R(f7(1)),'wrong link length in one entry of the Jacobian',tol=TOL,
  special=[('l1 = l2',R(f7(0),l1=mpf('0.8'),l2=mpf('0.8'))),('c12 = 0',R(f7(0),q=[pi/6,pi/3]))])
f8=lambda fn:lambda o:mp.det(Jt(o,o.q))-o.l1*o.l2*fn(o.q[1])
N.wrong(8,R(f8(cos)),(r'c_2',r's_2'),R(f8(sin)),'cosine for sine in the determinant',wrong_term=r'l_1\,l_2\,c_2',tol=TOL,special=[('theta2 = 45 degrees',R(f8(cos),q=[mpf('0.4'),pi/4]))])
def f9(case=None):
    def f():
        o=model(); Fv=[rnd(.3,2,True),rnd(.3,2,True)]; qd,qdd=o.qd,o.qdd; g=o.g
        if case in('both','gen'): qd=qdd=z
        if case=='both': g=mpf(0)
        tau=NE(o,o.q,qd,qdd,Fw=(-Fv[0],-Fv[1]),g=g); e=tau-Jt(o,o.q).T*col(Fv)
        if case=='gen': e=e-Gt(o,o.q)
        return nrm(e)
    return f
N.under(9,f9(),[f9('both')],corrected=f9('gen'),tol=TOL,assumptions=['the arm is at rest (static equilibrium)','the weights of the links are neglected (g = 0 or horizontal plane)'],
  general_form=r'\tau={}^{0}J^{T}(\Theta)\;{}^{0}F+G(\Theta)',stated_in_note=['statics (section heading)'],also_accept=['wrong'],remark='the note lets gravity act, so that a reader may call the line wrong')
assert min(f9()() for _ in range(1))>0
def Mf(o,k):
    a=o.I2+o.m2*(o.r2**2+o.l1*o.r2*o.c2)
    return matrix([[o.I1+o.I2+o.m1*o.r1**2+o.m2*(o.l1**2+o.r2**2+k*o.l1*o.r2*o.c2),a],[a,o.I2+o.m2*o.r2**2]])
f10=lambda k:lambda o:nrm(Mt(o,o.q)-Mf(o,k))
N.wrong(10,R(f10(1)),(r'l_1^2+r_2^2+l_1r_2c_2',r'l_1^2+r_2^2+2\,l_1r_2c_2'),R(f10(2)),'missing factor 2 in the law of cosines',special=[('c2 = 0',R(f10(1),q=[mpf('0.4'),pi/2]))])
N.definition(11)
def f12(o):
    h=o.m2*o.l1*o.r2*o.s2; a,b=o.qd
    return nrm(Ct(o,o.q,o.qd)-matrix([[-h*b,-h*(a+b)],[h*a,0]]))
N.holds(12,R(f12),tol=TOL)
def f13(fn):
    return lambda o:nrm(Gt(o,o.q)-col([(o.m1*o.r1+o.m2*o.l1)*o.g*o.c1+o.m2*o.r2*o.g*o.c12,o.m2*o.r2*o.g*fn(sum(o.q))]))
def pot():   # G is the gradient of the potential energy
    o=model(); U=lambda q:o.g*(o.m1*o.r1*sin(q[0])+o.m2*(o.l1*sin(q[0])+o.r2*sin(q[0]+q[1])))
    return nrm(Gt(o,o.q)-col([diff(lambda s:U([s,o.q[1]]),o.q[0]),diff(lambda s:U([o.q[0],s]),o.q[1])]))
assert pot()<TOL
N.wrong(13,R(f13(sin)),(r's_{12}',r'c_{12}'),R(f13(cos)),'sine for cosine in the gravity vector',wrong_term=r'm_2r_2\,g\,s_{12}',special=[('theta1 + theta2 = 45 degrees',R(f13(sin),q=[pi/12,pi/6]))])
f14=lambda o:nrm(Mt(o,o.q)*col(o.qdd)+Ct(o,o.q,o.qd)*col(o.qd)+Gt(o,o.q)-NE(o,o.q,o.qd,o.qdd))
N.holds(14,R(f14),tol=TOL,stated_in_note=['no joint friction','free tip'])
def f15(g=None,gen=False):
    def f():
        o=model()
        if g is not None: o.g=g
        tau=NE(o,o.q,o.qd,o.qdd); qf=lambda t:[o.q[i]+o.qd[i]*t+o.qdd[i]*t*t/2 for i in(0,1)]; qdf=lambda t:col([o.qd[i]+o.qdd[i]*t for i in(0,1)])
        K=lambda t:dot(qdf(t),Mt(o,qf(t))*qdf(t))/2
        e=D(K,mpf(0))-dot(col(o.qd),tau)
        if gen: e+=dot(col(o.qd),Gt(o,o.q))
        return e
    return f
N.under(15,f15(),[f15(mpf(0))],corrected=f15(gen=True),tol=TOL,assumptions=['no gravity in the plane of motion (g = 0 or a horizontal arm)'],
  general_form=r'\frac{d}{dt}\left(\tfrac12\,\dot\Theta^{T}M(\Theta)\,\dot\Theta\right)=\dot\Theta^{T}\left(\tau-G(\Theta)\right)',also_accept=['wrong'],remark='the note puts the arm into a vertical plane')
N.definition(16)
def f17():
    o=model(); Kv=matrix([[rnd(),rnd()],[rnd(),rnd()]]); Kp=matrix([[rnd(),rnd()],[rnd(),rnd()]]); dd=col([rnd(),rnd()]); e=col([rnd(),rnd()]); ed=col([rnd(),rnd()])
    tau=Mt(o,o.q)*(dd+Kv*ed+Kp*e)+Ct(o,o.q,o.qd)*col(o.qd)+Gt(o,o.q)
    b=NE(o,o.q,o.qd,z); qdd=mp.lu_solve(Mt(o,o.q),tau-b)
    return nrm(dd-qdd+Kv*ed+Kp*e)
N.holds(17,f17,tol=TOL,stated_in_note=['constant gains'])
def f18(sg,qd0=False):
    def f():
        o=model(); qd=z if qd0 else o.qd
        qf=lambda t:[o.q[i]+qd[i]*t+o.qdd[i]*t*t/2 for i in(0,1)]
        X=D(lambda t:tip(o,qf(t)),mpf(0),2); Jd=D(lambda t:Jt(o,qf(t)),mpf(0))
        return nrm(col(o.qdd)-mp.lu_solve(Jt(o,o.q),X+sg*(Jd*col(qd))))
    return f
N.wrong(18,f18(1),(r'\ddot X+{}^{0}\dot J',r'\ddot X-{}^{0}\dot J'),f18(-1),'sign of the velocity term',wrong_term=r'+{}^{0}\dot J\,\dot\Theta',tol=TOL,
  special=[('the arm starts from rest (Thetadot = 0)',f18(1,True))],stated_in_note=['arm not singular'])
N.finish()
