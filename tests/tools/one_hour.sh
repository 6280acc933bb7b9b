#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# One hour of five-axis machining under tool centre point control: simulated, then replayed in
# stoppable mode. The real impeller program, twelve times in a row. Needs the shared data.
# Example: tests/tools/one_hour.sh build/host-release
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
axguard=$(realpath "${1:-$root/build/host-release}")/axguard
data=$(realpath "${AXG_SHARED_DATA:-$root/../shared/data}")
machine=$root/config/machines/probe-basic-xyzac.yaml
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
{
    echo 'o1 repeat [12]'
    tr -d '\r' <"$data/gcode/impeller_xyzac.ngc" | grep -v -i -E '^ *(%|M30|M2) *$'
    printf 'o1 endrepeat\nM2\n'
} >hour.ngc

TIMEFORMAT='  %R s on the wall, %U s of one core'
echo simulate
time "$axguard" simulate "$machine" hour.ngc -o hour.log --work-offset 'G54 Z-300'
printf '  trace: %d MB\n\nreplay\n' $(($(stat -c %s hour.log) / 1000000))
time "$axguard" replay "$machine" hour.log --mode stoppable --deadline-us 10000000 --details \
    --mesh-root "$data/machines/probe-basic-xyzac" >out
grep -E '^(hour|queries|stages|us per cycle|the permit|no stop|STOP)' out
