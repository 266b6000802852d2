"""What a worker does: it computes a chunk and writes its file, and answers in a few bytes."""

from __future__ import annotations

import os
import pickle
import platform
import threading
import time
from functools import lru_cache
from hashlib import sha256
from typing import NamedTuple

from ..one_thread import one_thread
from .chunk import failures, name_of, packed
from .manifest import STUDY, read_manifest, versions_here
from .store import Store, store_of
from .study import Chunk, Study, StudyError


class Job(NamedTuple):
    """A study for its workers: where it is, its key, and the SHA-256 of the pickled study."""

    address: str
    key: str
    study: str


class Done(NamedTuple):
    """A chunk is computed and its file written: the time taken [s], its bytes, its failures."""

    chunk: Chunk
    seconds: float
    size: int
    failed: int


class Failed(NamedTuple):
    """A chunk ends the study, for a reason in one line."""

    reason: str


class Lost(NamedTuple):
    """The worker of a chunk ended, in a way told in words."""

    chunk: Chunk
    end: str


_ONE_AT_A_TIME = threading.Lock()
"""A study need not be safe in threads, which a dask worker may have."""


def prepare() -> None:
    """Set up a worker process of this machine: it ends as soon as the one that started it does."""
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    from multiprocessing import parent_process

    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def work(job: Job, chunk: Chunk) -> Done | Failed:
    """Compute a chunk in a worker.

    It raises nothing: not every exception can be sent to another process.
    """
    with _ONE_AT_A_TIME:
        try:
            store, study = _opened(job)
        except Exception as error:
            return Failed(f"{_here()}: {reason(error)}")
        return compute(store, study, job.key, Chunk(*chunk))


@one_thread
def compute(store: Store, study: Study, key: str, chunk: Chunk) -> Done | Failed:
    """Compute a chunk of a study and write its file."""
    begun = time.perf_counter()
    try:
        columns = study.compute(*chunk)
    except Exception as error:
        return Failed(f"{chunk}: {reason(error)}")
    try:
        content = packed(chunk, key, columns)
        store.write(name_of(chunk), content)
    except Exception as error:
        return Failed(f"{reason(error)}; what is computed is kept, and the study resumes")
    return Done(chunk, time.perf_counter() - begun, len(content), failures(columns))


@lru_cache(maxsize=1)
def _opened(job: Job) -> tuple[Store, Study]:
    """Return the store and the study of a job.

    Raises
    ------
    StudyError
        If this worker does not see the folder, or has other versions.
    """
    store = store_of(job.address)
    manifest = read_manifest(store)
    if manifest is None or manifest.key != job.key:
        raise StudyError(f"does not see the study in {job.address}; name a folder that it shares")
    theirs, ours = manifest.versions, versions_here()
    for package in dict.fromkeys((*theirs, *ours)):
        here, there = ours.get(package, "none"), theirs.get(package, "none")
        if here != there:
            raise StudyError(f"has {package} {here}, and the study is begun with {there}")
    content = store.read(STUDY)
    if sha256(content).hexdigest() != job.study:
        raise StudyError(f"reads another study in {job.address}; name a folder that it shares")
    study: Study = pickle.loads(content)
    return store, study


def _here() -> str:
    return f"the worker on {platform.node()} (process {os.getpid()})"


def reason(error: BaseException) -> str:
    """Return what an exception says, in one line; an `OSError` of a file names it."""
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    text = " ".join(str(error).split())
    if isinstance(error, StudyError):
        return text
    return f"{type(error).__name__}: {text}" if text else type(error).__name__
