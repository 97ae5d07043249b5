import sys; sys.path.insert(0,'.')
from olib import *
u=rng(22); R=Rec('memo_kickstage',17)
m0,c,q,g=u(2,3),u(2,3),u(.3,.6),u(.1,.2); mpn=u(.8,1.2); mf=m0-mpn; tb=mpn/q
m=lambda t:m0-q*t
# 1: momentum balance on stage + expelled gas: thrust = c*q
t1=tb/3; h1=mpf(10)**-25; vf=lambda s:c*log(m0/m(s))
R.put(1,mx(m(t1)*d(vf,t1)-q*c, (m(t1+h1)*vf(t1+h1)+q*h1*(vf(t1)-c)-m(t1)*vf(t1))/h1 if abs((m(t1+h1)*vf(t1+h1)+q*h1*(vf(t1)-c)-m(t1)*vf(t1))/h1)>mpf(10)**-20 else 0),remark='momentum of gas expelled per time relative to the stage; identity F=q c (pressure part contained in effective c)')
R.put(2,mx(d(m,tb/3)+q,m(0)-m0,m(tb)-mf))
v0=quad(lambda t:q*c/m(t),[0,tb/2,tb])
R.put(3,mx(v0-c*log(m0/mf)),general=mx(quad(lambda t:q*c/m(t)-g,[0,tb])-c*log(m0/mf)))
R.put(4,0 if abs(3000*log(mpf(1200)/500)-2626)<mpf('.5') else 1,remark=mp.nstr(3000*log(mpf(1200)/500),8))
# 5: momentum balance: m(v+dv)-dm' ... -> m dv/dt = qc - m g.  check by an independent discrete balance
v=lambda t:c*log(m0/m(t))-g*t
t=tb/3; h=mpf(10)**-25
bal=(m(t+h)*v(t+h)+q*h*(v(t)-c)-m(t)*v(t))/h+m(t)*g       # stage + expelled gas = external impulse -m g
print('balance check of m dv/dt=qc-mg:',mp.nstr(bal,3))
R.put(5,mx(d(lambda s:m(s)*v(s),t)-q*c+m(t)*g),mx(m(t)*d(v,t)-q*c+m(t)*g),others=[mx(d(lambda s:m(s)*v(s),t)-q*(c-v(t))+m(t)*g)],only_if=[mx(d(lambda s:m(s)*v(s),mpf(0))-q*c+m(0)*g)])
vb=quad(lambda s:q*c/m(s)-g,[0,tb/2,tb])
R.put(6,mx(vb-c*log(m0/mf)+g*tb),general=mx(quad(lambda s:q*c/m(s)-g*(1-s/10),[0,tb])-c*log(m0/mf)+g*tb))
hb=quad(v,[0,tb/2,tb])
R.put(7,mx(hb-c*tb*(1-m0/mpn*log(m0/mf))+g*tb**2/2),mx(hb-c*tb*(1-mf/mpn*log(m0/mf))+g*tb**2/2))
tc=vb/g; hm=quad(lambda s:vb-g*s,[0,tc])+hb
R.put(8,mx(hm-hb-vb**2/(2*g)),general=mx(1/(1/mpf(600)-vb**2/(2*g*360000))-600-vb**2/(2*g)),remark='general: inverse-square gravity, start radius 600 instead of uniform g')
mu,r1=u(),u(.5,.9); r2=r1+u()
v1=sqrt(mu/r1); R.put(9,mx(v1**2/r1-mu/r1**2))
a=u(1,2); e=u(.1,.6); nu=u(); p=a*(1-e*e); r=p/(1+e*cos(nu)); hh=sqrt(mu*p); vr=mu/hh*e*sin(nu); vt=hh/r
# check the orbit solves the two-body law: d2r/dt2 - vt^2/r = -mu/r^2
rd=lambda x:mu/hh*e*sin(x); acc=d(rd,nu)*hh/r**2
print('two-body check:',mp.nstr(acc-vt**2/r+mu/r**2,3))
en=(vr**2+vt**2)/2-mu/r
R.put(10,mx(en+mu/a),mx(en+mu/(2*a)))
at=(r1+r2)/2; et=(r2-r1)/(r2+r1); ht=sqrt(mu*at*(1-et**2)); vper=ht/r1; vapo=ht/r2; v2=sqrt(mu/r2)
R.put(11,mx((vper-v1)-v1*(sqrt(2*r2/(r1+r2))-1)))
R.put(12,mx((v2-vapo)-v2*(1-sqrt(2*r2/(r1+r2)))),mx((v2-vapo)-v2*(1-sqrt(2*r1/(r1+r2)))),only_if=[mx(0-(1-sqrt(2*r1/(r1+r1))))])
tH=quad(lambda x:(at*(1-et**2)/(1+et*cos(x)))**2/ht,[0,pi/2,pi])
k=sqrt((r1+r2)**3/(8*mu)); R.put(13,mx(tH-2*pi*k),mx(tH-pi*k))
m1,m2,uu,ee,kk=u(),u(),u(),u(.2,.8),u()
V=m1*uu/(m1+m2); R.put(14,mx(m1*uu-(m1+m2)*V))
dE=m1*uu**2/2-(m1+m2)*V**2/2
R.put(15,mx(dE-m1**2*uu**2/(m1+m2)/2),mx(dE-m1*m2*uu**2/(m1+m2)/2),only_if=[mx(m1*uu**2/2-2*m1*(uu/2)**2/2-m1**2*uu**2/(2*m1)/2)])
a1=(m1-ee*m2)/(m1+m2)*uu; a2=(1+ee)*m1/(m1+m2)*uu
R.put(16,mx(m1*a1+m2*a2-m1*uu,a2-a1-ee*uu))
# spring: x1,x2 with k(x1-x2); s=x1-x2, s''=-k(1/m1+1/m2)s, s(0)=0,s'(0)=u
W=sqrt(kk*(1/m1+1/m2)); smax=uu/W
s=lambda t:uu/W*sin(W*t); x2=lambda t:V*t-m1/(m1+m2)*s(t); x1=lambda t:x2(t)+s(t)
dv2=d(lambda q_:V-m1/(m1+m2)*uu*cos(W*q_),mpf('.3')); print('spring check',mp.nstr(m2*dv2-kk*s(mpf('.3')),3))
R.put(17,mx(smax-uu*sqrt(m1*m2/(kk*(m1+m2))), kk*smax**2/2-(m1*uu**2/2-(m1+m2)*V**2/2)))
R.save()
