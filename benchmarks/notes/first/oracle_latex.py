"""Second pass: the LaTeX of the scalar lines (as written, corrected, other corrections) is parsed and evaluated on the models of the oracles."""
import json,re,io,contextlib
from texeval import *
with contextlib.redirect_stdout(io.StringIO()):
    import oracle_cart as A, oracle_hamilton as Hh, oracle_arm as B, oracle_impact as P
from vec import *; from mpmath import mpf,mp
import mpmath
T={}
for e in json.load(open('truth.json')): T[e['note'].split('.')[0],e['index']]=e
cnt=0
def res(ltx,env):
    ltx=ltx.replace(r'\boxed{','').replace(r'\begin{aligned}','').replace(r'\end{aligned}}','').replace(r'\end{aligned}','').replace(r'\begin{cases}','').replace(r'\end{cases}','')
    tot=mpf(0); ev=Ev(env)
    for part in re.split(r'\\qquad|\\\\(?!\[)|,\s*\\quad|\\Longrightarrow',ltx):
        part=re.sub(r'\\tag\{[^}]*\}','',part).strip().rstrip(',.').strip()
        if not part: continue
        sides=re.split(r'=|\\approx',part)
        v=[ev(s.strip()) for s in sides]; assert len(v)>1,part
        tot+=sum(abs(a-b) for a,b in zip(v,v[1:]))
    return tot
def test(note,k,envf,tol=mpf('1e-12'),scale=1,strip=None,cases=None):
    global cnt
    e=T[note,k]; S=strip or (lambda s:s)
    for _ in range(2):
        if e['verdict']=='wrong':
            assert res(S(e['latex']),envf())/scale>1e-6,(note,k)
            for c in [e['correction']]+e['other_corrections']: r=res(S(c),envf())/scale; assert r<tol,(note,k,c,r)
        else: r=res(S(e['latex']),envf())/scale; assert r<tol,(note,k,r)
    cnt+=1
def cart(**k):
    def f():
        o=A.model(**{q:(v() if callable(v) else v) for q,v in k.items()}); d={s:getattr(o,s) for s in('M','m','l','g','b','u')}
        d.update({'x':o.x,r'\dot x':o.xd,r'\ddot x':o.xdd,r'\theta':o.th,r'\dot\theta':o.td,r'\ddot\theta':o.tdd,'T':A.fT(*o.a),'V':A.fV(*o.a),'I_C':o.IC,'N':o.Hy,
          'v_C^2':(o.xd+o.l*o.td*o.c)**2+(o.l*o.td*o.s)**2,r'\frac{d}{dt}\left(\frac{\partial\mathcal L}{\partial\dot x}\right)':A.fdp(*o.a),
          'p_x':A.fp(*o.a),r'\frac{\partial\mathcal L}{\partial\dot x}':A.fp(*o.a),r'\varphi':o.th-mp.pi,r'\ddot\varphi':o.tdd})
        if o.tdd*o.th<0: d[r'\omega_0']=mpmath.sqrt(-o.tdd/o.th)
        if o.M>1e20: d[r'\lim_{M\to\infty}\omega_0']=mpmath.sqrt(-o.tdd/o.th)
        return d
    return f
for k in(3,4,5,6,8,9,10,15): test('cart',k,cart())
test('cart',11,cart(),strip=lambda s:s.replace(r'=\text{const}',''))
E=mpf(10)**-20
test('cart',12,cart(b=0,th=lambda:E*A.rnd(),td=E,u=lambda:E*A.rnd()),scale=E)
test('cart',17,cart(b=0,th=lambda:mp.pi+E*A.rnd(),td=E,u=lambda:E*A.rnd()),scale=E)
test('cart',13,cart(b=0,u=0,td=0,th=E)); test('cart',14,cart(b=0,u=0,td=0,th=E,M=mpf(10)**25))
def ham(**k):
    def f():
        o=Hh.model(**k); q=Hh.pd(o)
        return {r'\theta':o.th,r'\dot\theta':o.thd,r'\dot\phi':o.phd,r'\mu':o.mu,r'\ell':o.l,'g':o.g,'L':Hh.fL(*o.a),'H':Hh.H(o),'R':Hh.Rt(o),'p_\\theta':o.pt,'p_\\phi':o.pp,
          r'p_\phi^2':o.pp**2,r'p_\theta^2':o.pt**2,r'\dot p_\theta':q[0],r'\dot p_\phi':q[1],r'\theta_0':o.th,r'\omega_n^2':Hh.wn2(o) if k.get('w') is None else 0,r'\lim_{\theta_0\to0}\omega_n':mpmath.sqrt(Hh.wn2(o))}
    return f
for k in(1,3,5,7,9,12): test('hamilton',k,ham(),tol=mpf('1e-10'))
test('hamilton',13,ham(th=mpf('1e-6')),tol=mpf('1e-9'))
def cone():
    o=Hh.cone(); assert abs(o.thdd)<1e-40; return {r'\dot\phi^2':o.phd**2,'g':o.g,r'\ell':o.l,r'\theta_0':o.th}
test('hamilton',11,cone)
def hoop():
    a=Hh.hv(); return {'H':Hh.hH(*a),'E':Hh.hE(*a),'p':Hh.hp(*a),r'\theta':a[0],r'\mu':a[2],'a':a[3],'g':a[4],r'\Omega':a[5]}
for k in(17,18): test('hamilton',k,hoop)
def arm(f):
    def g():
        o=B.model(); d={s:getattr(o,s[0]+s[-1]) for s in('m_1','m_2','l_1','l_2','r_1','r_2','I_1','I_2','c_1','s_1','c_2','s_2')}
        d.update({'c_{12}':o.c12,'s_{12}':o.s12,'g':o.g,r'\dot\theta_1':o.qd[0],r'\dot\theta_2':o.qd[1],'h':o.m2*o.l1*o.r2*o.s2})
        d['X']=f(o); return d
    return g
