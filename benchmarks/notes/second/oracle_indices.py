from orc import *
from itertools import product
O=Orc('indices.md')
R3=range(3)
dl=lambda i,j:mpf(int(i==j))
def expm(K):
    """series of the matrix exponential for jets: the definition of a rotation by the vector in K"""
    E=A([[Jet([dl(i,j)]) for j in R3] for i in R3]); T=E
    for k in range(1,70): T=(T@K)/mpf(k) if False else A([[x*(mpf(1)/k) for x in r] for r in (T@K)]); E=E+T
    return E
def crossmat(a): return skew(a)         # crossmat(a) b = a x b
def Rvec(phi):                           # number version
    return V(expm(crossmat(A([Jet([x]) for x in phi]))))
def ten(f,*dims): return A([f(*ix) for ix in product(*(range(d) for d in dims))]).reshape(dims)
E3=ten(EPS,3,3,3)
def ctr(a,b): return dot(a.ravel(),b.ravel())
for trial in range(3):
    n=unit(rvec()); chi=rnd(0.4,2.6); s,c=mp.sin(chi),mp.cos(chi)
    R=Rvec(n*chi)
    # the exponential is the right-handed active rotation: compare with geometry
    x=rvec(); assert eq(R@x,rot_about(n,chi)(x))<TOL
    O.rec(1,[eq(rot_about(n,chi)(x),R@x)])
    O.rec(2,[eq(R@R.T,eye()),eq(R.T@R,eye())])
    lhs=ten(lambda j,k,m,q:sum(EPS(i,j,k)*EPS(i,m,q) for i in R3),3,3,3,3)
    O.rec(3,[eq(lhs,ten(lambda j,k,m,q:dl(j,m)*dl(k,q)-dl(j,k)*dl(m,q),3,3,3,3))],[eq(lhs,ten(lambda j,k,m,q:dl(j,m)*dl(k,q)-dl(j,q)*dl(k,m),3,3,3,3))])
    N=ten(lambda i,j:-sum(EPS(i,j,k)*n[k] for k in R3),3,3); O.definition(4); assert eq(N@x,cross(n,x))<TOL
    O.rec(5,[eq(N@N,ten(lambda i,j:n[i]*n[j]-dl(i,j),3,3)),eq(N@N@N,-N)])
    O.rec(6,[eq(R,eye()+s*N+(1-c)*(N@N)),eq(R,ten(lambda i,j:c*dl(i,j)+(1-c)*n[i]*n[j]-s*sum(EPS(i,j,k)*n[k] for k in R3),3,3))])
    tr=R[0,0]+R[1,1]+R[2,2]
    O.rec(7,[eq(c,(tr+1)/2)],[eq(c,(tr-1)/2)])
    O.rec(8,[eq(n,ten(lambda i:sum(EPS(i,j,k)*R[k,j] for j in R3 for k in R3)/(2*s),3))])
    # 9
    n2=unit(rvec()); Ra=Rvec(n*rnd(0.5,2)); Rb=Rvec(n2*rnd(0.5,2)); Rc=Rvec(n*rnd(0.5,2))
    nn=unit(cross(n,n2)); h1,h2=Rvec(n*mp.pi),Rvec(nn*mp.pi)
    O.rec(9,[eq(Rb@Ra,Ra@Rb)],under=[eq(Rc@Ra,Ra@Rc)],alts=[[eq(h1@h2,h2@h1)],[eq(eye()@Ra,Ra@eye())]],general=[mpf(0)])
    e1,e2=[max(abs(y) for y in flat(Rvec(n*z)@Rvec(n2*z)-Rvec(n2*z)@Rvec(n*z))) for z in (mpf('1e-6'),mpf('1e-7'))]; assert abs(e1/e2-100)<1   # commute to first order
    # 10: order of the remainder
    u=rvec()
    def order(f): 
        a,b=[max(abs(y) for y in flat(f(mpf(10)**-k))) for k in (8,9)]; return mp.log10(a/b)
    def rem(sign):
        def f(z):
            p=u*z; pp=dot(p,p); return Rvec(p)-ten(lambda i,j:dl(i,j)-sum(EPS(i,j,k)*p[k] for k in R3)+(p[i]*p[j]+sign*pp*dl(i,j))/2,3,3)
        return f
    ow,oc=order(rem(1)),order(rem(-1)); assert abs(ow-2)<0.01 and abs(oc-3)<0.01,(ow,oc)
    O.rec(10,[mpf(1)],[mpf(0)])
    al,be=rvec(),rvec()
    def com(z):
        a,b=al*z,be*z; A1,B1=Rvec(a),Rvec(b); return A1@B1-B1@A1-ten(lambda i,j:a[j]*b[i]-a[i]*b[j],3,3)
    oo=order(com); assert abs(oo-3)<0.01,oo
    O.rec(11,[mpf(0)])
    # time dependent
    nj=unit(A([rjet() for _ in R3])); cj=Jet([rnd(0.4,2.6)]+[rnd() for _ in range(4)])
    Rj=expm(crossmat(A([a*cj for a in nj]))); R=V(Rj); Rd=V(D(Rj)); Om=Rd@R.T
    # angular velocity from the motion of body points: v = omega x x'
    X=[rvec() for _ in R3]; xs=[R@a for a in X]; vs=[Rd@a for a in X]
    M=np.concatenate([-skew(a) for a in xs[:2]]); bb=np.concatenate(vs[:2]); w=solve(M.T@M,M.T@bb)
    assert max(eq(cross(w,a),v) for a,v in zip(xs,vs))<TOL
    O.rec(12,[eq(Om,ten(lambda i,j:-sum(EPS(i,j,k)*w[k] for k in R3),3,3))])
    ex=lambda T:ten(lambda i:sum(EPS(i,j,k)*T[j,k] for j in R3 for k in R3),3)
    O.rec(13,[eq(w,ex(Om)/2)],[eq(w,-ex(Om)/2)],[[eq(w,ex(Om.T)/2)]])
    n0,nd=V(nj),V(D(nj)); c0,cd=cj.at(),cj.c[1]; s,c=mp.sin(c0),mp.cos(c0); nxn=ten(lambda i:sum(EPS(i,j,k)*n0[j]*nd[k] for j in R3 for k in R3),3)
    wb=R.T@w
    # body components by geometry: components along the turned axes
    wbg=A([dot(w,R@eye()[k]) for k in R3]); assert eq(wb,wbg)<TOL
    ndn=ten(lambda i:sum(EPS(i,j,k)*nd[j]*n0[k] for j in R3 for k in R3),3)
    # second alternative: epsilon_ijk nd_j n_k
    O.rec(14,[eq(w,cd*n0+s*nd-(1-c)*nxn)],[eq(w,cd*n0+s*nd+(1-c)*nxn)],[[eq(wbg,cd*n0+s*nd-(1-c)*nxn)],[eq(w,cd*n0+s*nd-(1-c)*ndn)]])
    O.rec(15,[eq(wbg,ten(lambda i:sum(R[j,i]*w[j] for j in R3),3))])
    # inertia of a cloud of points (integral = sum)
    P=[(rnd(0.5,2),rvec(3,-2,2)) for _ in range(6)]
    def Iof(pts): return ten(lambda i,j:sum(m*(dot(x,x)*dl(i,j)-x[i]*x[j]) for m,x in pts),3,3)
    Ib=Iof(P); O.definition(16)
    Ps=[(m,R@x) for m,x in P]; I=Iof(Ps)
    K=ten(lambda i,j:sum(m*x[i]*x[j] for m,x in Ps),3,3); tr=I[0,0]+I[1,1]+I[2,2]
    O.rec(17,[eq(K,tr*eye()-I)],[eq(K,tr*eye()/2-I)])
    O.rec(18,[eq(I,ten(lambda i,j:sum(R[k,i]*R[l,j]*Ib[k,l] for k in R3 for l in R3),3,3))],[eq(I,ten(lambda i,j:sum(R[i,k]*R[j,l]*Ib[k,l] for k in R3 for l in R3),3,3))])
    Pj=[(m,Rj@x) for m,x in P]; Ij=A([[sum((dot(x,x)*dl(i,j)-x[i]*x[j])*m for m,x in Pj) for j in R3] for i in R3]); Id=V(D(Ij))
    O.rec(19,[eq(Id,Om@I+I@Om)],[eq(Id,Om@I-I@Om)],[[eq(Id,Om@I+I@Om.T)],[eq(Id,ten(lambda i,j:sum(Om[i,k]*I[k,j]+Om[j,k]*I[i,k] for k in R3),3,3))]])
    Hj=sum((m*cross(x,D(x)) for m,x in Pj[1:]),Pj[0][0]*cross(Pj[0][1],D(Pj[0][1]))); tau=V(D(Hj))
    Omj=D(Rj)@Rj.T; wj=A([Omj[2,1],Omj[0,2],Omj[1,0]]); assert eq(V(wj),w)<TOL
    wd=V(D(wj)); wbd=V(D(Rj.T@wj)); taub=R.T@tau
    O.rec(20,[eq(taub,Ib@wbd+ten(lambda i:sum(EPS(i,j,k)*wb[j]*Ib[k,l]*wb[l] for j in R3 for k in R3 for l in R3),3))])
    # 21: rotation whose angular velocity is along a principal axis at the instant: eigenvector of I
    Im=mp.matrix([[I[i,j] for j in R3] for i in R3]); ev,Q=mp.eigsy(Im); pv=A([Q[i,0] for i in R3])
    def tau_for(w_,wd_,pts):
        # accelerations of a rigid body with given angular velocity and acceleration (space components)
        t=A([mpf(0)]*3)
        for m,x in pts: t=t+m*cross(x,cross(wd_,x)+cross(w_,cross(w_,x)))
        return t
    assert eq(tau_for(w,wd,Ps),tau)<TOL
    wp=pv*rnd(1,2); sph=[(mpf(1),a*sg) for a in eye() for sg in (1,-1)]; Isp=Iof(sph)
    O.rec(21,[eq(tau,I@wd)],under=[eq(tau_for(wp,wd,Ps),I@wd)],alts=[[eq(tau_for(w,wd,sph),Isp@wd)],[eq(tau_for(0*w,wd,Ps),I@wd)]],general=[eq(tau,I@wd+ten(lambda i:sum(EPS(i,j,k)*w[j]*I[k,l]*w[l] for j in R3 for k in R3 for l in R3),3))])
O.done()
