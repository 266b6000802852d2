"""What a study and its workers agree on, and what a worker does.

The manifest of a folder says which study it holds, made with which versions. It is JSON: all that
the results depend on, as `identity`, `versions`, `count` and `quantum`, and how it was begun.
A worker computes a chunk and writes its file, and answers in a few bytes.
"""

from __future__ import annotations

import json
import os
import pickle
import platform
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from functools import cache, lru_cache
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final, NamedTuple, TypeAlias

from ..datasets import digest_of, provenance, versions
from ..one_thread import one_thread
from .store import (
    LOCK,
    PART,
    Chunk,
    Store,
    Study,
    StudyError,
    chunk_of,
    failures,
    name_of,
    packed,
    reason,
)

MANIFEST: Final = "manifest.json"
STUDY: Final = "study.pickle"
"""The file of the study itself, which the workers read."""

_FORMAT: Final = "stickslip study 1"
_FIELDS: Final = {"format", "identity", "versions", "count", "quantum", "command", "begun"}
_PACKAGES: Final = (
    *("fmi", "stickslip_design", "stickslip_fmu", "stickslip_native"),
    *("stickslip_ref", "stickslip_score", "stickslip_units", "stickslip_verification"),
)
"""Our packages that results are computed by."""
_SHOWN: Final = 3
"""Changes that a refusal names."""
_LONGEST: Final = 60
"""Characters of a value that a refusal shows."""

Manifest: TypeAlias = Mapping[str, Any]


def manifest_of(study: Study) -> Manifest:
    """Return the manifest of a study, with the versions that are installed here."""
    return with_versions(
        {
            "format": _FORMAT,
            # As a file gives it back: no tuples, every number as JSON writes it.
            "identity": json.loads(json.dumps(study.identity)),
            "versions": {},
            "count": study.count,
            "quantum": study.quantum,
            "command": provenance({})["command"],
            "begun": datetime.now(UTC).isoformat(timespec="seconds"),
        }
    )


def with_versions(manifest: Manifest) -> Manifest:
    """Return it as made with what is installed here, and a digest of our own sources."""
    return {**manifest, "versions": {**versions(), "sources": _sources()}}


@cache
def _sources() -> str:
    """Return a digest of the sources of our packages: the same release may be edited."""
    digest = sha256()
    for package in _PACKAGES:
        spec = find_spec(package)
        assert spec is not None
        assert spec.origin is not None
        folder = Path(spec.origin).parent
        for file in sorted(folder.rglob("*.[chp]*")):
            if file.suffix in {".py", ".c", ".h"}:
                digest.update(f"{package}/{file.relative_to(folder).as_posix()}\0".encode())
                digest.update(file.read_bytes())
    return digest.hexdigest()[:16]


def _decisive(manifest: Manifest) -> dict[str, Any]:
    points = {name: manifest[name] for name in ("count", "quantum")}
    return {"inputs": manifest["identity"], "versions": manifest["versions"], "points": points}


def key_of(manifest: Manifest) -> str:
    """Return the digest of all that the results depend on."""
    return digest_of(_decisive(manifest))


def changes(old: Manifest, new: Manifest) -> str:
    """Return in what another study or its versions differ, in words; empty if in nothing."""
    was, now = (dict(_leaves(_decisive(manifest))) for manifest in (old, new))
    names = [name for name in {**now, **was} if now.get(name) != was.get(name)]
    words = [
        "{} is {} and was {}".format(name, *_shown(now.get(name), was.get(name))) for name in names
    ]
    more = f", and {len(words) - _SHOWN} more" if len(words) > _SHOWN else ""
    return "; ".join(words[:_SHOWN]) + more


def _leaves(value: Any, name: str = "") -> Iterator[tuple[str, str]]:
    """Give the values of nested JSON in their order, each as text with its path."""
    if isinstance(value, Mapping) and value:
        for key, inner in value.items():
            yield from _leaves(inner, f"{name}.{key}" if name else str(key))
    else:
        yield name, json.dumps(value)


def _shown(*values: str | None) -> Iterator[str]:
    """Give two texts, cut to where they differ."""
    texts = ["not given" if value is None else value for value in values]
    pairs = enumerate(zip(*texts, strict=False))
    same = next((i for i, (one, other) in pairs if one != other), min(map(len, texts)))
    start = max(0, same - _LONGEST // 2)
    for text in texts:
        end = start + _LONGEST
        yield ("..." if start else "") + text[start:end] + ("..." if end < len(text) else "")


def read_manifest(store: Store) -> Manifest | None:
    """Return the manifest of a store, None if there is none; `StudyError` if its file is none."""
    try:
        content = json.loads(store.read(MANIFEST))
    except (FileNotFoundError, NotADirectoryError):
        return None
    except ValueError:
        content = None
    if not isinstance(content, dict) or content.keys() != _FIELDS or content["format"] != _FORMAT:
        raise StudyError(
            f"{store.address}: its {MANIFEST} is not one of a study; name another folder"
        )
    return content


@contextmanager
def begun(store: Store, new: Manifest, *, fresh: bool) -> Iterator[None]:
    """Lock a store that holds this study: the same one resumes, another is removed if `fresh`.

    Else a `StudyError` names the difference, or a file of a store that holds no study.
    """
    if read_manifest(store) is None:
        foreign = sorted(name for name in store.names() if not _is_ours(name))
        if foreign:
            raise StudyError(
                f"{store.address} holds no study, but other files ({foreign[0]}); name a new folder"
            )
    with store.locked():
        old = read_manifest(store)
        if old is not None and key_of(old) != key_of(new) and not fresh:
            raise StudyError(
                f"{store.address} holds results of another study: {changes(old, new)}; --fresh "
                "throws them away, another folder keeps them"
            )
        _remove_parts(store)
        if fresh:
            for name in filter(chunk_of, store.names()):
                store.remove(name)
        if old is None or fresh:
            store.write(MANIFEST, json.dumps(new, indent=2).encode() + b"\n")
        try:
            yield
        finally:
            # What is in its way must not hide why the study ended.
            with suppress(OSError):
                _remove_parts(store)


def _remove_parts(store: Store) -> None:
    """Remove what a process left that was ended while it wrote."""
    for name in filter(_is_part, store.names()):
        store.remove(name)


def _is_ours(name: str) -> bool:
    return name in {MANIFEST, STUDY, LOCK} or _is_part(name) or chunk_of(name) is not None


def _is_part(name: str) -> bool:
    return name.startswith(".") and name.endswith(PART)


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
    store = Store(address)
    manifest = read_manifest(store)
    if manifest is None or key_of(manifest) != key:
        raise StudyError(f"does not see the study in {address}; name a folder that it shares")
    if other := changes(manifest, with_versions(manifest)):
        raise StudyError(f"has other versions than the study: {other}")
    return store, pickle.loads(store.read(STUDY))
