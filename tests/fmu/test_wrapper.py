"""What a master may do wrong, and what comes of it: the table in docs/importing.md, kept true."""

from pathlib import Path
from typing import Any

import pytest

from tests.fmu.running import inside

OK, DISCARD, ERROR, FATAL = 0, 2, 3, 4

# What each mistake gives. A True at the end: the instance comes back by a reset and goes on.
SURVIVED: dict[str, Any] = {
    "wrong_guid": True,
    "null_guid": True,
    "model_exchange": True,
    "empty_name": True,
    "long_name": True,
    "name_with_formats": True,
    "name_in_utf8": True,
    "null_callbacks": True,
    "folder_without_scheme": True,
    "folder_with_end_slash": True,
    "folder_with_blank": True,
    "free_null_instance": None,
    "two_failures": [FATAL, FATAL, True],
    "failure_then_free": FATAL,
    "free_without_set_up": None,
    "state_of_another_instance": [OK, OK, True],
    "free_null_state": [OK, True],
    "free_state_twice": [OK, True],
    "set_freed_state": [FATAL, True],
    "set_state_that_a_failed_get_left_null": [FATAL, FATAL, True],
    "bytes_too_few": [OK, FATAL, True],
    "no_bytes": [FATAL, True],
    "bytes_of_nonsense": [FATAL, True],
    "nothing_by_null_lists": [OK, True],
    "text_null": [FATAL, True],
    "text_not_utf8": [FATAL, True],
    "category_unknown": [OK, True],
    "status_of_unknown_kinds": [ERROR, DISCARD, DISCARD, DISCARD, DISCARD, True],
    "what_is_not_offered": [ERROR, ERROR, ERROR, ERROR, OK, True],
}

# What ends the process, and why the FMU cannot help it.
NOT_SURVIVED = {
    "null_name": "the wrapper makes a C++ string of it before the FMU exists",
    "name_not_utf8": "the wrapper's own arguments for the slave cannot be made, and it goes on",
    "null_resources": "the wrapper makes a C++ string of it before the FMU exists",
    "no_such_folder": "the wrapper finds no slave and cleans up what it has not made yet",
    "folder_with_one_slash": "the wrapper takes the URI for a path, and finds no slave there",
    "folder_with_host": "the wrapper takes the host for a folder, and finds no slave there",
    "folder_with_escape": "the wrapper does not decode it, and finds no slave there",
    "null_callbacks_with_logging": "the wrapper calls the logger without a look",
    "null_logger_with_logging": "the wrapper calls the logger without a look",
    "free_instance_twice": "the wrapper deletes what is deleted, without a call to the slave",
    "step_null_instance": "the wrapper reads at NULL, without a call to the slave",
    "step_freed_instance": "the wrapper reads freed memory, without a call to the slave",
    "free_state_by_null_pointer": "the wrapper reads at NULL, without a call to the slave",
    "set_null_state": "the wrapper fails before its call to the slave, and releases the instance",
    "serialize_null_state": "the wrapper fails before its call to the slave, and releases it",
    "state_that_is_no_pointer": "the wrapper counts a reference there, before its call",
    "bytes_far_too_many": "the wrapper copies as many as are asked for, whatever there is",
    "bytes_to_null": "the wrapper writes to NULL, after its call to the slave",
    "bytes_beyond_memory": "the wrapper fails before its call to the slave, and releases it",
    "one_by_null_list": "the wrapper reads at NULL, before its call to the slave",
    "one_to_null_list": "the wrapper writes to NULL, after its call to the slave",
    "count_beyond_memory": "the wrapper writes to a list that it could not make",
    "category_null": "the wrapper makes a C++ string of it and calls no slave",
    "categories_beyond_memory": "the wrapper makes room for them and calls no slave",
    "status_to_null": "the wrapper writes to NULL and calls no slave",
}


@pytest.fixture(scope="module")
def seen(fmu_path: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Return what came of each mistake, tried in a process of its own."""
    folder = tmp_path_factory.mktemp("wrapper")
    found: dict[str, Any] = inside(fmu_path, "wrapper", "mistakes", None, folder, spoil_freed=True)
    return {name: outcome for name, (_, outcome) in found.items()}


def test_every_mistake_is_sorted(seen: dict[str, Any]) -> None:
    """Each mistake that is tried is said to be survived, or not."""
    assert sorted(seen) == sorted([*SURVIVED, *NOT_SURVIVED])


@pytest.mark.parametrize("mistake", SURVIVED)
def test_a_mistake_is_survived(seen: dict[str, Any], mistake: str) -> None:
    """The process goes on, and the call has the status that the table gives."""
    assert seen[mistake] == SURVIVED[mistake]


@pytest.mark.parametrize("mistake", NOT_SURVIVED)
def test_a_mistake_ends_the_process(seen: dict[str, Any], mistake: str) -> None:
    """What the table says is not survived is not; else the table would frighten without need."""
    assert seen[mistake] in ("SIGSEGV", "SIGABRT", "SIGBUS"), NOT_SURVIVED[mistake]
