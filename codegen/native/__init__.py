"""The C compiler and its cache, children and memory; what loops and drivers hand each other."""
