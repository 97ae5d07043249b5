"""What was corrected in the lectures' displayed equations and claims, or read through, by identifier."""

from __future__ import annotations

NOTES = {
    "000:E1": "the momentum of an element is its velocity times dm: a dot is missing over R",
    "000:E3": "the second factor needs a dot; as written, a vector is crossed with itself",
    "000:E4": "four dots are missing, over R_C twice and over r twice",
    "000:E6": "dots are missing over the second R_C and the second r",
    "000:E14": "the tildes over both r are missing: a column times a column has no meaning",
    "000:E19": "the left side is the rate of h_C; the frames of both derivatives stand on the line",
    "000:E21": "the factor omega at the end needs a dot",
    "000:E22": "both derivatives lack their d: those of omega in I and in B",
    "000:E23": "the first omega needs a dot: J_C times the rate",
    "000:E24": "the dot belongs to omega on the left, a tilde to it on the right; and the remark "
    "beside it needs a point that is fixed in the body too",
    "000:E29": "frames I and B are missing at the derivatives",
    "000:E35": "the rate of h_C is zero, not h_C",
    "001:E2": "the derivative is that of omega of B in I",
    "001:E7": "three equations on three lines, set in one",
    "001:E11": "row 2 lacks I2 dOmega/dt; as written it holds for a constant spin rate only",
    "002:E6": "the double sum is struck out in the original: internal forces cancel in pairs",
    "002:E9": "the rate of the momentum equals the force, not the momentum itself",
    "002:E22": "the bullets are superscripts: the second inertial derivative",
    "002:E23": "the circle and the bullet stand as a dot product and a number",
    "002:E24": "both crosses are superscripts, read from the right",
    "002:E25": "both crosses are superscripts",
    "002:E26": "the bullets are superscripts: inertial derivatives",
    "002:E27": "the subscript is the centre of mass, and the left side its inertial rate",
    "002:E28": "the cross is a superscript, the subscript the centre of mass",
    "002:E31": "the factor C_BA between C_AB and the second rho is missing",
}
"""What was corrected, or read through."""

CLAIMS = {
    "000:C1": "Euler's equation about an inertially fixed point: it must be fixed in the body, too",
    "000:C2": "free rates change unless omega is along a principal axis; of a sphere, never",
    "000:C3": "free rates are constant if omega is along a principal axis, not any one axis",
    "000:C4": "constant rates need neither: a torque omega x J.omega keeps any rates, and without "
    "torque degenerate bodies keep rates along axes of their choice",
    "000:C5": "the magnitude of h_C is constant in all frames: without torque",
    "000:C6": "the energy of rotation is constant: without torque",
    "002:C1": "J_O is symmetric; positive definite unless all mass lies on a line through O",
    "002:C2": "a matrix of eigenvectors is a rotation only if they are unit vectors in right-handed order",
    "002:C3": "any continuum moves, in translation, like a point mass at its centre",
    "002:C4": "the second term of the torque vanishes about a fixed point and the centre of mass",
}
"""What the lectures claim in words, with what it takes to be true."""
