#!/bin/sh
# Drawing and culling of generated walks on a GPU: tests of what is drawn, then the cost of each way by part.
# Arguments: the build folder, a folder for tables; then, to leave some out, the scenes.
set -e
build=$1
out=$2
shift 2
mkdir -p "$out"
SIGHTLINE_REQUIRE_VULKAN=1 "$build/tests/test_draw_vulkan" > "$out/test_draw_vulkan.txt" 2>&1 ||
  echo "test_draw_vulkan failed: $out/test_draw_vulkan.txt"
tail -n 3 "$out/test_draw_vulkan.txt"
bench() {  # scene triangles, then further options
  scene=$1 triangles=$2
  shift 2
  name=$(echo "$scene-$triangles$*" | tr -c 'a-z0-9\n' -)
  "$build/tests/bench/bench_walk" --scene "$scene" --triangles "$triangles" "$@" | tee "$out/$name.txt"
}
for scene in ${*:-city bistro plant canyon}; do
  # First: does it show what it should, at odd sizes too.
  for size in "1 1" "97 61" "1000 3" "1279 719"; do
    bench "$scene" 400000 --width "${size% *}" --height "${size#* }" --frames 200 --check 1
  done
  for triangles in 2000000 4000000 12000000; do
    bench "$scene" "$triangles" --frames 300 --check 10
  done
done
bench "${1:-city}" 12000000 --frames 300 --check 0 --split 512
bench "${1:-city}" 12000000 --frames 300 --check 0 --width 640 --height 360
