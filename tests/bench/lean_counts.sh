#!/usr/bin/env bash
# lean_counts.sh [SCENE [OPTIONS…]]: what effects cost that a scene does not call for. Counts the instructions of the
# workers of a render (by callgrind, so that the machine's load has no say) in the ordinary build and in the lean one, which
# knows no optional effect (core/render/optional_effects.h), and compares the images; of all scenes in tests/bench/lean where
# none is given. Builds both first, unless LEAN_NO_BUILD=1. Fails when a ratio is above 1.02, or images differ. The mesh of
# mesh.xml has 50,000 triangles, or LEAN_TRIANGLES; LEAN_KEEP=PREFIX keeps callgrind's files.
set -euo pipefail

root=$(cd "${BASH_SOURCE[0]%/*}/../.." && pwd)
scenes=("$root"/tests/bench/lean/*.xml)
[ $# -eq 0 ] || scenes=("$1")
options=("${@:2}")
largest=1.02
command -v valgrind >/dev/null || { echo "valgrind is not installed" >&2; exit 2; }

cd "$root"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if [ "${LEAN_NO_BUILD:-0}" != 1 ]; then
  for preset in release lean; do
    cmake --preset $preset >/dev/null
    ninja -C .build/$preset aerosol >/dev/null
  done
fi

# makeMesh TRIANGLES: a field of hills as a mesh with so many triangles, about.
makeMesh() {
  awk -v triangles="$1" 'BEGIN {
    n = int(sqrt(triangles / 2)); points = (n + 1) * (n + 1)
    printf "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n", points
    printf "element face %d\nproperty list uchar int vertex_indices\nend_header\n", 2 * n * n
    for (j = 0; j <= n; ++j) for (i = 0; i <= n; ++i) {
      x = 2 * i / n - 1; z = 2 * j / n - 1
      printf "%.6f %.6f %.6f\n", x, 0.12 * sin(9 * x) * cos(7 * z) + 0.01 * sin(80 * x + 50 * z), z
    }
    for (j = 0; j < n; ++j) for (i = 0; i < n; ++i) {
      a = j * (n + 1) + i; b = a + n + 1
      printf "3 %d %d %d\n3 %d %d %d\n", a, b, a + 1, a + 1, b, b + 1
    }
  }'
}
makeMesh "${LEAN_TRIANGLES:-50000}" > "$work/mesh.ply"

# count PRESET SCENE: prints the instructions.
count() {
  local preset=$1 scene=$2 counted
  # Roulette by contribution serves every scene in which paths are long, so no scene goes without it by itself.
  # Valgrind stops at AVX-512; sobol patterns, one thread and a fixed seed make counts repeatable.
  local command=("$root/.build/$preset/bin/aerosol" render "$scene" -o "$work/$preset.png" --isa avx2 --width 8
                 --threads 1 -q --checkpoint 0 --without contribution-roulette "${options[@]}")
  ! grep -qF '$mesh' "$scene" || command+=(-D "mesh=$work/mesh.ply")
  "${command[@]}" >&2  # Compiled shaders come from the cache.
  valgrind --tool=callgrind --callgrind-out-file="$work/$preset.out" \
    --toggle-collect='aerosol::render::Worker::run()' "${command[@]}" >&2 2>"$work/$preset.log" ||
    { cat "$work/$preset.log" >&2; return 1; }
  counted=$(sed -n 's/.*Collected : *\([0-9]*\).*/\1/p' "$work/$preset.log")
  [ "${counted:-0}" -gt 0 ] || { echo "$preset: nothing was counted" >&2; cat "$work/$preset.log" >&2; return 1; }
  [ -z "${LEAN_KEEP:-}" ] || cp "$work/$preset.out" "$LEAN_KEEP.$preset"
  echo "$counted"
}

# The files themselves say how long they took.
pixels() { tail -c "+$(grep -obUa IDAT "$1" | head -1 | cut -d: -f1)" "$1" | cksum; }

failed=0
for scene in "${scenes[@]}"; do
  ordinary=$(count release "$scene")
  lean=$(count lean "$scene")
  [ "$(pixels "$work/release.png")" = "$(pixels "$work/lean.png")" ] || { echo "$scene: the images differ"; failed=1; }
  awk -v name="$(basename "$scene")" -v a="$ordinary" -v b="$lean" -v largest=$largest 'BEGIN {
    printf "%s: %.0f instructions, %.0f in the lean build, ratio %.4f (at most %s)\n", name, a, b, a / b, largest
    exit a / b > largest }' || failed=1
done
exit $failed
