"""The field of the coils, of a map measured in the laboratory, and the fit of a map."""
