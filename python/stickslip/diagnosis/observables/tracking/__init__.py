"""Films of one run: frames folded on the drive's phase, and the forces that they show."""
