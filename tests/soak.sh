#!/usr/bin/env bash
# Everything at full size, part by part: `make soak`, or tests/soak.sh FOLDER with the folder of the
# installed commands. Each part is a command that a person types. A part that fails does not stop
# the others; the exit code is 0 where all passed.
set -uo pipefail
root="$(dirname "$(realpath "$0")")/.."
bin="$(realpath "${1:-$root/.venv/bin}")"
cd "$root"
export VENV="${bin%/bin}"
spent=() failed=0

part() {
    local begun=$SECONDS
    echo "== $*"
    if "$@"; then passed=passed; else passed=FAILED failed=1; fi
    spent+=("$(printf '%5d s  %s  %s' $((SECONDS - begun)) "$passed" "$*")")
}

# All tests, with growth of the memory, fuzz and the page's settings in full, and the lines they run.
part make coverage TESTS="tests --soak"
# `make test` as on a machine that lacks much.
part "$bin/python" -m tests.bare none tests
# Every planted fault on every check, all tables.
part "$bin/stickslip" build --bare
part "$bin/python" -m stickslip_verification faults build/StickSlip.fmu --whole
part make docs-check

echo
printf '%s\n' "${spent[@]}"
exit "$failed"
