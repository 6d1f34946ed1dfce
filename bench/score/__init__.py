"""Problems whose truth is known, for the score of the diagnosis; see `made` and `unlisted`."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from score.made import Made
    from stickslip import Series
    from stickslip.models.model import Model


def question(made: Made) -> tuple[Model, Series]:
    """Build the ready-made model and the log that a problem asks about."""
    from stickslip import Series, models  # the generators do without

    reads = {} if made.kind == "thermal" else {"reads": made.reads}
    model = getattr(models, made.kind)(**reads, without=made.without, **made.stated, **made.known)
    return model, Series(made.t, made.y, made.inputs, unit=made.unit)
