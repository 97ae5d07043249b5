"""Many trajectories of one system, and their statistics."""
