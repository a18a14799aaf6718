"""Slow twins of fast code, obviously right."""
