"""Films of one run: frames folded on the drive's phase, and their motion over a pulse."""
