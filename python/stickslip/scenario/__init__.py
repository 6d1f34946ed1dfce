"""Scenarios: keys, sections, waveforms, effects, uncertain parameters, and their files."""
