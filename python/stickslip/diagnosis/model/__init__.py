"""What is fitted: the problem, the causes, and the simulator as a forward model."""
