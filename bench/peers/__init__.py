"""stickslip side by side with general tools: `python -m bench peers`; the protocol is in README.md."""
