#!/usr/bin/env bash
# test.sh: installs what is missing, builds everything and runs all tests; then the unit tests, fuzz targets and hard cases
# again with sanitizers. `test.sh PRESET…` runs only those (release, sanitize, debug-O0, tsan), `test.sh all` these four: the
# unit tests without optimisation as well, and those that start threads with ThreadSanitizer. Fails when any test fails.
set -euo pipefail

root=$(cd "${BASH_SOURCE[0]%/*}/.." && pwd)
cd "$root"
presets=("$@")
[ ${#presets[@]} -gt 0 ] || presets=(release sanitize)
[ "${presets[*]}" != all ] || presets=(release sanitize debug-O0 tsan)
jobs=$(nproc)
failed=()
summaries=()
passedCount=0
failedCount=0

exec </dev/null
cmake/install_packages.sh

# A run must find its errors by itself, and never wait for a terminal.
# (OpenImageIO deletes its texture system by a size that is not its own.)
export ASAN_OPTIONS=detect_stack_use_after_return=1:strict_string_checks=1:new_delete_type_mismatch=0
export LSAN_OPTIONS=suppressions=$root/tests/sanitizers/leak.supp:print_suppressions=0
export UBSAN_OPTIONS=print_stacktrace=1
export TSAN_OPTIONS=halt_on_error=1:second_deadlock_stack=1:suppressions=$root/tests/sanitizers/thread.supp
export NINJA_STATUS='[%f/%t %es] '

# What took longest among the single cases of all binaries of one build.
printSlowest() {
  local results=$1/test_results
  [ -d "$results" ] || return 0
  echo "slowest cases:"
  find "$results" -name '*.xml' -exec sed -nE \
    's/.*<testcase name="([^"]*)".* time="([0-9.]+)".* classname="([^"]*)".*/\2 s  \3.\1/p' {} + |
    sort -rn | awk 'NR <= 10 { print "  " $0 }'
}

countTests() {
  local summary=$1 numbers
  # "98% tests passed, 1 tests failed out of 50"
  numbers=$(sed -nE 's/.*, ([0-9]+) tests? failed out of ([0-9]+).*/\1 \2/p' <<<"$summary")
  [ -n "$numbers" ] || return 1
  failedCount=$((failedCount + ${numbers% *}))
  passedCount=$((passedCount + ${numbers#* } - ${numbers% *}))
}

for preset in "${presets[@]}"; do
  started=$SECONDS
  echo "== $preset: build"
  cmake --preset "$preset"
  if ! cmake --build --preset "$preset"; then
    summaries+=("$preset: the build failed")
    failed+=("$preset")
    failedCount=$((failedCount + 1))
    continue
  fi
  echo "== $preset: built in $((SECONDS - started)) s; tests"
  started=$SECONDS
  log=.build/$preset/test_output.txt
  rm -rf ".build/$preset/test_results"
  ctest --preset "$preset" -j "$jobs" --no-tests=error 2>&1 | tee "$log" || failed+=("$preset")
  printSlowest ".build/$preset"
  summary=$(grep -E 'tests passed, [0-9]+ tests? failed out of' "$log" || echo "no tests were run")
  countTests "$summary" || failed+=("$preset")
  summaries+=("$preset: $summary in $((SECONDS - started)) s")
done

echo "== summary"
printf '%s\n' "${summaries[@]}"
echo "$passedCount passed, $failedCount failed"
[ ${#failed[@]} -eq 0 ]
