#!/usr/bin/env bash
# smoke_test.sh PROGRAM: the benchmark at equal time runs, keeps what it measures, and finds it again.
set -euo pipefail
program=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

"$program" --tiny --scene "embedded light" --scene "emissive wisps" -o "$folder/a.json" > "$folder/a.txt"
grep -q "simplest / automatic" "$folder/a.txt"
grep -q '"method": "automatic"' "$folder/a.json"
"$program" --tiny --scene "embedded light" --method simplest --compare "$folder/a.json" > "$folder/b.txt"
grep -q "embedded light, automatic  *[0-9]" "$folder/b.txt"

if "$program" --tiny --scene nowhere 2> "$folder/c.txt"; then exit 1; fi
grep -q "no scene 'nowhere'" "$folder/c.txt"
