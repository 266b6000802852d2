"""Sweeps on a dask cluster: a real scheduler and its workers, on the loopback interface."""

from __future__ import annotations

from pathlib import Path

from stickslip_design.chunks import Progress, run
from stickslip_design.sweeps.study import prepare, release
from stickslip_native.packer import build
from tests.design.chunks.test_cluster import started
from tests.design.sweeps.test_processes import children_of, end_of
from tests.needs import needs

PLAN = {
    "stop_time": "3 s",
    "step": "3 s",
    "parameters": {"k": "500..3000 N/m log 200", "mu_s": "0.31..0.9 100", "c": 0.5},
    "outputs": {"delta_x": "last", "T": "last", "x": "last"},
}


@needs("cc", "cluster")
def test_a_killed_worker_leaves_the_results_as_they_are(tmp_path: Path) -> None:
    """To the bit, of 20,000 runs of the native FMU; what holds its FMUs does not outlive it."""
    study = prepare(build(tmp_path / "native.fmu", this_machine=True), PLAN)
    assert study.count == 20_000
    ended: list[int] = []
    with started(tmp_path) as dask:
        dask.add_worker()
        dask.add_worker()

        def disturb(progress: Progress) -> None:
            victim = dask.workers[0]
            if not ended and progress.done > 5000 and (its := children_of(victim.pid)):
                ended.extend([*its, *children_of(its[0])])
                victim.kill()

        found = run(study, str(tmp_path / "study"), cluster=dask.address, progress=disturb).read()
        assert dask.workers[0].wait(10.0) == -9
    undisturbed = run(study, workers=1).read()
    release()
    assert not any(found["failure"])
    for name in study.job.columns:
        assert found[name].tobytes() == undisturbed[name].tobytes()
    for each in ended:
        end_of(each)
