"""What the intermediates of a recursion are called: letter, unit, meaning with the part's name."""

from __future__ import annotations

from typing import NamedTuple


class Row(NamedTuple):
    """Letter in names, unit, and meaning; ``{}`` is the body or joint."""

    letter: str
    unit: str
    meaning: str


LETTERS: dict[str, Row] = {
    "s": Row("s", "1", "sine of the angle of {}"),
    "c": Row("c", "1", "cosine of the angle of {}"),
    "place": Row("C", "1", "rotation to the axes of {}"),
    "r": Row("r", "m", "position of {}, in the axes of its parent"),
    "pose": Row("R", "1", "rotation from the ground to the axes of {}"),
    "position": Row("x", "m", "position of {}, in the axes of the ground"),
    "omega": Row("omega", "rad/s", "angular velocity of {}, in its axes"),
    "omega_before": Row("omega_p", "rad/s", "angular velocity of the parent, in the axes of {}"),
    "v": Row("v", "m/s", "velocity of the origin of {}, in its axes"),
    "square": Row("W", "rad^2/s^2", "products of the angular velocity of {}, less its square"),
    "difference": Row(
        "dW", "rad^2/s^2", "differences of the squares of the angular velocity of {}"
    ),
    "relative": Row("rho", "rad/s", "what the joint adds to the motion of {}"),
    "zeta": Row("zeta", "", "acceleration of {} by velocities alone"),
    "alpha_in": Row("beta", "rad/s^2", "angular acceleration of {} without its joint's"),
    "a_in": Row("b", "m/s^2", "acceleration of the origin of {} without its joint's"),
    "alpha": Row("alpha", "rad/s^2", "angular acceleration of {}, in its axes"),
    "a": Row("a", "m/s^2", "acceleration of the origin of {} less gravity, in its axes"),
    "mass": Row("m", "kg", "mass of {}, with what is fixed to it"),
    "h": Row("h", "kg m", "first moment of mass of {} about its origin"),
    "J": Row("J", "kg m^2", "inertia of {} about its origin"),
    "dJ": Row("dJ", "kg m^2", "difference of the moments of inertia of {}"),
    "n": Row("n", "N m", "moment on {} about its origin"),
    "f": Row("f", "N", "force on {}"),
    "n_bias": Row("n", "N m", "moment on {} and what hangs on it, by velocities and loads"),
    "f_bias": Row("f", "N", "force on {} and what hangs on it, by velocities and loads"),
    "n_free": Row("n_free", "N m", "the same with the joint free, in the axes of {}"),
    "f_free": Row("f_free", "N", "the same with the joint free, in the axes of {}"),
    "I": Row("I", "kg m^2", "articulated inertia of {}: moment by angular acceleration"),
    "H": Row("H", "kg m", "articulated inertia of {}: moment by acceleration"),
    "M": Row("M", "kg", "articulated inertia of {}: force by acceleration"),
    "composite_I": Row("I", "kg m^2", "inertia of {} and all that hangs on it, about its origin"),
    "composite_H": Row("H", "kg m", "first moments of {} and all that hangs on it"),
    "composite_M": Row("M", "kg", "mass of {} and all that hangs on it"),
    "I_free": Row("I_free", "kg m^2", "articulated inertia handed on by {}"),
    "H_free": Row("H_free", "kg m", "articulated inertia handed on by {}"),
    "M_free": Row("M_free", "kg", "articulated inertia handed on by {}"),
    "turned_I": Row("I_t", "kg m^2", "inertia handed on by {}, in the axes of its parent"),
    "turned_H": Row("H_t", "kg m", "inertia handed on by {}, in the axes of its parent"),
    "turned_M": Row("M_t", "kg", "inertia handed on by {}, in the axes of its parent"),
    "turned_n": Row("n_t", "N m", "moment handed on by {}, in the axes of its parent"),
    "turned_f": Row("f_t", "N", "force handed on by {}, in the axes of its parent"),
    "shifted_H": Row("H_s", "kg m", "inertia handed on by {}, about the origin of its parent"),
    "U": Row("U", "", "force on {} by a unit acceleration of its joint"),
    "inverse": Row("D_inv", "", "reciprocal of the inertia that the joint of {} moves"),
    "ratio": Row("K", "", "U of {} divided by the inertia that its joint moves"),
    "drive": Row("e", "", "force at the joint of {} that is left for acceleration"),
    "acceleration": Row("udot", "", "acceleration of the joint of {}"),
    "p": Row("p", "kg m/s", "momentum of {}"),
    "L": Row("L", "kg m^2/s", "angular momentum of {} about its origin"),
    "tau": Row("Q", "", "applied force or torque at the joint {}"),
    "stretch": Row("stretch", "", "coordinate of {} less its rest value"),
    "line": Row("d", "m", "second point of {} from its first, in the axes of the ground"),
    "distance": Row("l", "m", "distance of the points of {}"),
    "tension": Row("T", "N/m", "force of {} divided by the distance"),
    "entry": Row("M", "", "entry of the mass matrix"),
    "ground_axis": Row("s", "", "axis of the joint of {}, in the axes of the ground"),
    "ground_omega": Row("omega_g", "rad/s", "angular velocity of {}, in the axes of the ground"),
    "ground_alpha": Row("alpha_g", "rad/s^2", "angular acceleration of {} by velocities alone"),
    "ground_v": Row("v_g", "m/s", "velocity of the origin of {}, in the axes of the ground"),
    "ground_a": Row("a_g", "m/s^2", "acceleration of the origin of {} by velocities alone"),
    "spot": Row("x", "m", "position of a point of {}, in the axes of the ground"),
    "spot_v": Row("v_g", "m/s", "velocity of a point of {}, in the axes of the ground"),
    "spot_a": Row("a_g", "m/s^2", "acceleration of a point of {} by velocities alone"),
    "direction": Row("e", "1", "direction of the constraint {}, in the axes of the ground"),
    "lean": Row("lean", "1", "cosine between axis and normal of {}"),
    "lean_inverse": Row("lean_inv", "1", "reciprocal of the sine between axis and normal of {}"),
    "inverse_length": Row("length_inv", "1/m", "reciprocal of the length of {}"),
    "contact": Row("arm", "m", "arm from the centre to the point of contact of {}"),
    "row": Row("Jac", "", "coefficient of a speed in the constraint {}"),
    "offset": Row("b", "", "rate of the constraint {} without speeds"),
    "drift": Row("gamma", "", "second rate of the constraint {} by velocities alone"),
    "answer": Row("Y", "", "acceleration of a joint by a unit multiplier of {}"),
    "gram": Row("G", "", "how the constraint {} moves under multipliers"),
    "pivot": Row("D", "", "pivot of {}"),
    "pivot_inverse": Row("D_inv", "", "reciprocal of a pivot of {}"),
    "factor": Row("L", "", "entry of the triangular factor of {}"),
    "solved": Row("z", "", "intermediate of the solution for {}"),
    "lambda": Row("lambda", "", "multiplier of the constraint {}"),
    "follower": Row("W", "", "dependent speed by an independent one, constraint {}"),
    "followed": Row("w0", "", "dependent speed without independent ones"),
    "follower_drift": Row("g", "", "acceleration of a dependent speed by velocities alone"),
    "wrench": Row("Y", "", "force on {} by one unit of an inertial parameter"),
    "column": Row("F", "", "force on {} by a unit acceleration of a joint"),
}
"""Rows by what the recursions call them."""
