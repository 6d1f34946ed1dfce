"""What is known of measured data before any fit: its noise, and whether it can be right."""
