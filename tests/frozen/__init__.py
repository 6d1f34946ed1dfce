"""Summaries of some 250 runs to the last bit: what no change of the code may change unseen."""
