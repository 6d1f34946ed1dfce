"""The core beside motions that were measured."""
