#!/usr/bin/env bash
# aerosol render --plan: what was chosen for the media is in the image, and is done again.
source "${BASH_SOURCE[0]%/*}/library.sh"

echo "-- the choice is kept, and taken from an image or a text"
expect 0 render "$input/fog.xml" -o a.exr --distance marching --transmittance two_combs --quiet --stats
said err "ray marching"
grep -qaF "aerosol:sampling" a.exr || fail "no aerosol:sampling in the metadata"
grep -qaF "fog: distance marching, transmittance two_combs, step" a.exr || fail "the choice is not in the metadata"
expect 0 render "$input/fog.xml" -o b.exr --plan a.exr --quiet --stats
said err "ray marching"
said err "two combs to lights"
expect 0 render "$input/fog.xml" -o b.exr --quiet --stats
grep -qF "ray marching" err && fail "marching without a plan"
echo "fog: distance null, transmittance unbiased, step 0.25" > fog.plan
expect 0 render "$input/fog.xml" -o b.exr --plan fog.plan --quiet --stats
said err "null scattering"
said err "unbiased marching to lights"

echo "-- plans that are none, or of another scene"
expect 1 render "$input/fog.xml" -o b.exr --plan missing.plan
said err "missing.plan: error: this file cannot be read"
printf 'fog: distance null, transmittance ratio, step 1\nfog distance null\n' > two.plan
expect 1 render "$input/fog.xml" -o b.exr --plan two.plan
said err "two.plan:2:1: error: 'fog distance null' says nothing about a medium"
printf 'fog: distance null, transmittance ratio, step 1\nmist: distance null, transmittance ratio, step 1\n' > two.plan
expect 1 render "$input/fog.xml" -o b.exr --plan two.plan
said err "the plan is for 2 media, the scene has 1"
echo "mist: distance null, transmittance ratio, step 1" > mist.plan
expect 1 render "$input/fog.xml" -o b.exr --plan mist.plan
said err "medium 1 of the plan is 'mist', that of the scene 'fog'"
