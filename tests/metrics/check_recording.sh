#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_recording.sh ROOT TROCAR   the metrics of two recordings, of a scene and of a task, against tools/check-metrics; and a
# control: a value that was changed by a hundred-millionth of itself must be found. Exit status 3 where numpy is missing.
set -euo pipefail
root=$1 trocar=$2
"$root/tools/check-metrics" --check || exit $?
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

"$trocar" simulate "$root/scenes/demonstration.json" --ticks 600 --record scene.trocar >scene.txt
"$trocar" play novice --task peg_transfer --seconds 15 --seed 3 --record task.trocar >task.txt
for what in scene task; do
  "$trocar" metrics $what.trocar --json -o $what.json --trace $what.trace.json
  "$root/tools/check-metrics" --trace $what.trace.json --metrics $what.json
done

python3 - <<'PYTHON'
import json
document = json.load(open("scene.json"))
value = next(v for v in document["metrics"] if v["metric"] == "path_length")
value["value"] *= 1 + 1e-8
json.dump(document, open("wrong.json", "w"))
PYTHON
if "$root/tools/check-metrics" --trace scene.trace.json --metrics wrong.json >wrong.txt; then
  echo "a wrong value was not found"
  exit 1
fi
echo "a wrong value was found"
