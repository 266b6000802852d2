"""Plays sequences on the FMU in processes of their own and judges what came back.

``python -m tests.fmu.fuzz.trial --first 1 --count 10000`` runs many; ``--first N --count 1
--show`` replays the one of a seed, call by call.
"""

import argparse
import json
import signal
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from stickslip_fmu.packer import build
from tests.fmu.fuzz.model import Model
from tests.fmu.fuzz.sequences import Call, sequence

PROCESS = Path(__file__).parents[1] / "inside" / "process.py"

# Processor time of one sequence [s], fifteen times what the longest takes.
SECONDS = 2.0
# After so many deaths of its processes the rest of a share is left.
_DEATHS = 3
# Of a process that is stuck without using the processor [s].
_STUCK = 600.0


@dataclass(frozen=True)
class Finding:
    """What a sequence was convicted of.

    ``position`` is the call at which it was seen; of a process that died it is the last.
    """

    calls: list[Call]
    position: int
    reason: str

    def __str__(self) -> str:
        lines = [f"{self.reason}, at call {self.position}:"]
        return "\n    ".join([*lines, *map(json.dumps, self.calls[: self.position + 1])])


class Trial:
    """Plays sequences on one FMU, and keeps count.

    Parameters
    ----------
    fmu
        The FMU.
    folder
        For what the processes read and write.
    seconds
        Processor time that one sequence may take [s].
    law
        Its friction law.

    Attributes
    ----------
    counts
        How often each function returned each status.
    """

    def __init__(
        self, fmu: Path, folder: Path, seconds: float = SECONDS, law: str = "coulomb"
    ) -> None:
        self.fmu = fmu
        self.folder = folder
        self.seconds = seconds
        self.law = law
        self.counts: Counter[tuple[str, int]] = Counter()

    def run(self, sequences: Sequence[list[Call]], processes: int = 1) -> dict[int, Finding]:
        """Return the findings by number of the sequence; a process that dies is begun anew."""
        findings: dict[int, Finding] = {}
        shares = [list(range(n, len(sequences), processes)) for n in range(processes)]
        for _ in range(_DEATHS):
            started = [
                (share, *self._start(n, sequences, share))
                for n, share in enumerate(shares)
                if share
            ]
            shares = []
            for share, process, outcomes in started:
                death = _death(process)
                with outcomes.open(encoding="utf-8") as lines:
                    judged = [
                        self._judge(sequences[n], line)
                        for n, line in zip(share, lines, strict=False)
                    ]
                for n, finding in zip(share, judged, strict=False):
                    if finding is not None:
                        findings[n] = finding
                left = share[len(judged) :]
                if death is None and not left:
                    continue
                # A process may also die at its end, of what the last one left.
                dead = left[0] if left else share[-1]
                calls = sequences[dead]
                findings[dead] = Finding(calls, len(calls) - 1, death or "the process stops")
                shares.append(left[1:])
        return findings

    def shrunk(self, finding: Finding, rounds: int = 40) -> Finding:
        """Return the same fault with fewer calls: those that it does without are left out."""
        calls = finding.calls[: finding.position + 1]
        best = finding
        size = max(len(calls) // 2, 1)
        while rounds > 0:
            shorter = [calls[:n] + calls[n + size :] for n in range(0, len(calls), size)]
            playable = [each for each in shorter if _playable(each)][:rounds]
            rounds -= len(playable)
            found = self.run(playable)
            same = [each for each in found.values() if each.reason == best.reason]
            if same:
                best = min(same, key=lambda each: each.position)
                calls = best.calls[: best.position + 1]
            elif size == 1:
                break
            size = max(min(size, len(calls)) // 2, 1) if not same else size
        return best

    def _start(
        self, n: int, sequences: Sequence[list[Call]], share: Sequence[int]
    ) -> tuple["subprocess.Popen[bytes]", Path]:
        calls, outcomes = self.folder / f"calls{n}", self.folder / f"outcomes{n}"
        with calls.open("w", encoding="utf-8") as target:
            target.writelines(json.dumps(sequences[number]) + "\n" for number in share)
        outcomes.write_bytes(b"")
        order = {"calls": str(calls), "outcomes": str(outcomes), "seconds": self.seconds}
        with (self.folder / f"errors{n}").open("wb") as errors:
            process = subprocess.Popen(
                [sys.executable, "-I", str(PROCESS), "player", "play", str(self.fmu)],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=errors,
                env={"TMPDIR": str(self.folder)},
            )
        assert process.stdin is not None
        with process.stdin as stream:
            stream.write(json.dumps(order).encode())
        return process, outcomes

    def _judge(self, calls: list[Call], line: str) -> Finding | None:
        outcomes: list[list[Any]] = json.loads(line)
        model = Model(self.law)
        for position, (call, outcome) in enumerate(zip(calls, outcomes, strict=True)):
            self.counts[_function(call), outcome[0]] += 1
            if call[0] in ("get_state", "set_state"):
                self.counts[f"{call[0]} in {model.where(call[1])}", outcome[0]] += 1
            objection = model.objection(call, outcome)
            if objection is not None:
                return Finding(calls, position, f"{call[0]}: {objection}")
        return None


def _death(process: "subprocess.Popen[bytes]") -> str | None:
    """Wait for a process; return how it died, or None."""
    try:
        code = process.wait(_STUCK)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        return "the process hangs"
    if code == -signal.SIGPROF:
        return "a call hangs"
    return None if code == 0 else f"the process ends by {_name(code)}"


def _name(code: int) -> str:
    return signal.Signals(-code).name if code < 0 else f"exit {code}"


def _function(call: Call) -> str:
    """Return what a call is counted under."""
    if call[0] in ("get", "set"):
        return f"{call[0]} {call[2]}"
    if call[0] == "status":
        return f"get {('', 'Real', 'Integer', 'Boolean', 'String')[call[2]]}Status"
    return str(call[2]) if call[0] == "derivatives" else str(call[0])


def _playable(calls: list[Call]) -> bool:
    """Whether each call has its instance."""
    alive = set()
    for name, *arguments in calls:
        if name == "instantiate":
            if arguments[0] in alive:
                return False
            alive.add(arguments[0])
        elif arguments and arguments[0] not in alive:
            return False
        elif name == "free":
            alive.remove(arguments[0])
    return bool(calls)


def table(counts: Counter[tuple[str, int]]) -> str:
    """Return how often each function gave which status, as lines of text."""
    kinds = {0: "OK", 2: "discard", 3: "error", 4: "fatal", -1: "not made"}
    lines = []
    for function in sorted({name for name, _ in counts}):
        found = {kinds[s]: counts[function, s] for s in kinds if counts[function, s]}
        lines.append(f"{function:34}" + "  ".join(f"{n:7} {word}" for word, n in found.items()))
    return "\n".join(lines)


def main(say: Callable[[str], None] = print) -> int:
    """Run the seeds that the command line asks for; return 1 where one is convicted."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--fmu", type=Path, help="another FMU than that of this source tree")
    parser.add_argument("--law", default="coulomb", help="the friction law of the FMU")
    parser.add_argument("--first", type=int, default=1, help="the first seed")
    parser.add_argument("--count", type=int, default=10_000, help="how many seeds")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--show", action="store_true", help="print every call of the first seed")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="fuzz-") as name:
        folder = Path(name)
        trial = Trial(asked.fmu or build(folder, law=asked.law), folder, law=asked.law)
        seeds = range(asked.first, asked.first + asked.count)
        sequences = [sequence(seed, asked.law) for seed in seeds]
        if asked.show:
            for call in sequences[0]:
                say(json.dumps(call))
        findings = trial.run(sequences, asked.processes)
        for number, finding in list(findings.items())[:10]:
            say(f"seed {seeds[number]}: {trial.shrunk(finding)}")
        calls = sum(map(len, sequences))
        say(
            f"{table(trial.counts)}\n{len(sequences)} sequences, {calls} calls, {len(findings)} bad"
        )
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
