#!/usr/bin/env bash
# Sightline from a fresh Debian 12 in one command: installs what is missing, configures, builds, runs.
set -euo pipefail
exec </dev/null  # nothing here asks; sudo, if it must, reads its password from the terminal

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd -P)
readonly root
readonly build="$root/build"

# Compiler and build, libraries, OpenCL with PoCL (OpenCL on the processor, for machines without a GPU), Vulkan, and
# what only the tests, bench_trace and export --format vdb use.
readonly packages=(
  cmake g++ ninja-build pkg-config
  libcgal-dev libcli11-dev libdraco-dev libfmt-dev libglm-dev libjs-chart.js libmeshoptimizer-dev libpng-dev libtbb-dev
  libwebp-dev libxxhash-dev libzstd-dev nlohmann-json3-dev
  ocl-icd-opencl-dev opencl-clhpp-headers opencl-headers pocl-opencl-icd
  glslang-tools libvulkan-dev
  libembree-dev libgtest-dev libopenvdb-dev spirv-tools
)

# Only the tests need these: Vulkan's validation layer, a Vulkan driver that traces rays on any processor (Debian 12's
# own Mesa has none yet, so it comes from bookworm-backports), a browser to open reports in, and a simulator of an OpenCL
# device that finds data races; .ci/layers is Python.
readonly test_packages=(vulkan-validationlayers mesa-vulkan-drivers chromium oclgrind python3)
readonly mesa_version=25

usage() {
  cat <<'TEXT'
usage: ./build.sh demo [--small]   build, bake a generated city, draw pictures of it and replay a walk into
                               out/demo/
       ./build.sh test [ARGS...]   build and run all tests but those under a simulated device (label checker, a
                                   minute); ARGS go to ctest instead, e.g. -R Golden, -L checker

Both first install the Debian packages that are missing, by apt-get as root or through sudo, and build into build/.
--small            a city of a twelfth of the triangles, fewer rays: for a slow machine, or CI
SIGHTLINE_JOBS=N   compilers to run at once (default: one a core, and one for each 1.5 GiB of free memory at most)
SL_WERROR=ON       a warning of the compiler fails the build
SIGHTLINE_DEVICE   what the demo bakes on (default: opencl; build/sightline devices lists what there is)
TEXT
}

say() { printf '== %s\n' "$*"; }

fail() {
  printf 'build.sh: %s\n' "$*" >&2
  exit 1
}

# Whether a package is installed, mesa-vulkan-drivers in a version that can trace rays.
isInstalled() {
  local state version
  state=$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null) || state=
  [[ $state == installed ]] || return 1
  [[ $1 == mesa-vulkan-drivers ]] || return 0
  version=$(dpkg-query -W -f='${Version}' "$1")
  dpkg --compare-versions "$version" ge "$mesa_version"
}

# Prints those of the given packages that are not installed.
missingPackages() {
  local package
  for package in "$@"; do isInstalled "$package" || printf '%s\n' "$package"; done
}

