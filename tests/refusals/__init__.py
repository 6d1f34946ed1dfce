"""Tables of what is refused, and with which words: see `test_refusals`."""
