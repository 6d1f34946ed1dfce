"""The problem, its discrepancy, and the fits of models."""
