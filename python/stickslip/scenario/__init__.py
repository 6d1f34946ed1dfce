"""All that defines one simulation: keys, sections, waveforms, effects, and their files."""
