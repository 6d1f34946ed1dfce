"""From fitted models to one verdict."""
