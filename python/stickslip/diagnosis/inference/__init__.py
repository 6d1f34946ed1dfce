"""What the fits mean: tests, comparison, held-out conditions, the verdict, what to measure next."""
