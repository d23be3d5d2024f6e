#!/usr/bin/env bash
# run_long.sh [SECONDS [TARGET…]]: searches with every fuzz target (or those named: shader, shader_group, compiled_file,
# object_cache, scene, grid) for so long each (1800), two at a time, with bounded memory and time for an input. Builds them
# first (preset sanitize). What is found stays in .build/sanitize/fuzz_long/TARGET: inputs that end in a crash, a hang or
# too much memory as crash-*, timeout-* and oom-*; the corpus grows in corpus/. Fails when there is any.
set -euo pipefail

root=$(cd "${BASH_SOURCE[0]%/*}/../.." && pwd)
seconds=${1:-1800}
[[ $seconds =~ ^[0-9]+$ ]] || { echo "usage: ${0##*/} [SECONDS [TARGET…]]" >&2; exit 2; }
targets=("${@:2}")
if [ ${#targets[@]} -eq 0 ]; then
  for source in "$root"/tests/fuzz/*.cpp; do
    name=${source##*/}
    targets+=("${name%.cpp}")
  done
fi
jobs=${FUZZ_JOBS:-$(nproc)}
megabytes=${FUZZ_MEGABYTES:-2048}
inputSeconds=${FUZZ_INPUT_SECONDS:-25}

build=$root/.build/sanitize
cd "$root"
cmake --preset sanitize >/dev/null
ninja -C "$build" "${targets[@]/#/fuzz_}"

export ASAN_OPTIONS=detect_stack_use_after_return=1:strict_string_checks=1:new_delete_type_mismatch=0
export LSAN_OPTIONS=suppressions=$root/tests/sanitizers/leak.supp:print_suppressions=0
export UBSAN_OPTIONS=print_stacktrace=1

search() {
  local name=$1 out=$build/fuzz_long/$1 options=()
  mkdir -p "$out/corpus"
  [ -f "$root/tests/fuzz/$name.dict" ] && options+=("-dict=$root/tests/fuzz/$name.dict")
  options+=("$out/corpus")
  [ -d "$root/tests/fuzz/$name" ] && options+=("$root/tests/fuzz/$name")
  local status=0
  "$build/bin/fuzz_$name" -max_total_time="$seconds" -timeout="$inputSeconds" -rss_limit_mb="$megabytes" \
    -max_len=16384 -print_final_stats=1 -artifact_prefix="$out/" "${options[@]}" >"$out/log" 2>&1 </dev/null || status=$?
  local runs peak
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$out/log")
  peak=$(sed -n 's/^stat::peak_rss_mb: *//p' "$out/log")
  if [ "$status" -eq 0 ]; then
    echo "$name: ${runs:-?} inputs, at most ${peak:-?} MB, nothing found"
  else
    echo "$name: FAILED after ${runs:-?} inputs; see $out/log"
    grep -E 'ERROR|SUMMARY|Test unit written' "$out/log" | head -5 || true
    touch "$build/fuzz_long/failed"
  fi
}

mkdir -p "$build/fuzz_long"
rm -f "$build/fuzz_long/failed"
for name in "${targets[@]}"; do
  while [ "$(jobs -rp | wc -l)" -ge "$jobs" ]; do wait -n || true; done
  search "$name" &
done
wait
[ ! -e "$build/fuzz_long/failed" ]
