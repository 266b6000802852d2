"""A study computed: its chunks given to workers, and the results read back."""

from __future__ import annotations

import pickle
import time
import weakref
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from hashlib import sha256
from typing import Final

from .chunk import chunk_of, failures, name_of, unpacked
from .crew import Crew, cores, processes
from .crew import cluster as connected
from .manifest import STUDY, check_ours, manifest_of, settle
from .plan import Plan
from .results import Results
from .store import Store, store_of, temporary
from .study import Chunk, Progress, Study, StudyError
from .work import Done, Failed, Job, Lost, compute, reason

_SHORT: Final = 2.0
"""Seconds that are not worth starting worker processes, which takes one or two."""
_DEATHS: Final = 3
"""Workers that a chunk may end before it ends the study."""
_REPORT: Final = 0.5
"""Seconds between two reports of progress while nothing comes."""
_READERS: Final = 8
"""Chunk files that are read and checked at once when a study resumes."""


def run(
    study: Study,
    folder: str | None = None,
    *,
    workers: int | None = None,
    cluster: str | None = None,
    fresh: bool = False,
    progress: Callable[[Progress], None] | None = None,
) -> Results:
    """Compute a study.

    Workers write chunk files of about a second each, so that a study that was ended in any way
    resumes. A study of two seconds, or one with one worker, is computed in this process. A script
    that calls this starts its work below ``if __name__ == "__main__":``.

    Parameters
    ----------
    study
        What to compute.
    folder
        Where the chunks are kept, so that a study that was ended resumes: a folder, which other
        processes are kept from meanwhile, or an address of fsspec. None: a temporary folder.
    workers
        Processes on this machine; None: one a core.
    cluster
        Address of a dask scheduler, in place of `workers`; its workers share the folder.
    fresh
        Whether what `folder` holds of a study is thrown away.
    progress
        Called with how far the study is.

    Returns
    -------
    Results
        The same to the bit for any chunks, workers and order. Those of a temporary folder last as
        long as this object.

    Raises
    ------
    StudyError
        If the study cannot be computed to its end. What is computed is kept in `folder`.
    """
    if study.count < 1:
        raise StudyError("the study has no points")
    if workers is not None and workers < 1:
        raise StudyError(f"{workers} workers: at least 1 is needed")
    with ExitStack() as lasting, ExitStack() as stack:
        try:
            crew = None if cluster is None else stack.enter_context(connected(cluster))
            store = lasting.enter_context(temporary()) if folder is None else store_of(folder)
            check_ours(store)
            stack.enter_context(store.locked())
            running = _Running(study, store, fresh, progress)
            if crew is None:
                count = workers or cores()
                running.here(till=running.is_long if count > 1 else _never)
                if running.left:
                    local = stack.enter_context(processes(count))
                    running.here(till=lambda _: not local.starting)
                    crew = local
            if crew is not None:
                running.by(crew)
            results = Results(store, running.done, running.key)
        except OSError as error:
            raise StudyError(reason(error)) from error
        weakref.finalize(results, lasting.pop_all().close)
    return results


def _never(_: Done) -> bool:
    return False


class _Running:
    """A study on its way.

    Attributes
    ----------
    key
        That of its manifest.
    done
        The chunks that are computed.
    """

    def __init__(
        self,
        study: Study,
        store: Store,
        fresh: bool,
        progress: Callable[[Progress], None] | None,
    ) -> None:
        self._begun = time.monotonic()
        self._study, self._store, self._progress = study, store, progress
        try:
            content = pickle.dumps(study)
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            raise StudyError(f"the study cannot be sent to workers: {reason(error)}") from error
        manifest = manifest_of(study)
        settle(store, manifest, fresh=fresh)
        store.write(STUDY, content)
        self.key = manifest.key
        self._job = Job(store.address, self.key, sha256(content).hexdigest())
        self.done, self._failed = _computed_before(store, self.key)
        self._plan = Plan(study.count, study.quantum, self.done)
        self._kept = self._computed = study.count - self._plan.left
        self._report()

    @property
    def left(self) -> int:
        """How many points no worker has been given."""
        return self._plan.left

    def here(self, till: Callable[[Done], bool]) -> None:
        """Compute in this process, until a chunk is the last one or `till` says so of it."""
        while self.left:
            chunk = self._plan.take(workers=1)
            done = self._take(compute(self._store, self._study, self.key, chunk))
            self._report()
            if till(done):
                return

    def is_long(self, done: Done) -> bool:
        """Return whether the rest of the study takes long, by the time of a chunk."""
        # The first chunk also loads libraries, and tells little unless it is long itself.
        first = self._computed - self._kept == done.chunk.points
        seconds = done.seconds if first else done.seconds / done.chunk.points * self.left
        return self.left > 0 and seconds > _SHORT

    def by(self, crew: Crew) -> None:
        """Have workers compute the rest."""
        given, seen, deaths = 0, False, Counter[Chunk]()
        while self._plan.left or given:
            while self._plan.left and crew.idle:
                crew.give(self._job, self._plan.take(crew.workers))
                given += 1
            for answer in crew.answers(_REPORT):
                if isinstance(answer, Lost):
                    deaths[answer.chunk] += 1
                    if deaths[answer.chunk] == _DEATHS:
                        raise StudyError(
                            f"{answer.chunk} ended their worker process {_DEATHS} times: "
                            f"it {answer.end}"
                        )
                    crew.give(self._job, answer.chunk)
                else:
                    self._take(answer)
                    given -= 1
                    if not seen:
                        self._check_seen()
                    seen = True
            self._report(crew.note)
        self._check_seen()

    def _take(self, answer: Done | Failed) -> Done:
        if isinstance(answer, Failed):
            raise StudyError(answer.reason)
        self._plan.learn(answer.chunk.points, answer.seconds, answer.size)
        self.done.append(answer.chunk)
        self._computed += answer.chunk.points
        self._failed += answer.failed
        return answer

    def _check_seen(self) -> None:
        """Check that the files that workers wrote are in the folder that this process sees."""
        there = self._store.names()
        lost = next((each for each in self.done if name_of(each) not in there), None)
        if lost is not None:
            raise StudyError(
                f"{self._store.address}: {lost} are computed, and their file is not here; name a "
                "folder that all workers share"
            )

    def _report(self, note: str = "") -> None:
        if self._progress is not None:
            so_far = self._computed, self._study.count, self._failed
            self._progress(Progress(*so_far, time.monotonic() - self._begun, self._kept, note))


def _computed_before(store: Store, key: str) -> tuple[list[Chunk], int]:
    """Return the chunks that are whole, and their failures; a file that is not is removed."""
    found = sorted(filter(None, map(chunk_of, store.names())))

    def failed(chunk: Chunk) -> int | None:
        columns = unpacked(store.read(name_of(chunk)), chunk, key)
        return None if columns is None else failures(columns)

    done: list[Chunk] = []
    total = 0
    with ThreadPoolExecutor(_READERS) as readers:
        for chunk, count_of_failed in zip(found, readers.map(failed, found), strict=True):
            # A worker that outlived its study may have written a chunk that overlaps others.
            if count_of_failed is None or (done and chunk.start < done[-1].stop):
                store.remove(name_of(chunk))
            else:
                done.append(chunk)
                total += count_of_failed
    return done, total
