#!/usr/bin/env bash
# aerosol submit's job for OpenCue, as its own library (PyOutline of PyPI, opencue_pyoutline) reads it: what would be sent to
# the queue is run here, layer by layer as they depend on each other, and its merge has the bits of one render. Left out,
# with a message, where $AEROSOL_PYTHON [python3] cannot import that library.
source "${BASH_SOURCE[0]%/*}/library.sh"

python=${AEROSOL_PYTHON:-python3}
if ! "$python" -c 'import outline.cuerun, outline.backend.cue' 2>"$work/import"; then
  echo "LEFT OUT: PyOutline cannot be imported: $(tail -1 "$work/import")"
  exit 0
fi

cat >run_job.py <<'PYTHON'
"""run_job.py JOB [LOST]: runs a job for OpenCue here, without its task LOST of the first layer."""
import re
import runpy
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

import outline.cuerun

sent = []


class Launcher(outline.cuerun.OutlineLauncher):
    def launch(self, use_pycuerun=True):
        sent.append(self.serialize(use_pycuerun=use_pycuerun))
        return []


outline.cuerun.OutlineLauncher = Launcher
runpy.run_path(sys.argv[1])
lost = sys.argv[2:]
spec = ElementTree.fromstring(re.sub("<!DOCTYPE[^>]*>", "", sent[0]))
layers = {layer.get("name"): layer for layer in spec.iter("layer")}
waits = {name: set() for name in layers}
for depend in spec.iter("depend"):
    waits[depend.findtext("deplayer")].add(depend.findtext("onlayer"))
first, done = next(iter(layers)), []
while len(done) < len(layers):
    name = next(name for name in layers if name not in done and waits[name] <= set(done))
    begin, _, end = layers[name].findtext("range").partition("-")
    for frame in range(int(begin), int(end or begin) + 1):
        if name == first and str(frame) in lost:
            continue
        command = layers[name].findtext("cmd").replace("#IFRAME#", str(frame))
        print(name, frame, subprocess.call(command, shell=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
    done.append(name)
PYTHON

# PyOutline keeps a session of each job in its user's home.
mkdir home
runJob() { HOME=$work/home "$python" run_job.py job/opencue.py "$@" 2>job.err || fail "$(tail -1 job.err)"; }

expect 0 submit "$input/fog.xml" -o whole.exr --spp 9 --tasks 3 --folder "$work/job"
expect 0 render "$input/fog.xml" -o sums.exr --spp 9 --isa avx2 --quiet --keep-sums
expect 0 merge sums.exr -o a.png

ran=$(runJob | tr '\n' ' ')
[ "$ran" = "render 0 0 render 1 0 render 2 0 merge 0 0 " ] || fail "not all tasks ran, or not in their order"
[ -s whole.exr ] || fail "no image was merged"
expect 0 merge job/parts/*.exr -o b.png
pixels() {
  # The compressed pixels of a PNG: its IDAT chunks come last but for the end.
  grep -obUa IDAT "$1" | head -1 | cut -d: -f1 | xargs -I{} tail -c +{} "$1" | cksum
}
[ "$(pixels a.png)" = "$(pixels b.png)" ] || fail "the image of the job is another one"

# A task that is lost is noticed by the merge.
rm -r whole.exr job/parts
mkdir job/parts
[[ "$(runJob 1 | tail -1)" =~ ^"merge 0 "[1-9] ]] || fail "the merge of a job with a lost task succeeded"
[ ! -e whole.exr ] || fail "an image was merged of which a task is lost"
echo "OK"
