from mpmath import mp, mpf, matrix, diff, cos, sin, sqrt, eye
import random
from common import rnd
def V(*a): return matrix(list(a))
def rv(n=3): return matrix([rnd(.2,2,True) for _ in range(n)])
def cross(a,b): return V(a[1]*b[2]-a[2]*b[1], a[2]*b[0]-a[0]*b[2], a[0]*b[1]-a[1]*b[0])
def dot(a,b): return sum(a[i]*b[i] for i in range(len(a)))
def nrm(a): return mp.norm(matrix(a), mp.inf) if not isinstance(a,(int,float,mpf)) else abs(a)
def sk(a): return matrix([[0,-a[2],a[1]],[a[2],0,-a[0]],[-a[1],a[0],0]])
def Rx(q): return matrix([[1,0,0],[0,cos(q),-sin(q)],[0,sin(q),cos(q)]])
def Ry(q): return matrix([[cos(q),0,sin(q)],[0,1,0],[-sin(q),0,cos(q)]])
def Rz(q): return matrix([[cos(q),-sin(q),0],[sin(q),cos(q),0],[0,0,1]])
def D(f,t,n=1):
    """derivative of a scalar, vector or matrix function of t"""
    f0=f(t)
    if not isinstance(f0, matrix): return diff(f,t,n)
    out=matrix(f0.rows,f0.cols)
    for i in range(f0.rows):
        for j in range(f0.cols):
            out[i,j]=diff(lambda s:f(s)[i,j],t,n)
    return out
def rfun():
    a,b,c,d,w=[rnd(.2,1.5,True) for _ in range(5)]
    return lambda t: a+b*t+c*t*t/2+d*sin(w*t)
def rvfun(n=3):
    f=[rfun() for _ in range(n)]
    return lambda t: matrix([g(t) for g in f])
def rrot():
    a,b,c=rfun(),rfun(),rfun()
    return lambda t: Rz(a(t))*Ry(b(t))*Rx(c(t))
def vee(W): return V(W[2,1],W[0,2],W[1,0])
def angvel(R,t):
    """angular velocity of the rotated triad, components in the reference frame; R: body comp -> reference comp"""
    return vee(D(R,t)*R(t).T)
def randrot(): return Rz(rnd(.2,3))*Ry(rnd(.2,1.3))*Rx(rnd(.2,3))
