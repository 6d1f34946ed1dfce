"""Helpers that know no robots: files, texts, tables, units, messages, HTML."""
