"""Blind study of the diagnosis: data from the independent simulator of the tests, answers apart."""
