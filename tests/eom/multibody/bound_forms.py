"""Small trees with constraints, of textbooks, whose closed forms several tests look at."""

import sympy as sp

from eom.multibody import Body, Equation, Joint, KnifeEdge, Loop, Motion, Placement, Rolling, Tree
from eom.quantities import TIME

m, r, g, R, l, J, m1, m2, m3, a = sp.symbols("m r g R l J m1 m2 m3 a", positive=True)
t = TIME
A, w, Omega = sp.symbols("A w Omega", positive=True)
DISC = (m * r**2 / 4, m * r**2 / 2, m * r**2 / 4)


def rolling_disc(names=("x", "y", "z", "yaw", "lean", "spin")):
    """A disc that rolls, placed by three displacements, yaw, lean and spin, one after the other."""
    kinds = ("prismatic",) * 3 + ("revolute",) * 3
    bodies = [*(f"body_{n}" for n in names[:-1]), "disc"]
    joints = [
        Joint(n, kind, before, after, axis)
        for n, kind, before, after, axis in zip(
            names, kinds, ["ground", *bodies], bodies, "xyzzxy", strict=False
        )
    ]
    heavy = Body("disc", m, inertia=DISC)
    floor = Rolling("floor", "disc", r, axis="y")
    made = [*(Body(b) for b in bodies[:-1]), heavy]
    return Tree("rolling_disc", made, joints, gravity=(0, 0, -g), constraints=[floor])


def free_disc(attitude="3-1-2"):
    """The same disc on one free joint."""
    free = Joint("disc", "free", "ground", "disc", attitude=attitude)
    floor = Rolling("floor", "disc", r, axis="y")
    heavy = Body("disc", m, inertia=DISC)
    return Tree("free_disc", [heavy], [free], gravity=(0, 0, -g), constraints=[floor])


def sleigh():
    """Chaplygin's sleigh: the runner is behind the centre of mass by a."""
    body = Body("sleigh", m, centre=(a, 0, 0), inertia=(0, J, J))
    edge = KnifeEdge("runner", "sleigh", "y")
    return Tree("sleigh", [body], [Joint("s", "planar", "ground", "sleigh")], constraints=[edge])


def knife_edge():
    """A knife edge on a slope along x."""
    bodies = [Body("along"), Body("across"), Body("knife", m, inertia=(0, J, J))]
    joints = [
        Joint("x", "prismatic", "ground", "along", "x"),
        Joint("y", "prismatic", "along", "across", "y"),
        Joint("turn", "revolute", "across", "knife", "z"),
    ]
    edge = KnifeEdge("edge", "knife", "y")
    return Tree("knife_edge", bodies, joints, gravity=(g / 2, 0, 0), constraints=[edge])


def bead(motion=None):
    """A bead on a hoop that turns about the vertical as is prescribed; the hoop holds it by two forces."""
    bodies = [Body("hoop"), Body("arm"), Body("slide"), Body("bead", m)]
    joints = [
        Joint(
            "hoop", "revolute", "ground", "hoop", "z", motion=motion or Motion(A * sp.sin(w * t))
        ),
        Joint("swing", "revolute", "hoop", "arm", "-y"),
        Joint("radius", "prismatic", "arm", "slide", "-z"),
        Joint("side", "prismatic", "slide", "bead", "y"),
    ]
    q = {j.name: j.coordinates[0].symbol for j in joints}
    held = [Equation("radial", q["radius"] - R), Equation("lateral", q["side"])]
    return Tree("bead_on_hoop", bodies, joints, gravity=(0, 0, -g), constraints=held)


def slider_crank():
    bodies = [
        Body("crank", m1, inertia=(J / 2, J / 2, J)),
        Body("rod", m2, (l / 2, 0, 0), (0, m2 * l**2 / 12, m2 * l**2 / 12)),
        Body("piston", m3),
    ]
    joints = [
        Joint("crank", "revolute", "ground", "crank"),
        Joint("pin", "revolute", "crank", "rod", on_parent=Placement((r, 0, 0))),
        Joint("piston", "prismatic", "ground", "piston", "x"),
    ]
    wrist = Loop("wrist", "revolute", "rod", "piston", on_first=Placement((l, 0, 0)))
    return Tree("slider_crank", bodies, joints, gravity=(0, -g, 0), constraints=[wrist])


SCENES = {
    "rolling_disc": rolling_disc,
    "free_disc": free_disc,
    "sleigh": sleigh,
    "knife_edge": knife_edge,
    "bead": bead,
    "slider_crank": slider_crank,
}
