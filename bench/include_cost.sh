#!/bin/sh
# include_cost.sh [HEADER...]: the seconds that including a header adds to an empty translation unit, the least of
# seven compilations. By default <phimis/core.hpp>, whose bound is 0.2 s, and <phimis/phimis.hpp>.
set -eu

cd "$(dirname "$0")/.."
[ $# -gt 0 ] || set -- phimis/core.hpp phimis/phimis.hpp
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# seconds COMPILER FILE
seconds() {
  for _ in 1 2 3 4 5 6 7; do
    begin=$(date +%s%N)
    "$1" -std=c++20 -Iinclude -I/usr/include/eigen3 -c "$2" -o "$work/out.o"
    echo $(($(date +%s%N) - begin))
  done | sort -n | head -n 1
}

: >"$work/empty.cpp"
for compiler in g++ clang++; do
  command -v "$compiler" >/dev/null || continue
  empty=$(seconds "$compiler" "$work/empty.cpp")
  for header; do
    echo "#include <$header>" >"$work/one.cpp"
    one=$(seconds "$compiler" "$work/one.cpp")
    echo "$compiler $header $((one - empty))" | awk '{ printf "%-8s %-24s %.2f s\n", $1, $2, $3 / 1e9 }'
  done
done
