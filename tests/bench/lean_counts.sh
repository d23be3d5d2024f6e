#!/usr/bin/env bash
# lean_counts.sh [SCENE [OPTIONS…]]: what effects cost that a scene does not call for. Counts the instructions of the
# workers of a render (by callgrind, so that the machine's load has no say) in the ordinary build and in the lean one, which
# knows no optional effect (core/render/optional_effects.h), and compares the images. Builds both first, unless
# LEAN_NO_BUILD=1. Fails when the ratio is above 1.02, or the images differ.
set -euo pipefail

root=$(cd "${BASH_SOURCE[0]%/*}/../.." && pwd)
scene=${1:-$root/tests/bench/lean/simple.xml}
options=("${@:2}")
largest=1.02
command -v valgrind >/dev/null || { echo "valgrind is not installed" >&2; exit 2; }

cd "$root"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for preset in release lean; do
  if [ "${LEAN_NO_BUILD:-0}" != 1 ]; then
    cmake --preset $preset >/dev/null
    ninja -C .build/$preset aerosol >/dev/null
  fi
  # Valgrind stops at AVX-512; sobol patterns, one thread and a fixed seed make counts repeatable.
  command=("$root/.build/$preset/bin/aerosol" render "$scene" -o "$work/$preset.png" --isa avx2 --width 8 --threads 1 -q
           --checkpoint 0 "${options[@]}")
  "${command[@]}"  # Compiled shaders come from the cache.
  valgrind --tool=callgrind --callgrind-out-file="$work/$preset.out" \
    --toggle-collect='aerosol::render::Worker::run()' "${command[@]}" 2>"$work/$preset.log" ||
    { cat "$work/$preset.log" >&2; exit 1; }
  count=$(sed -n 's/.*Collected : *\([0-9]*\).*/\1/p' "$work/$preset.log")
  [ "${count:-0}" -gt 0 ] || { echo "$preset: nothing was counted" >&2; cat "$work/$preset.log" >&2; exit 1; }
  echo "$preset: $count instructions"
  declare "$preset=$count"
  [ -z "${LEAN_KEEP:-}" ] || cp "$work/$preset.out" "$LEAN_KEEP.$preset"
done
# The files themselves say how long they took.
pixels() { tail -c "+$(grep -obUa IDAT "$1" | head -1 | cut -d: -f1)" "$1" | cksum; }
[ "$(pixels "$work/release.png")" = "$(pixels "$work/lean.png")" ] || { echo "the images differ" >&2; exit 1; }
awk -v a="$release" -v b="$lean" -v largest=$largest \
  'BEGIN { printf "ratio: %.4f (at most %s)\n", a / b, largest; exit a / b > largest }'
