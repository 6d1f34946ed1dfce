"""The workers of a Dask cluster."""

from __future__ import annotations

import asyncio
import contextlib
import importlib
import logging
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from stickslip._util.extras import naming_the_extra
from stickslip.errors import ScenarioError

if TYPE_CHECKING:
    from concurrent.futures import Executor

_PATIENCE = 4.0
"""Time to reach the scheduler, and then to see a worker, s. Chosen: as long as a user waits."""


@contextlib.contextmanager
def cluster(address: str | None) -> Iterator[Executor | None]:
    """An executor of the cluster whose scheduler has this address; nothing without an address.

    A ScenarioError says that the scheduler does not answer or has no workers; an OSError that the
    cluster or a worker failed later.
    """
    if address is None:
        yield None
        return
    with naming_the_extra("--dask"):
        distributed = importlib.import_module("distributed")
    # Else it logs about an address that does not answer, beside the one line of the error.
    logging.getLogger("distributed").setLevel(logging.CRITICAL + 1)
    try:
        asyncio.run(_check_scheduler(distributed, address))
        client = distributed.Client(address, timeout=_PATIENCE, set_as_default=False)
    except Exception as error:  # depends on what the address is
        reason = " ".join(str(error).split()) or "it does not answer"
        if isinstance(error, MemoryError):  # the length of a message, read from another protocol
            reason = "what answers is no scheduler"
        raise ScenarioError(f"--dask {address}: there is no cluster: {reason}") from None
    with contextlib.closing(client):
        try:
            client.wait_for_workers(1, timeout=_PATIENCE)
        except TimeoutError:
            raise ScenarioError(f"--dask {address}: the cluster has no workers") from None
        try:
            yield client.get_executor()
        except Exception as error:
            own = isinstance(error, ScenarioError) or (
                isinstance(error, OSError) and not error.errno
            )
            if own:
                raise
            raise OSError(f"--dask {address}: {type(error).__name__}: {error}") from None


async def _check_scheduler(distributed: Any, address: str) -> None:
    """Raise an error if no scheduler answers; a client that finds none could not be closed."""

    async def ask() -> Any:
        async with distributed.rpc(address) as scheduler:
            return await scheduler.identity()

    identity = await asyncio.wait_for(ask(), _PATIENCE)
    if identity.get("type") != "Scheduler":
        raise ValueError(f"at this address is a {identity.get('type')}, not the scheduler")
