#!/usr/bin/env bash
# The OpenColorIO config that is shipped, as OpenColorIO's own ociocheck judges it (opencolorio-tools).
source "${BASH_SOURCE[0]%/*}/library.sh"

config=$input/../../../core/image/aerosol.ocio
if ! command -v ociocheck >/dev/null; then
  echo "LEFT OUT: ociocheck is not installed"
  exit 0
fi

ociocheck --iconfig "$config" >report || fail "ociocheck refuses it: $(cat report)"
grep -q '^passed$' report || fail "it is not valid: $(cat report)"
for space in ACEScg lin_rec709 sRGB 'ACES 1.0 SDR'; do
  grep -q "^$space" report || fail "it has no colour space $space"
done
# What is checked can fail.
sed 's/^  scene_linear:.*/  scene_linear: nowhere/' "$config" >broken.ocio
if ociocheck --iconfig broken.ocio >report 2>&1 && grep -q '^passed$' report; then fail "a role without its space passes"; fi
