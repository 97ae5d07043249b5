from orc import *
O=Orc('hoist.md')
def num(x,s):
    n=len(s.split('.')[1]) if '.' in s else 0; q=mp.nint(x*mpf(10)**n)/mpf(10)**n; return eq(q,mpf(s))
def train(J1,J2,r1,r2,R,m,M1,g):
    """unknown: motor and drum acceleration, tooth force, rope force, load acceleration, each from its own body"""
    x=solve(A([[J1,0,r1,0,0],[0,J2,-r2,R,0],[0,0,0,1,-m],[r1,-r2,0,0,0],[0,R,0,0,-1]]),A([M1,0,m*g,0,0]))
    return x
for trial in range(3):
    sets=[]
    J1,J2,r1,R,m,g,M1=rnd(.01,.1),rnd(.1,1),rnd(.02,.1),rnd(.1,.4),rnd(50,150),mpf('9.81'),rnd(50,300)
    i=rnd(2,5); r2=i*r1; t=rnd(1,3)
    gen=(J1,J2,r1,r2,R,m,M1,g)
    q=lambda s:mpf(s); giv=(q('0.020'),q('0.50'),q('0.050'),q('0.20'),q('0.25'),q(120),q(100),q('9.81'))
    N=train(*giv); ni=mpf(4); x=train(*gen); w1d,w2d,F,S,a=x
    w1=w1d*t; w2=w1*r1/r2; v=R*w2   # teeth roll: r1 w1 = r2 w2
    # i as ratio of teeth: teeth of one pitch
    O.rec(1,[eq(r2/r1,i),eq(giv[3]/giv[2],mpf(80)/20),num(mpf(80)/20,'4')]); O.rec(2,[eq(w1,i*w2)]); O.rec(3,[eq(v,R*w2),eq(v,R*w1/i)])
    T=J1*w1**2/2+J2*w2**2/2+m*v**2/2; J=2*T/w1**2; O.rec(4,[eq(J,J1+(J2+m*R**2)/i**2)])
    nJ=giv[0]+(giv[1]+giv[5]*giv[4]**2)/16; O.rec(5,[num(nJ,'0.52')])
    ML=m*g*R*w2/w1; nML=giv[5]*giv[7]*giv[4]/4; O.rec(6,[eq(ML,m*g*R/i),num(nML,'73.6')])
    O.rec(7,[eq(w1d,(M1-ML)/J),num(N[0],'50.8')])
    O.rec(8,[eq(a,R*w1d/i),num(N[4]*100,'3.18')],[eq(a,R*w1d/i),num(N[4],'3.18')],[[eq(a,R*w1d/i),num(N[4]*100,'318')]],bad={1})
    O.rec(9,[eq(a,R*(i*M1-m*g*R)/(J1+J2+m*R**2))],[eq(a,R*(i*M1-m*g*R)/(i**2*J1+J2+m*R**2))])
    O.rec(10,[eq(S,m*(g-a)),num(N[3],'796')],[eq(S,m*(g+a)),num(N[3],'1558')],[[eq(S,m*(g+a)),num(N[3]/1000,'1.56')]],bad={0,1})
    O.rec(11,[eq(F,(M1+J1*w1d)/r1),num(N[2]/1000,'2.02')],[eq(F,(M1-J1*w1d)/r1),num(N[2]/1000,'1.98')],bad={0,1})
    O.rec(12,[eq(J2*w2d,F*r2-S*R)])
    s=mp.quad(lambda u:a*u,[0,t]); O.rec(13,[eq(s,a*t**2)],[eq(s,a*t**2/2)])
    nT=nJ*(N[0]*2)**2/2; O.rec(14,[eq(T,J*w1**2/2),num(nT/1000,'2.69')])
    phi=mp.quad(lambda u:w1d*u,[0,t]); O.rec(15,[eq(M1*phi,T-m*g*s)],[eq(M1*phi,T+m*g*s)])
    O.rec(16,[eq(M1*phi/t*2,M1*w1),num(giv[6]*N[0]*2/1000,'10.2')])
    eta=rnd(.5,.95); Ms=m*g*v/(eta*w1)   # power out m g v over power in Ms w1
    O.rec(17,[eq(Ms,eta*m*g*R/i),num(nML/mpf('0.9'),'66.2')],[eq(Ms,m*g*R/(eta*i)),num(nML/mpf('0.9'),'81.8') if mp.nint(nML/mpf('0.9')*10)!=817 else mpf(0)],bad={0,1})
O.done()
