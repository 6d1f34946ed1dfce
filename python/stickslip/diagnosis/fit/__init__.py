"""Fits: of the model without a cause, of single causes, of pairs, and along one parameter."""
