#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tests the tidy configuration itself: it finds every planted wrong name, and nothing in the file of right names.
# check_names.sh CLANG_TIDY CONFIG FOLDER
set -euo pipefail
clang_tidy=$1 config=$2 folder=$3

complaints() {
  "$clang_tidy" --config-file="$config" --quiet "$1" -- -std=c++20 2>/dev/null || true
}

status=0
right=$(complaints "$folder/right_names.cpp" | grep -E '(warning|error):' || true)
if [ -n "$right" ]; then
  echo "complaints about right names:"
  echo "$right"
  status=1
fi

wrong=$(complaints "$folder/wrong_names.cpp")
while IFS=: read -r line _; do
  if ! grep -qE "wrong_names.cpp:$line:[0-9]+: (warning|error): .*readability-identifier-naming" <<<"$wrong"; then
    echo "not found: line $line: $(sed -n "${line}p" "$folder/wrong_names.cpp")"
    status=1
  fi
done < <(grep -n '// wrong$' "$folder/wrong_names.cpp")
[ "$status" -ne 0 ] || echo "every planted name was found"
exit "$status"
