"""stickslip side by side with general tools: `make bench-peers`; the protocol is in README.md."""
