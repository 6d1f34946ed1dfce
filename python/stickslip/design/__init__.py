"""Design of drives: the drive that is best under limits, robust to uncertain parameters."""
