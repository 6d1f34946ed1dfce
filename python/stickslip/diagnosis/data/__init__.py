"""Measured data before any fit: their noise, and whether they can be right."""
