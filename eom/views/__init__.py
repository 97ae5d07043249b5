"""What people look at: pictures, animations and live pages, made from motions that `codegen` computes.

With `eom.commands` the outer layer: it sees both packages, and neither knows it.
"""
