"""What `stickslip.predict` gives."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from stickslip._util.files import check_suffix, replacing
from stickslip.simulation.run import SUFFIXES

if TYPE_CHECKING:
    import xarray
    from pandas import DataFrame


@dataclass(frozen=True, repr=False, eq=False)
class Prediction:
    """Quantiles of the figures of a summary at the points of a sweep.

    Attributes
    ----------
    data : xarray.Dataset
        Dimensions and coordinates of the points, as `sweep` has them, and ``quantile``. For each
        number of a summary, such as `mean_velocity`, its quantiles over the draws that did not
        fail, and as `mean_velocity_error` the standard errors that they have because the draws are
        no more; NaN where too few draws did not fail. `failed` counts the draws that failed, at
        each point.
        Attributes hold scenario, values, seed, versions, and what the first failure says.
    """

    data: xarray.Dataset

    def __repr__(self) -> str:
        points = self.data["failed"].size
        failed = f"{self.failed} of {points * self.draws}" if self.failed else "none"
        levels = ", ".join(f"{each:g}" for each in self.data["quantile"].values)
        return (
            f"<Prediction of {points} {'points' if points != 1 else 'point'}, {self.draws} draws "
            f"each, {failed} failed, quantiles {levels}>"
        )

    @property
    def draws(self) -> int:
        """Number of draws at each point."""
        return int(self.data.attrs["draws"])

    @property
    def failed(self) -> int:
        """Number of simulations that failed, of all draws of all points."""
        return int(self.data.attrs["failed_draws"])

    @property
    def redrawn(self) -> int:
        """Number of draws that made no scenario, so that others took their place.

        The distribution is cut off there; with many of them the priors are not what was meant.
        """
        return int(self.data.attrs["redrawn"])

    def to_dataframe(self) -> DataFrame:
        """A row for each point: what was varied, `failed`, and the quantiles of each figure.

        The columns of `mean_velocity` are `mean_velocity_q10` and so on, in SI units.
        """
        import pandas as pd

        failed = self.data["failed"]
        columns = {
            str(name): values.broadcast_like(failed).transpose(*failed.dims).values.ravel()
            for name, values in failed.coords.items()
        }
        columns["failed"] = failed.values.ravel()
        for name in self._figures():
            for level in self.data["quantile"].values.tolist():
                values = self.data[name].sel(quantile=level).values.ravel()
                columns[f"{name}_q{100.0 * level:g}"] = values
        return pd.DataFrame(columns)

    def save(self, path: str | PathLike[str]) -> None:
        """Write `data` to a netCDF file, or `to_dataframe` to a CSV file, by the path's suffix.

        The headings of a CSV file name the units, such as ``mean_velocity_q10 (m/s)``.

        Raises
        ------
        ValueError
            If the suffix is none of ``.nc``, ``.nc4``, ``.h5`` and ``.csv``.
        OSError
            If the file cannot be written; an older file of that name is then untouched.
        """
        check_suffix(path, SUFFIXES)
        if Path(path).suffix.lower() != ".csv":
            from stickslip.simulation.record_file import write_netcdf

            write_netcdf(self.data, path)
            return
        table = self.to_dataframe()
        units = {name: self._unit(name.rpartition("_q")[0] or name) for name in table.columns}
        names = {name: f"{name} ({unit})" for name, unit in units.items() if unit not in ("", "1")}
        with replacing(path) as temporary:
            table.rename(columns=names).to_csv(temporary, index=False)

    def _figures(self) -> list[str]:
        return [str(name) for name in self.data.data_vars if f"{name}_error" in self.data]

    def _unit(self, name: str) -> str:
        return str(self.data[name].attrs.get("units", ""))
