"""Names of other packages that are nearly right: what was probably meant is said."""

from stickslip import reproduce
from stickslip._util.prior import Prior
from stickslip.diagnosis import Cause, Parameter, Table, diagnose_model


def of_cause(_, freed):
    """A cause of a model of one's own, and the parameter that it frees."""
    slope = Parameter("slope", Prior("normal", 1.0, 0.1))
    table = Table({"x": [1.0]}, [1.0], sd=0.1)
    diagnose_model(lambda at, p: p["slope"] * at["x"], table, [slope], [Cause("a", frees=freed)])


WAYS = {
    "figure": lambda _, name: reproduce(only=[name]),
    "cause": of_cause,
}

REFUSALS = [
    ("figure", "fig112", 'did you mean "fig12"?'),
    ("cause", "slop", 'did you mean "slope"?'),
]
