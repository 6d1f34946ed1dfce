"""Whether the tests see a change of the sources."""
