"""What a worker does: it computes a chunk and writes its file, and answers in a few bytes."""

from __future__ import annotations

import os
import pickle
import platform
import threading
import time
from functools import lru_cache
from typing import NamedTuple

from ..one_thread import one_thread
from .manifest import STUDY, changes, key_of, read_manifest, with_versions
from .results import failures, name_of, packed
from .store import Store, store_of
from .study import Chunk, Study, StudyError, reason


class Done(NamedTuple):
    """A chunk is computed and its file written: the time taken [s], its bytes, its failures."""

    chunk: Chunk
    seconds: float
    size: int
    failed: int


_ONE_AT_A_TIME = threading.Lock()
"""A study need not be safe in threads, which a dask worker may have."""


def work(address: str, key: str, chunk: Chunk) -> Done:
    """Compute a chunk in a worker; it raises `StudyError` alone, which all processes know."""
    with _ONE_AT_A_TIME:
        try:
            store, study = _opened(address, key)
        except Exception as error:
            here = f"the worker on {platform.node()} (process {os.getpid()})"
            raise StudyError(f"{here}: {reason(error)}") from None
        return compute(store, study, key, chunk)


@one_thread
def compute(store: Store, study: Study, key: str, chunk: Chunk) -> Done:
    """Compute a chunk of a study and write its file."""
    begun = time.perf_counter()
    try:
        columns = study.compute(*chunk)
    except Exception as error:
        raise StudyError(f"{chunk}: {reason(error)}") from None
    try:
        content = packed(chunk, key, columns)
        store.write(name_of(chunk), content)
    except Exception as error:
        kept = "what is computed is kept, and the study resumes"
        raise StudyError(f"{reason(error)}; {kept}") from None
    return Done(chunk, time.perf_counter() - begun, len(content), failures(columns))


@lru_cache(maxsize=1)
def _opened(address: str, key: str) -> tuple[Store, Study]:
    """Return the store and the study there; refuse another folder, and other versions."""
    store = store_of(address)
    manifest = read_manifest(store)
    if manifest is None or key_of(manifest) != key:
        raise StudyError(f"does not see the study in {address}; name a folder that it shares")
    if other := changes(manifest, with_versions(manifest)):
        raise StudyError(f"has other versions than the study: {other}")
    return store, pickle.loads(store.read(STUDY))
