"""Sections of a report: each has its `Numbers`, which it asks of `Facts`, and its template."""
