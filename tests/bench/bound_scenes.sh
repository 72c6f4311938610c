#!/bin/sh
# Sets of long bakes against bounds, on the four generated scenes: what of a set is outside of its bound must be
# a leak, shown by an exact ray. Prints what verify says of each, and ends with 1 if a bound is wrong.
#   tests/bench/bound_scenes.sh SIGHTLINE FOLDER [VOXEL [DEVICE [RAYS an iteration [TRIANGLES]]]]
set -eu
program=$1 folder=$2 voxel=${3:-0.5} device=${4:-cpu} rays=${5:-10M} triangles=${6:-200000}
mkdir -p "$folder"
cd "$folder"
wrong=0
for scene in city canyon plant bistro; do
  "$program" scene $scene -o $scene.glb --triangles "$triangles" --cells $scene-all.json --overwrite > /dev/null
  python3 - $scene <<'EOF'
import json, sys
cells = json.load(open(sys.argv[1] + "-all.json"))["cells"]
wanted = [c for c in cells if c["name"] in ("box-1", "flat-1", "street-1")]
json.dump({"cells": wanted}, open(sys.argv[1] + ".json", "w"))
EOF
  echo "== $scene"
  "$program" bound $scene.glb --cells $scene.json --voxel "$voxel" -o $scene-upper.pvs --overwrite | grep ': '
  "$program" bake $scene.glb --cells $scene.json --device "$device" --n-rand "$rays" --witnesses \
    -o $scene.pvs --overwrite > $scene.log
  "$program" verify $scene.glb $scene.pvs --bound $scene-upper.pvs --min-proven 0 --max-disproved 1000000 \
    --report $scene-leaks.json | grep -A 6 ': ' || wrong=1
done
exit $wrong
