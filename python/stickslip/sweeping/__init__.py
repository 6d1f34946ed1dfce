"""Sweeps: one scenario at many points, a summary each, and predictions made of them."""