def mat(k,f):
    """matrix lines: entry by entry"""
    global cnt
    e=T['arm',k]
    for key in('latex','correction'):
        if key not in e: continue
        body=re.search(r'\\begin\{bmatrix\}(.*?)\\end\{bmatrix\}',e[key],re.S).group(1); d=arm(f)(); X=d.pop('X'); ev=Ev(d)
        r=sum(abs(ev(c)-X[i,j]) for i,row in enumerate(body.split(r'\\')) for j,c in enumerate(row.split('&')))
        if e['verdict']=='wrong' and key=='latex': assert r>1e-6
        else: assert r<1e-12,(k,r)
    cnt+=1
mat(6,lambda o:matrix([*B.tip(o,o.q),0])); mat(7,lambda o:B.Jt(o,o.q)); mat(10,lambda o:B.Mt(o,o.q)); mat(12,lambda o:B.Ct(o,o.q,o.qd)); mat(13,lambda o:B.Gt(o,o.q))
def dt():
    d=arm(lambda o:mp.det(B.Jt(o,o.q)))(); d[r'\det{}^{0}J(\Theta)']=d.pop('X'); return d
test('arm',8,dt)
def im():
    o=P.imp(); return {'m_1':o.m1,'m_2':o.m2,'v_1':o.v1,'v_2':o.v2,"v_1'":o.w1,"v_2'":o.w2,'e':o.e,r'\Delta E':o.dE}
test('impact',5,im); test('impact',6,im)
def nu():
    o=P.num(); return {"v_1'":o.w1,"v_2'":o.w2,r'\Delta E':o.dE,r'\frac{\mathrm m}{\mathrm s}':mpf(1),r'\mathrm{kg}':mpf(1),r'\mathrm J':mpf(1)}
test('impact',7,nu); test('impact',8,nu)
def sl():
    o=P.slide(); return {r'\dot v':o.vd,r'\dot\omega':o.wd,r'\mu':o.mu,'g':o.g,'a':o.a,'v_0':o.v0,'t_1':o.t1,'v(t_1)':o.v1}
test('impact',10,sl); test('impact',11,sl)
def ro():
    m0,b,w,g,v0,t=rnd(5,8),rnd(.3,1),rnd(3,6),rnd(9,10),rnd(),rnd(1,3); m=lambda s:m0-b*s
    return {'v(t)':v0+mpmath.quad(lambda s:-g+w*b/m(s),[0,t]),'v_0':v0,'w':w,'g':g,'t':t,'m(t)':m(t),'m_0':m0}
test('impact',18,ro)
def inc():
    m,a,g,al=rnd(),rnd(),rnd(9,10),rnd(.3,1.2); Th=mpf(2)/5*m*a*a; vd,F=mp.lu_solve(matrix([[m,1],[Th/a,-a]]),matrix([m*g*mpmath.sin(al),0]))
    return {r'\dot v':vd,'g':g,r'\alpha':al,r'\Theta_S':Th,'m':m,'a':a}
test('impact',13,inc)
# rotating: polar components and the local components of the free fall
import importlib
with contextlib.redirect_stdout(io.StringIO()): import oracle_rotating as Q
def pol(s): return s.split('=',1)[1].replace(r'\overrightarrow{e_r}','|').replace(r'\overrightarrow{e_\theta}','|').split('|')[:2]
e=T['rotating',9]
for key in('latex','correction'):
    q,r=Q.rfun(),Q.rfun(); t=mpf('.3'); x=lambda s:r(s)*mpmath.cos(q(s)); y=lambda s:r(s)*mpmath.sin(q(s)); ax,ay=D(x,t,2),D(y,t,2); c,s_=mpmath.cos(q(t)),mpmath.sin(q(t))
    ev=Ev({'r':r(t),r'\dot r':D(r,t),r'\ddot r':D(r,t,2),r'\dot\theta':D(q,t),r'\ddot\theta':D(q,t,2)}); p=pol(e[key]); v=abs(ev(p[0])-(ax*c+ay*s_))+abs(ev(p[1].lstrip('+'))-(ay*c-ax*s_))
    assert (v>1e-6) if key=='latex' else (v<1e-12),v
cnt+=1
def ff():
    o=Q.earth(); v=rv(); g=rnd(9,10); a=V(0,0,-g)-2*cross(o.w,v)
    return {r'\ddot x':a[0],r'\ddot y':a[1],r'\ddot z':a[2],r'\dot x':v[0],r'\dot y':v[1],r'\dot z':v[2],'g':g,r'\Omega_T':o.Om,r'\lambda':o.lam}
test('rotating',12,ff)
def foc():
    o=Q.earth(); w0=rnd(2,3); return {'T_F':Q.TF(o,w0),r'\pi':mp.pi,r'\Omega_T':o.Om,r'\lambda':o.lam}
test('rotating',15,foc)
def loc():
    o=Q.earth(); return o
for key in('latex','correction'):
    o=Q.earth(); r=0
    for n,(name,other) in enumerate(((r'\overrightarrow{e_y}',r'\overrightarrow{e_z}'),(r'\overrightarrow{e_z}',r'\overrightarrow{e_y}'))):
        r+=abs(Ev({name:mpf(1),other:mpf(0),r'\Omega_T':o.Om,r'\lambda':o.lam})(T['rotating',10][key].split('=',1)[1])-o.w[1+n])
    assert (r>1e-6) if key=='latex' else (r<1e-12)
cnt+=1
print('LaTeX itself evaluated for',cnt,'lines: OK')
