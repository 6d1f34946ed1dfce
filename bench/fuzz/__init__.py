"""Random scenarios and damaged files, and what must hold for every one of them."""
