# Sourced by every test of the program as a process: `$aerosol` is the program, `$input` the folder of its inputs, and
# the current folder an empty one of its own.
set -euo pipefail

aerosol=$1
input=$(cd "${BASH_SOURCE[0]%/*}/input" && pwd)
work=$(mktemp -d)
trap 'chmod -R u+w "$work"; rm -rf "$work"' EXIT
cd "$work"
export XDG_CACHE_HOME=${XDG_CACHE_HOME:-$work/cache}
unset AEROSOL_SHADER_PATH OCIO

fail() {
  echo "FAILED: $*"
  for stream in out err; do
    [ ! -f "$work/$stream" ] || sed "s/^/  $stream: /" "$work/$stream"
  done
  exit 1
}

# expect CODE ARGS…: runs `aerosol ARGS…`, which must end with that code; its streams are in the files out and err.
expect() {
  local wanted=$1 code=0
  shift
  "$aerosol" "$@" >"$work/out" 2>"$work/err" || code=$?
  [ "$code" = "$wanted" ] || fail "aerosol $* ended with $code, not $wanted"
}

# said STREAM TEXT: the last program's stream contains the text.
said() {
  grep -qF -- "$2" "$work/$1" || fail "'$2' is not in $1"
}

# silent STREAM: the last program wrote nothing there.
silent() {
  [ ! -s "$work/$1" ] || fail "$1 is not empty"
}

# tree: every file of the current folder but the two streams.
tree() {
  find . -type f ! -name out ! -name err ! -path './cache/*' | sort | tr '\n' ' '
}

# hasOnly FILES: the current folder has just these files, separated by blanks.
hasOnly() {
  [ "$(tree)" = "${1:+$1 }" ] || fail "the folder has: $(tree)"
}
