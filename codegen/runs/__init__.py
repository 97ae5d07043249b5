"""One run: arguments in, a `Result` out, and how good it is."""
