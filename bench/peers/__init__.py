"""stickslip beside general tools: `python -m bench peers`; the protocol is in README.md."""
