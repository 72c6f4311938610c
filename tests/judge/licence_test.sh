#!/usr/bin/env bash
# The program may use CGAL's LGPL headers only: looks at every one that the judge includes.
# usage: licence_test.sh CXX SOURCE_DIR
set -euo pipefail
cxx=$1
cd -- "$2"
headers=$("$cxx" -std=c++20 -I. -M core/judge/*.cpp | tr ' \\' '\n\n' | grep '/CGAL/' | sort -u)
count=0
for header in $headers; do
  licence=$(grep -m1 'SPDX-License-Identifier:' "$header" || true)
  case $licence in
    *LGPL-3.0-or-later* | *BSL-1.0* | *MIT* | "") ;;
    *) printf '%s: %s\n' "$header" "$licence"; exit 1 ;;
  esac
  # CGAL's GPL packages say so by their own licence header.
  if [[ -z $licence ]] && grep -q 'GNU General Public' "$header"; then printf '%s: GPL\n' "$header"; exit 1; fi
  count=$((count + 1))
done
# GPL packages include a header of their own there.
if gpl=$(grep '/CGAL/license/' <<<"$headers" | grep -v '/lgpl\.h$'); then
  printf 'a GPL package of CGAL is included: %s\n' "$gpl"
  exit 1
fi
echo "$count headers of CGAL, all under LGPL or freer"
((count > 50))
