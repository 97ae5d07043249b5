import json, random, sys
import sympy as sp
random.seed(8)
class Oracle:
    def __init__(s,note): s.note=note; s.rows={}
    def zero(s,e):
        if isinstance(e,(list,tuple)) : return all(s.zero(x) for x in e)
        if isinstance(e,sp.MatrixBase): return all(s.zero(x) for x in e)
        e=sp.sympify(e)
        if e.is_number: return abs(complex(e.evalf(30)))<1e-12
        for _ in range(4):
            sub={x:sp.Rational(random.randint(200,1800),1000) for x in e.free_symbols}
            if abs(complex(e.subs(sub).evalf(40)))>1e-12: return False
        return True
    def ok(s,i,res,why=''):
        z=s.zero(res); s.rows.setdefault(i,[]).append(('true',z)); print(f'{s.note} #{i:2d} TRUE  residual zero: {z}   {why}')
    def wrong(s,i,res,cor,why=''):
        a,b=s.zero(res),s.zero(cor); s.rows.setdefault(i,[]).append(('wrong',(not a) and b))
        print(f'{s.note} #{i:2d} WRONG as written zero: {a}; correction zero: {b}   {why}')
    def done(s):
        T=[e for e in json.load(open('truth.json')) if e['note']==s.note]; good=True
        for e in T:
            r=s.rows.get(e['index'])
            if not r: print('NOT COVERED',e['index']); good=False; continue
            for k,v in r:
                if not v or (k=='wrong')!=(e['verdict']=='wrong'): print('MISMATCH',e['index'],k,v,e['verdict']); good=False
        print(s.note,'covered',len(s.rows),'of',len(T),'ALL GOOD' if good else 'FAIL'); sys.exit(not good)
