"""Measurements: what is fast, and how near the approximations come."""
