"""What no step may pass over: how far arguments may move, and which are watched."""
