"""The texts of integrators with their whole loop, by program."""
