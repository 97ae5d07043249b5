"""Many bodies."""
