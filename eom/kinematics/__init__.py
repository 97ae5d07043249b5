"""Frames, rotations and the coordinates of an attitude.

In: angles, quaternions, matrices, symbols. Out: vectors with frames, direction cosines, rates of
coordinates, derivatives seen from frames.
Imports: `eom.errors`, `eom.expressions`, `eom.quantities`, `eom.rotations`.
"""
