from orc import *
O=Orc('ladder.md')
for trial in range(3):
    m,l,g,th0=rnd(1,3),rnd(1,4),rnd(5,10),rnd(0.2,0.6); c0=mp.cos(th0)
    IC=mp.quad(lambda x:m/l*x**2,[-l/2,0,l/2])
    def newton(th,w,wall=True):
        """theta'', wall, floor force from Newton-Euler with forces at the ends; w = thetadot^2"""
        s,c=mp.sin(th),mp.cos(th)
        # x'' = l/2(th'' c - w s), y'' = -l/2(th'' s + w c); turn counterclockwise by theta
        foot=A([l*s,0]);top=A([0*s,l*c]);C=(foot+top)/2
        mom=lambda p,F:(p-C)[0]*F[1]-(p-C)[1]*F[0]
        tw=mom(top,A([1,0])); tf=mom(foot,A([0,1]))
        if wall: M=A([[m*l/2*c,-1,0],[-m*l/2*s,0,-1],[IC,-tw,-tf]]); b=A([m*l/2*w*s,m*l/2*w*c-m*g,0])
        else: M=A([[1,1,0],[-m*l/2*s,0,-1],[IC,0,-tf]]); b=A([0,m*l/2*w*c-m*g,0]); x=solve(M,b); M=A([[m*l/2*s,1],[IC,-tf]]); y=solve(A([[-m*l/2*s,-1],[IC,-tf]]),A([m*l/2*w*c-m*g,0])); return y[0],mpf(0),y[1]
        return tuple(solve(M,b))
    th=rnd(0.65,0.7) if mp.cos(mpf('0.7'))>2*c0/3 else th0+mpf('0.05')
    w=mp.quad(lambda x:2*newton(x,mpf(0))[0],[th0,th])
    assert abs(newton(th,mpf(0))[0]-newton(th,w)[0])<mpf(10)**-40
    thdd,Nw,Nf=newton(th,w); thd=mp.sqrt(w); s,c=mp.sin(th),mp.cos(th)
    T_=Jet([th,thd,thdd/2]); x=sin(T_)*(l/2); y=cos(T_)*(l/2)
    foot=A([l*s,0]); top=A([0*s,l*c]); Cm=(foot+top)/2
    O.rec(1,[eq(Cm,A([l/2*s,l/2*c]))]); O.rec(2,[eq(IC,m*l**2/12)])
    Tdm=mp.quad(lambda u:m/l/2*((u*l*0+ (1-u/l)*l*c*thd)**2+(u/l*l*s*thd)**2),[0,l])  # element at the distance u from the foot: x=(l-u)s, y=u c
    O.rec(3,[eq(Tdm,m/2*(x.d().at()**2+y.d().at()**2)+IC*thd**2/2),eq(Tdm,m*l**2*thd**2/6)])
    O.rec(4,[eq(m*g*y.at(),m*g*l*c/2)])
    O.rec(5,[eq(m*l**2*w/6,m*g*l/2*(c0+c))],[eq(m*l**2*w/6,m*g*l/2*(c0-c))])
    O.rec(6,[eq(w,3*g/l*(c0-c))]); O.rec(7,[eq(thdd,3*g/2/l*c)],[eq(thdd,3*g/2/l*s)])
    xdd,ydd=x.d().d().at(),y.d().d().at()
    O.rec(8,[eq(xdd,l/2*(thdd*c-w*s))]); O.rec(9,[eq(ydd,-l/2*(thdd*s-w*c))],[eq(ydd,-l/2*(thdd*s+w*c))])
    O.rec(10,[eq(Nw,m*xdd),eq(Nw,m*g*s*(3*c-2*c0)*3/4)])
    O.rec(11,[eq(Nf,m*g+m*ydd),eq(Nf,m*g/4*(1-6*c0*c+9*c**2))])
    O.rec(12,[eq(IC*thdd,l/2*(Nf*c-Nw*s))],[eq(IC*thdd,l/2*(Nf*s-Nw*c))],[[eq(IC*thdd,l/2*(-Nw*c+Nf*s))]])
    W=lambda q:mp.quad(lambda x:2*newton(x,mpf(0))[0],[th0,q])
    t1=mp.findroot(lambda q:newton(q,W(q))[1],(mp.acos(2*c0/3)-mpf('0.05'),mp.acos(2*c0/3)+mpf('0.04')),solver='anderson',tol=mpf(10)**-90,verify=False)
    O.rec(13,[eq(mp.cos(t1),2*c0/3)]); w1=W(t1); O.rec(14,[eq(w1,g/l*c0)])
    u1=l/2*mp.cos(t1)*mp.sqrt(w1)
    O.rec(15,[eq(u1,c0/2*mp.sqrt(g*l*c0))],[eq(u1,c0/3*mp.sqrt(g*l*c0))])
    # phase 2: dw/dth = 2 th''(th,w), linear in w: w' = p(th) w + q(th); integrating factor by quadrature
    q_=lambda x:2*newton(x,mpf(0),False)[0]; p_=lambda x:2*(newton(x,mpf(1),False)[0]-newton(x,mpf(0),False)[0])
    with mp.workdps(50):
        # th'' = [g s l/2 - l^2/4 s c w]/(I/m + l^2/4 s^2): factor mu = I/m + l^2/4 s^2 (checked), so (mu w)' = mu q
        mu=lambda x:IC/m+l**2/4*mp.sin(x)**2
        for xx in (t1,mpf('1.3')): assert abs(p_(xx)+l**2/2*mp.sin(xx)*mp.cos(xx)/mu(xx))<mpf(10)**-40
        w2=(mu(t1)*w1+mp.quad(lambda x:mu(x)*q_(x),[t1,mp.pi/2]))/mu(mp.pi/2)
    O.rec(16,[eq(w2,3*g/l*c0)],[eq(w2,3*g/l*c0-g/3/l*c0**3)],[[eq(w2,g*c0/l*(3-c0**2/3))]])
O.done()
