"""The workers of a Dask cluster, for a sweep."""

from __future__ import annotations

import asyncio
import contextlib
import importlib
import logging
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from stickslip.errors import ScenarioError
from stickslip.extras import naming_the_extra

if TYPE_CHECKING:
    from concurrent.futures import Executor

_PATIENCE = 4.0
"""Time to reach a scheduler, s. Chosen: as long as a user waits."""


@contextlib.contextmanager
def open_cluster(address: str | None) -> Iterator[Executor | None]:
    """Open an executor of the cluster whose scheduler has this address; None without an address."""
    if address is None:
        yield None
        return
    with naming_the_extra("--dask"):
        distributed = importlib.import_module("distributed")
    # Else it logs about an address that does not answer, beside the one line of the error.
    logging.getLogger("distributed").setLevel(logging.CRITICAL + 1)

    async def identity() -> Any:  # a client of what does not answer waits for ever
        async with distributed.rpc(address) as scheduler:
            return await asyncio.wait_for(scheduler.identity(), _PATIENCE)

    try:
        asyncio.run(identity())
        client = distributed.Client(address, timeout=_PATIENCE, set_as_default=False)
        client.wait_for_workers(1, timeout=_PATIENCE)
    except Exception as error:  # which depends on what the address is
        reason = str(error) or "it does not answer"
        raise ScenarioError(f"--dask {address}: there is no cluster: {reason}") from None
    with client:
        try:
            yield client.get_executor()
        except (ScenarioError, OSError):
            raise
        except Exception as error:  # of a worker
            raise OSError(f"--dask {address}: {type(error).__name__}: {error}") from None
