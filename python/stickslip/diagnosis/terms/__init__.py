"""What may be in a model: parameters, causes, laws of a free shape, instruments."""
