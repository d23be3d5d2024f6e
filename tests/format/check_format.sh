#!/usr/bin/env bash
# check_format.sh ROOT CLANG_FORMAT: fails with the list of C++ files that are not formatted as .clang-format says.
set -euo pipefail

cd "$1"
formatter=$2

list() { find core plugins tests -path tests/errors/shader -prune -o \( -name '*.cpp' -o -name '*.h' \) -print0; }

if [ -z "$(list | head -c 1 | tr -d '\0')" ]; then
  echo "no C++ files under $1" >&2
  exit 1
fi
output=$(list | xargs -0 -n 40 -P "$(nproc)" "$formatter" --dry-run -Werror 2>&1) && exit 0
files=$(sed -n 's/^\([^: ]*\):[0-9]*:[0-9]*: error:.*/\1/p' <<<"$output" | sort -u)
if [ -n "$files" ]; then
  echo "not formatted (cure: $formatter -i FILE…):"
  printf '%s\n' "$files"
else
  printf '%s\n' "$output"
fi
exit 1
