"""Search for the drive that walks best."""
