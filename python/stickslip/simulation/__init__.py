"""One run: simulating it, what it gives, and the files that hold it."""
