#!/usr/bin/env bash
# check_layers.sh ROOT: fails with file:line for each include that breaks the rule of layers; rules.awk states the rule.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
cd "$1"

folders=()
for folder in core plugins tests; do
  if [ -d "$folder" ]; then folders+=("$folder"); fi
done
# First the names of all files, then all their include lines.
{
  find "${folders[@]}" \( -name '*.h' -o -name '*.inc' -o -name '*.cpp' \) | sed 's/^/file:/'
  grep -rnE --include='*.h' --include='*.inc' --include='*.cpp' '^[[:space:]]*#[[:space:]]*include' "${folders[@]}" || true
} | awk -f "$here/rules.awk"
