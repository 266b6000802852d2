"""What the FMU does for the wrapper when the process ends."""

from pathlib import Path

from tests.fmu.running import inside


def test_a_binary_left_loaded_is_found_when_its_folder_is_gone(
    fmu_path: Path, tmp_path: Path
) -> None:
    """Only so can it be made to let go of the interpreter before that is gone too."""
    assert inside(fmu_path, "ending", "found_after_deletion", None, tmp_path) >= 1
