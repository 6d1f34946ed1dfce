"""Reports for a person: sentences, figures, the page, and the numbers of report.json."""
