#!/usr/bin/env bash
# The installed library as a foreign project meets it: installs into a temporary folder, compiles each public header
# alone, builds the examples from there, bakes with them and compares with what the program bakes.
#   install_test.sh BUILD_FOLDER SOURCE_FOLDER CMAKE CXX [SANITIZER FLAGS]
set -euo pipefail

readonly build=$1 source=$2 cmake=$3 cxx=$4 flags=${5:-}
work=$(mktemp -d)
readonly work
trap 'rm -rf "$work"' EXIT
readonly prefix=$work/prefix

fail() {
  printf 'install_test: %s\n' "$*" >&2
  exit 1
}

# Prints and fails if a command does; what it says is shown then only.
quietly() {
  "$@" >"$work/log" 2>&1 || {
    cat "$work/log" >&2
    fail "failed: $*"
  }
}

installIt() {
  quietly "$cmake" --install "$build" --prefix "$prefix"
  local needed
  for needed in bin/sightline include/sightline/api/session.h; do
    [[ -f $prefix/$needed ]] || fail "$needed is not installed"
  done
  ! grep -rn '#include "\(core\|bvh\)/' "$prefix/include" || fail "a public header names the source tree"
  ! grep -rnF "$source" "$prefix" --include='*.cmake' || fail "the package names the source tree"
  ! grep -rnE -e '-W(all|error|extra|shadow)' "$prefix" --include='*.cmake' || fail "the package exports warnings"
}

# The headers are the manual: each is whole by itself, and quiet under a stranger's warnings.
compileHeaders() {
  local header count=0
  while IFS= read -r header; do
    printf '#include <%s>\n#include <%s>\n' "$header" "$header" |
      quietly "$cxx" -std=c++20 -fsyntax-only -Wall -Wextra -Wpedantic -Werror -I"$prefix/include" -x c++ -
    count=$((count + 1))
  done < <(cd "$prefix/include" && find sightline -name '*.h' | sort)
  ((count >= 20)) || fail "only $count public headers"
  ! grep -rnE '#include <(nlohmann|xxhash|zstd|tbb|CL|vulkan|fmt|CLI|CGAL|png|embree)' "$prefix/include" ||
    fail "a public header needs a private package"
}

# The README's program and its lines of CMake, as they stand.
buildReadme() {
  mkdir -p "$work/readme"
  awk '/^```/ { inside = ($0 == "```cpp"); next } inside' "$source/README.md" >"$work/readme/game.cpp"
  {
    printf 'cmake_minimum_required(VERSION 3.25)\nproject(game LANGUAGES CXX)\nadd_executable(game game.cpp)\n'
    awk '/^```/ { inside = ($0 == "```cmake"); next } inside' "$source/README.md"
  } >"$work/readme/CMakeLists.txt"
  grep -q '^find_package(sightline' "$work/readme/CMakeLists.txt" || fail "the README has no lines of CMake"
  buildProject "$work/readme" "$work/readme/build"
}

# buildProject SOURCE BUILD [CMAKE OPTION...]
buildProject() {
  local from=$1 to=$2
  shift 2
  quietly "$cmake" -S "$from" -B "$to" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_CXX_COMPILER="$cxx" -DCMAKE_CXX_FLAGS="-Wall -Wextra -Wpedantic -Werror $flags" \
    -DCMAKE_PREFIX_PATH="$prefix" "$@"
  quietly "$cmake" --build "$to"
}

# Neither configured nor linked: what only a bake needs.
buildReader() {
  local package disabled=()
  for package in TBB OpenCL CGAL embree meshoptimizer nlohmann_json PNG CLI11 Vulkan Threads; do
    disabled+=("-DCMAKE_DISABLE_FIND_PACKAGE_$package=ON")
  done
  buildProject "$source/examples/foreign" "$work/foreign" "${disabled[@]}"
  ldd "$work/foreign/what_is_seen" >"$work/libraries"
  ! grep -E 'libtbb|OpenCL|vulkan|libgmp|libmpfr|embree|meshopt|libpng' "$work/libraries" ||
    fail "what_is_seen links what only a bake needs"
}

resultHash() {
  "$prefix/bin/sightline" info "$1" | awk '/^result hash/ { print $NF }'
}

# Sets are equal to those of the program, on each device, and what is seen from a cell is its set.
bakeAndRead() {
  local sightline=$prefix/bin/sightline device hash wanted
  quietly "$sightline" scene city -o "$work/city.glb" --triangles 3000 --seed 1
  cat >"$work/cells.json" <<'JSON'
{"cells": [{"name": "low", "center": [0, 3, 0], "size": [8, 2, 8]},
           {"name": "turned", "center": [30, 4, 5], "size": [2, 2, 6], "rotation": [0, 30, 0]}]}
JSON
  quietly "$sightline" bake "$work/city.glb" --cells "$work/cells.json" -o "$work/program.pvs" --device cpu \
    --n-rand 100k --validation-rays 100k
  wanted=$(resultHash "$work/program.pvs")
  [[ -n $wanted ]] || fail "no result hash"
  for device in cpu opencl; do
    "$work/bake_and_ask/bake_and_ask" "$work/city.glb" "$work/cells.json" "$work/$device.pvs" "$device" 30,4,5 \
      >"$work/said" || fail "bake_and_ask failed on $device"
    hash=$(resultHash "$work/$device.pvs")
    [[ $hash == "$wanted" ]] || fail "on $device the example found other sets ($hash) than the program ($wanted)"
    "$sightline" export "$work/program.pvs" --cell turned --format ids -o "$work/ids" >/dev/null
    "$work/foreign/what_is_seen" "$work/$device.pvs" 30,4,5 >"$work/seen" || fail "what_is_seen failed"
    cmp "$work/ids" "$work/seen" || fail "what is seen from the middle of a cell is not its set"
    [[ -s $work/seen ]] || fail "nothing is seen"
    grep -qxE "$(wc -l <"$work/ids") of [0-9]+ triangles may be seen" "$work/said" ||
      fail "bake_and_ask says: $(tail -n 1 "$work/said")"
  done
  ! "$work/foreign/what_is_seen" "$work/cpu.pvs" 30,40,5 2>"$work/said" || fail "a point in no cell sees something"
  grep -q 'no cell contains the point' "$work/said" || fail "of a point in no cell: $(cat "$work/said")"
}

# A later minor version is another interface, and a component that there is not is refused.
refuseOthers() {
  local request
  for request in '0.1 REQUIRED' '0.3 REQUIRED' '0.2 REQUIRED COMPONENTS pvs tea'; do
    mkdir -p "$work/refused"
    printf 'cmake_minimum_required(VERSION 3.25)\nproject(refused LANGUAGES CXX)\nfind_package(sightline %s)\n' \
      "$request" >"$work/refused/CMakeLists.txt"
    ! "$cmake" -S "$work/refused" -B "$work/refused/build" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" \
      >"$work/log" 2>&1 || fail "find_package(sightline $request) is content"
    rm -rf "$work/refused"
  done
}

installIt
compileHeaders
buildReader
buildProject "$source/examples/bake_and_ask" "$work/bake_and_ask"
buildReadme
bakeAndRead
refuseOthers
echo "install_test: passed"
