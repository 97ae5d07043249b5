"""From a program and a target to functions: `Compiled`, its Jacobians, batches, events and inputs."""
