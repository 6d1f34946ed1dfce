"""The workers of a Dask cluster."""

from __future__ import annotations

import asyncio
import contextlib
import importlib
import logging
from collections.abc import Iterator
from concurrent.futures import Executor
from typing import Any

from stickslip._util.extras import naming_the_extra
from stickslip.errors import ScenarioError

_PATIENCE = 4.0
"""Time to reach the scheduler, and then to see a worker, s. Chosen: as long as a user waits."""


@contextlib.contextmanager
def cluster(address: str | None) -> Iterator[Executor | None]:
    """An executor of the cluster whose scheduler has this address; nothing without an address.

    A ScenarioError says that no scheduler with workers answers; an OSError that workers failed.
    """
    if address is None:
        yield None
        return
    with naming_the_extra("--dask"):
        distributed: Any = importlib.import_module("distributed")
    # Else it logs about an address that does not answer, beside the one line of the error.
    logging.getLogger("distributed").setLevel(logging.CRITICAL + 1)

    async def identity() -> Any:  # a client of what does not answer could not be closed
        async with distributed.rpc(address) as scheduler:
            return await scheduler.identity()

    async def check() -> None:
        await asyncio.wait_for(identity(), _PATIENCE)

    with contextlib.ExitStack() as stack:
        try:
            asyncio.run(check())
            client = distributed.Client(address, timeout=_PATIENCE, set_as_default=False)
            stack.enter_context(contextlib.closing(client))
            client.wait_for_workers(1, timeout=_PATIENCE)
        except Exception as error:  # depends on what the address is
            reason = " ".join(str(error).split()) or "it does not answer"
            raise ScenarioError(f"--dask {address}: there is no cluster: {reason}") from None
        try:
            yield client.get_executor()
        except (distributed.KilledWorker, distributed.client.FutureCancelledError) as error:
            raise OSError(f"--dask {address}: {error}") from None
