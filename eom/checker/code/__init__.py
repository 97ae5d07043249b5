"""Code for the rates of a system, compared with them as a black box.

In: values of both at random points. Out: which rates are wrong, and which slip explains them.
Imports: `eom.checker.mean`, `eom.errors`, `eom.exact`, `eom.system`.
"""
