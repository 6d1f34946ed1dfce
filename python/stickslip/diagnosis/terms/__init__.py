"""Terms of a model: parameters, causes, laws of a free shape, instruments."""
