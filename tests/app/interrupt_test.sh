#!/usr/bin/env bash
# SIGINT and SIGTERM: the image so far is written; a second signal ends the program.
source "${BASH_SOURCE[0]%/*}/library.sh"
set -m  # Children of a shell without job control ignore SIGINT.

# Shaders in the cache: nothing takes long before the render begins.
expect 0 render "$input/fog.xml" --quiet -o first.png
rm first.png

# start ARGS…: a render that takes hours, in the background; waits until it is under way.
start() {
  "$aerosol" render "$input/fog.xml" --spp 100000000 "$@" >out 2>err &
  child=$!
  for _ in $(seq 300); do
    sleep 0.1
    # A render under way works with its threads: the program's own, the watch and two more.
    [ "$(ls /proc/$child/task 2>/dev/null | wc -l)" -lt 4 ] || break
  done
  sleep 1
}

# ended CODE: the render has to end with that code.
ended() {
  local code=0
  wait $child || code=$?
  [ "$code" = "$1" ] || fail "ended with $code, not $1"
}

for signal in INT TERM; do
  echo "-- $signal"
  start -o a.exr -o a.png --threads 2
  kill -$signal $child
  ended 3
  said err "interrupted, writing what there is"
  said err "wrote a.exr"
  hasOnly "./a.exr ./a.png"
  for entry in aerosol:interrupted aerosol:spp aerosol:samples; do
    grep -qaF "$entry" a.exr || fail "no $entry in the metadata"
  done
  rm a.exr a.png
done
