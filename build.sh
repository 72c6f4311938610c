#!/usr/bin/env bash
# Sightline from a fresh Debian 12 in one command: installs what is missing, configures, builds, runs.
set -euo pipefail
exec </dev/null  # nothing here asks; sudo, if it must, reads its password from the terminal

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd -P)
readonly root
readonly build="$root/build"

# Compiler and build, libraries, OpenCL with PoCL (OpenCL on the processor, for machines without a GPU), and what
# only the tests and bench_trace use.
readonly packages=(
  cmake g++ ninja-build pkg-config
  libcgal-dev libcli11-dev libfmt-dev libglm-dev libmeshoptimizer-dev libpng-dev libtbb-dev
  libtinyobjloader-dev libxxhash-dev libzstd-dev nlohmann-json3-dev
  ocl-icd-opencl-dev opencl-clhpp-headers opencl-headers pocl-opencl-icd
  glslang-tools libembree-dev libgtest-dev spirv-tools
)

usage() {
  cat <<'TEXT'
usage: ./build.sh demo [--small]   build, bake a generated city, draw pictures of it into out/demo/
       ./build.sh test [ARGS...]   build and run all tests; ARGS go to ctest, e.g. -R Golden

Both first install the Debian packages that are missing, by apt-get as root or through sudo, and build into build/.
--small            a city of a twelfth of the triangles, fewer rays: for a slow machine, or CI
SIGHTLINE_JOBS=N   compilers to run at once (default: one a core, and one for each 1.5 GiB of free memory at most)
SIGHTLINE_DEVICE   what the demo bakes on (default: opencl; build/sightline devices lists what there is)
TEXT
}

say() { printf '== %s\n' "$*"; }

fail() {
  printf 'build.sh: %s\n' "$*" >&2
  exit 1
}

# Prints those of the given packages that are not installed.
missingPackages() {
  local package state
  for package in "$@"; do
    state=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) || state=
    [[ $state == installed ]] || printf '%s\n' "$package"
  done
}

installPackages() {
  mkdir -p "$build" 2>/dev/null || fail "cannot create $build: put this project into a folder of yours"
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    fail "this is not a Debian system (no apt-get). Install what these Debian 12 packages hold: ${packages[*]};" \
         "then run: cmake --preset release && cmake --build --preset release"
  fi
  local missing
  mapfile -t missing < <(missingPackages "${packages[@]}")
  ((${#missing[@]} > 0)) || return 0

  local as_root=()
  local by_hand="missing Debian packages; install them as root, then run this again:
  apt-get update && apt-get install --no-install-recommends ${missing[*]}"
  if ((EUID != 0)); then
    command -v sudo >/dev/null || fail "neither root nor sudo here, and $by_hand"
    as_root=(sudo)
  fi
  say "installing Debian packages (log: $build/apt.log): ${missing[*]}"
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300
             -o Dpkg::Use-Pty=0)
  {
    "${apt[@]}" update && "${apt[@]}" install -y --no-install-recommends "${missing[@]}"
  } >"$build/apt.log" 2>&1 || {
    tail -n 5 "$build/apt.log" >&2
    fail "apt-get failed, and $by_hand"
  }
}

# PoCL and ccache keep compiled code under the user's cache folder. Where that cannot be written, PoCL keeps it in
# the build folder and ccache is left out.
prepareCaches() {
  local cache=${XDG_CACHE_HOME:-${HOME:-/nonexistent}/.cache}
  mkdir -p "$cache" 2>/dev/null || true
  [[ -d $cache && -w $cache ]] && return
  export CCACHE_DISABLE=1
  if [[ -z ${POCL_CACHE_DIR:-} ]]; then
    export POCL_CACHE_DIR="$build/pocl-cache"
    mkdir -p "$POCL_CACHE_DIR"
    say "no writable cache folder ($cache): PoCL keeps its compiled kernels in $POCL_CACHE_DIR"
  fi
}

compilersAtOnce() {
  local cores memory_jobs
  cores=$(nproc)
  memory_jobs=$(awk '/^MemAvailable:/ { print int($2 / 1572864) }' /proc/meminfo)
  ((memory_jobs >= 1)) || memory_jobs=1
  printf '%s\n' "${SIGHTLINE_JOBS:-$((cores < memory_jobs ? cores : memory_jobs))}"
}

# Configures, and builds the given target in Release.
buildTarget() {
  local fresh=()
  if [[ -f $build/CMakeCache.txt ]] && ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$build/CMakeCache.txt"; then
    fresh=(--fresh)  # the folder was moved since
  fi
  say "building into $build"
  cmake --preset release "${fresh[@]}" >"$build/configure.log" ||
    fail "cmake could not configure (log: $build/configure.log)"
  cmake --build --preset release -j "$(compilersAtOnce)" --target "$1"
}

# Runs ctest and ends with one line of counts: CTest itself does not count what was skipped.
runTests() {
  local result=0 junit="$build/tests.xml"
  say "running the tests"
  ctest --preset release -j "$(nproc)" --no-tests=error --output-junit "$junit" "$@" || result=$?
  [[ ! -f $junit ]] || awk -F'"' '/^\t?(tests|failures|disabled|skipped)=/ { count[$1] = $2 }
    END { failed = count["\tfailures="]; skipped = count["\tskipped="] + count["\tdisabled="]
          printf "== tests: %d passed, %d failed, %d skipped\n",
                 count["\ttests="] - failed - skipped, failed, skipped }' "$junit"
  return "$result"
}

# Generates a city, places view cells along one of its streets, bakes and draws them. The streets' places follow
# from the number of triangles and the seed.
runDemo() {
  local triangles=250000 street=-50.13 bake=() size=()
  if [[ ${1:-} == --small ]]; then
    triangles=20000 street=-43.14
    bake=(--n-rand 1000000 --validation-rays 1000000)
    size=(--width 640 --height 480)
  fi
  local sightline="$build/sightline" out=out/demo device=${SIGHTLINE_DEVICE:-opencl} cell view
  rm -rf "$out"
  mkdir -p "$out"
  say "generating a city of $triangles triangles and view cells along a street"
  "$sightline" scene city -o "$out/city.glb" --triangles "$triangles" --seed 1
  "$sightline" cells "$out/city.glb" -o "$out/cells.json" --path "$street,1.5,-75" "$street,1.5,75" --length 50
  say "baking (device: $device)"
  "$sightline" bake "$out/city.glb" --cells "$out/cells.json" -o "$out/city.pvs" --report "$out/report.json" \
    --device "$device" "${bake[@]}"
  say "drawing: visible triangles green, the rest grey; from inside, missing ones red"
  for cell in 0 1 2; do
    for view in outside inside; do
      "$sightline" picture "$out/city.glb" "$out/city.pvs" --cell "$cell" --view "$view" --device "$device" \
        -o "$out/cell-$((cell + 1))-$view.png" "${size[@]}"
    done
  done
  say "pictures and results are in $root/$out"
}

main() {
  local command=${1:-}
  (($# == 0)) || shift
  cd -- "$root"
  case $command in
    demo)
      if (($# > 1)) || [[ ${1:---small} != --small ]]; then
        usage >&2
        exit 2
      fi
      installPackages
      prepareCaches
      buildTarget sightline
      runDemo "$@"
      ;;
    test)
      installPackages
      prepareCaches
      buildTarget all
      runTests "$@"
      ;;
    -h | --help | help)
      usage
      ;;
    *)
      usage >&2
      exit 2
      ;;
  esac
}

main "$@"
