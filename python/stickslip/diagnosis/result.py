"""The result of a diagnosis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip._util.files import file_names, write_together
from stickslip._util.html import page_text
from stickslip._util.messages import refuse
from stickslip._util.text import printable
from stickslip.diagnosis.decision.facts import Facts
from stickslip.diagnosis.report.numbers import numbers_of, summary_text
from stickslip.diagnosis.terms import amounts
from stickslip.diagnosis.terms.words import Words

if TYPE_CHECKING:
    from stickslip.diagnosis.report.pictures import Plots


@dataclass(frozen=True, repr=False, eq=False)
class Diagnosis(Facts):
    """Result of a diagnosis of a measurement, or of data with a model of one's own.

    The *recalibrated* model has its constants fitted within their priors. The *extended* model has
    the claimed cause besides; there is one for the verdicts named, dominant, pair and ambiguous,
    where it is that of the first member of the set.

    Attributes
    ----------
    findings : Findings
    measurement : Measurement, optional
        What was diagnosed; none for a model of one's own.
    notes : tuple of Note
        What a reader should know beside the verdict.
    """

    def __repr__(self) -> str:
        causes = [*self.verdict.causes[:3], "..."][: len(self.verdict.causes)]
        text = f"{self.verdict.kind} {printable(', '.join(causes))}".strip()
        if self.fitted:
            text += f", p = {self.findings.test.p_value:.2g}"
        return f"<Diagnosis of {len(self.problem.y)} readings: {text}>"

    def summary(self) -> str:
        """The verdict, what it rests on, the parameters and the leading candidates as text."""
        return summary_text(self.as_dict(), self.problem.words)

    def _repr_html_(self) -> str:
        said = {"r": self.as_dict(), "a": amounts, "w": Words(self.problem.words)}
        return page_text("diagnosis/report/notebook.html.j2", **said)

    @property
    def plot(self) -> Plots:
        """Pictures: `fit`, `residuals` and `law`, each a matplotlib figure."""
        from stickslip.diagnosis.report.pictures import Plots  # matplotlib, only where it draws

        return Plots(self)

    def as_dict(self) -> dict[str, Any]:
        """All numbers of the report, by the keys of the reference."""
        return numbers_of(self)

    def save_report(self, folder: str | PathLike[str], *, title: str | None = None) -> None:
        """Write the report into a folder, which is made.

        That is report.html, one page with all figures, and report.json with its numbers; of a
        measurement also extended.toml, a scenario with what was found. `title` is that of the
        page; a measurement has its name.

        Raises
        ------
        ScenarioError
            If `folder` is no path, or the extended model makes no scenario.
        OSError
            If a file cannot be written; then none is.
        """
        if not isinstance(folder, str | PathLike):
            refuse("folder", folder, "a path")
        from stickslip.diagnosis.report.files import save

        save(self, folder, title)

    def save_figures(
        self, folder: str | PathLike[str], formats: Sequence[str] = ("svg", "pdf")
    ) -> list[Path]:
        """Write the figures of the report into a folder, which is made, and return their paths.

        Of each table `fit`, of one that is drawn over a setting `residuals`, and `law` where there
        is one; none for the verdict data-problem. `formats` are suffixes that matplotlib can write.

        Raises
        ------
        ScenarioError
            If `folder` is no path.
        OSError
            If a file cannot be written.
        """
        if not isinstance(folder, str | PathLike):
            refuse("folder", folder, "a path")
        drawn = {name: each for name, each in self.plot.of_tables().items() if each is not None}
        writers = {
            Path(folder, f"{name}.{suffix}"): figure.savefig
            for name, figure in zip(file_names(drawn), drawn.values(), strict=True)
            for suffix in formats
        }
        Path(folder).mkdir(parents=True, exist_ok=True)
        write_together(writers)
        return list(writers)
