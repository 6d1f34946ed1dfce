"""What a person reads: sentences, figures, the page, and the numbers of report.json."""