# Writes the machine's package sources and, beside them, the release's backports into a folder for apt-get. They are
# those of the release itself (mirror, keys, options) with another suite, whichever of apt's two formats they have.
writeSourcesWithBackports() {
  local release=$1 folder=$2 sourceparts='' sourcelist=''
  eval "$(apt-config shell sourceparts Dir::Etc::sourceparts/d sourcelist Dir::Etc::sourcelist/f)"
  rm -rf "$folder"
  mkdir -p "$folder"
  local sources=() lists=()
  mapfile -t sources < <(find -L "$sourceparts" -maxdepth 1 -name '*.sources' 2>/dev/null)
  mapfile -t lists < <(find -L "$sourceparts" -maxdepth 1 -name '*.list' 2>/dev/null)
  ((${#sources[@]} + ${#lists[@]} == 0)) || cp -L "${sources[@]}" "${lists[@]}" "$folder/"
  [[ ! -f $sourcelist ]] || lists+=("$sourcelist")
  ((${#sources[@]} == 0)) || awk -v release="$release" 'BEGIN { RS = ""; FS = "\n" }
    {
      text = ""; binary = named = 0; enabled = 1
      for (i = 1; i <= NF; ++i) {
        line = $i; count = split(line, word, /[ \t:]+/)
        for (k = 2; k <= count; ++k) {
          if (word[1] == "Types" && word[k] == "deb") binary = 1
          if (word[1] == "Suites" && word[k] == release) named = 1
          if (word[1] == "Enabled" && word[k] == "no") enabled = 0
        }
        if (word[1] == "Types") line = "Types: deb"
        if (word[1] == "Suites") line = "Suites: " release "-backports"
        if (word[1] == "Components") line = "Components: main"
        text = text line "\n"
      }
      if (binary && named && enabled) { printf "%s", text; exit }
    }' "${sources[@]}" >"$folder/sightline-backports.sources"
  [[ ! -s $folder/sightline-backports.sources ]] || return 0
  rm -f "$folder/sightline-backports.sources"
  ((${#lists[@]} == 0)) || awk -v release="$release" '
    $0 ~ "^[ \t]*deb[ \t]+(\\[[^]]*\\][ \t]*)?[^ \t]+[ \t]+" release "[ \t]" {
      sub("[ \t]" release "[ \t].*$", " " release "-backports main"); print; exit
    }' "${lists[@]}" >"$folder/sightline-backports.list"
  [[ -s $folder/sightline-backports.list ]] ||
    fail "apt's sources do not name $release, so that its backports cannot be found: install mesa-vulkan-drivers" \
         "$mesa_version or later by hand"
}

# Installs what is missing of the given packages.
installPackages() {
  mkdir -p "$build" 2>/dev/null || fail "cannot create $build: put this project into a folder of yours"
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    fail "this is not a Debian system (no apt-get). Install what these Debian 12 packages hold: $*;" \
         "then run: cmake --preset release && cmake --build --preset release"
  fi
  local missing
  mapfile -t missing < <(missingPackages "$@")
  ((${#missing[@]} > 0)) || return 0

  local as_root=() release='' options=() wanted=("${missing[@]}")
  # shellcheck source=/dev/null
  release=$(. /etc/os-release && printf '%s' "${VERSION_CODENAME:-}")
  local by_hand="missing Debian packages; install them as root, then run this again:
  apt-get update && apt-get install --no-install-recommends ${missing[*]}"
  if [[ $release == bookworm && " ${missing[*]} " == *" mesa-vulkan-drivers "* ]]; then
    by_hand+="
  (mesa-vulkan-drivers from $release-backports: version $mesa_version or later)"
    writeSourcesWithBackports "$release" "$build/apt-sources"
    options=(-o Dir::Etc::SourceParts="$build/apt-sources")
    wanted=("${missing[@]/#mesa-vulkan-drivers/mesa-vulkan-drivers/$release-backports}")
  fi
  if ((EUID != 0)); then
    command -v sudo >/dev/null || fail "neither root nor sudo here, and $by_hand"
    as_root=(sudo)
  fi
  say "installing Debian packages (log: $build/apt.log): ${missing[*]}"
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300
             -o Dpkg::Use-Pty=0 "${options[@]}")
  {
    "${apt[@]}" update && "${apt[@]}" install -y --no-install-recommends "${wanted[@]}"
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
  cmake --preset release -DSL_WERROR="${SL_WERROR:-OFF}" "${fresh[@]}" >"$build/configure.log" ||
    fail "cmake could not configure (log: $build/configure.log)"
  cmake --build --preset release -j "$(compilersAtOnce)" --target "$1"
}

# The ten tests that took longest, by CTest's JUnit file.
printSlowest() {
  say "the slowest tests, in seconds:"
  awk -F'"' '/^\t<testcase / { sub(/ +# GetParam.*/, "", $2); printf "%8.2f  %s\n", $6, $2 }' "$1" | sort -rn | awk 'NR <= 10'
}

# Runs ctest and ends with one line of counts: CTest itself does not count what was skipped.
runTests() {
  local result=0 junit="$build/tests.xml"
  say "running the tests"
  (($# > 0)) || set -- -LE checker
  ctest --preset release -j "$(nproc)" --no-tests=error --output-junit "$junit" "$@" || result=$?
  [[ -f $junit ]] || return "$result"
  printSlowest "$junit"
  awk -F'"' '/^\t?(tests|failures|disabled|skipped)=/ { count[$1] = $2 }
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
  "$sightline" scene city -o "$out/city.glb" --triangles "$triangles" --seed 1 --walk "$out/walk.json" --frames 60
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
  say "replaying a short walk by culling methods"
  local walk=("$out/city.glb" --path "$out/walk.json" --pvs "$out/city.pvs" --resolution 160x90 --repeats 1
              --trace-every 0 --html "$out/walk.html")
  if ! "$sightline" walk "${walk[@]}" --methods none,vfc,opti-chc++,hiz,pvs+vfc --device vulkan 2>"$out/walk.log"; then
    say "no Vulkan device draws here ($out/walk.log): the processor does"
    "$sightline" walk "${walk[@]}" --methods vfc,opti-chc++,pvs+vfc --device cpu
  fi
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
      installPackages "${packages[@]}"
      prepareCaches
      buildTarget sightline
      runDemo "$@"
      ;;
    test)
      installPackages "${packages[@]}" "${test_packages[@]}"
      prepareCaches
      export SIGHTLINE_REQUIRE_VULKAN=1 SIGHTLINE_REQUIRE_CHROMIUM=1  # they are there now: tests that find none fail
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
