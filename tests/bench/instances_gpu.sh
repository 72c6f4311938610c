#!/bin/sh
# Instances on a GPU: rays against those through the flattened scene, on OpenCL and Vulkan, and the difference that
# Vulkan's own transformation makes. Arguments: the build folder, a folder for scenes and reports.
set -e
build=$1
out=$2
mkdir -p "$out"
"$build/sightline" scene plant -o "$out/plant.glb" --triangles 2000000 --kinds 2 --cells "$out/plant.json" --overwrite
for device in opencl vulkan; do
  "$build/tests/bench/bench_instances" "$out/plant.glb" "$out/plant.json" --device $device --rays 20000000
done
"$build/sightline" crosscheck "$out/plant.glb" --cells "$out/plant.json" --devices opencl,vulkan
"$build/sightline" scene plant -o "$out/plant65.glb" --triangles 65000000 --kinds 1 --cells "$out/plant65.json" \
  --overwrite
for device in opencl vulkan; do
  "$build/sightline" bake "$out/plant65.glb" --cells "$out/plant65.json" -o "$out/plant65.$device.pvs" --overwrite \
    --device $device --max-seconds 20 --report "$out/plant65.$device.json"
done
