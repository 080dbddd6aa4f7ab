#!/bin/sh
# Builds test_hard with flags that change what floating point means or how it is carried out, and runs it. The answers must
# be the same whatever a host compiles with: a renderer has -ffast-math, a debugger -O0, a cluster -march=native. Ends with
# a table in Markdown, a line for each combination.
set -u

usage="usage: tests/hard_flags.sh [--quick] [COMPILER...]

  COMPILER  g++ clang++ by default
  --quick   one combination: g++ -O3 -march=native -ffast-math
  --help    this

Builds in build/flags/, on CMAKE_BUILD_PARALLEL_LEVEL processors or as many as there are."

quick=
compilers=
for option; do
  case $option in
    --quick) quick=yes ;;
    --help) echo "$usage"; exit 0 ;;
    -*) echo "tests/hard_flags.sh: unknown option '$option'; --help lists them" >&2; exit 2 ;;
    *) compilers="$compilers $option" ;;
  esac
done
[ -n "$compilers" ] || compilers=$([ -n "$quick" ] && echo g++ || echo g++ clang++)
for compiler in $compilers; do
  command -v "$compiler" >/dev/null && continue
  echo "tests/hard_flags.sh: no $compiler here; sh cmake/install_packages.sh tests installs g++ and clang++" >&2
  exit 2
done

cd "$(dirname "$0")/.." || exit 1
export CMAKE_BUILD_PARALLEL_LEVEL="${CMAKE_BUILD_PARALLEL_LEVEL:-$(getconf _NPROCESSORS_ONLN)}"
table=
bad=0

# one g++ "-O0 -g": builds and runs, and adds a line to the table.
one() {
  name=$(echo "$1 $2" | tr -c 'a-zA-Z0-9+\n' '_')
  build=build/flags/$name
  mkdir -p "$build"
  echo "== $1 $2"
  if ! cmake -S . -B "$build" -G Ninja -D CMAKE_BUILD_TYPE=None -D CMAKE_CXX_COMPILER="$1" -D CMAKE_CXX_FLAGS="$2" \
    -D PHIMIS_BUILD_TESTS=ON -D PHIMIS_BUILD_EXAMPLES=OFF -D PHIMIS_BUILD_BENCH=OFF -D PHIMIS_TEST_PACKAGE=OFF \
    </dev/null >"$build/log" 2>&1 || ! cmake --build "$build" --target test_hard </dev/null >>"$build/log" 2>&1; then
    tail -n 40 "$build/log"
    line="| $1 | $2 | was not built; see $build/log | | | |"
    bad=$((bad + 1))
  else
    begin=$(date +%s)
    status=0
    "$build/tests/test_hard" </dev/null >"$build/result" 2>&1 || status=$?
    seconds=$(($(date +%s) - begin))
    # Catch2: "All tests passed (A assertions in T test cases)", or "test cases: T | ..." and "assertions: A | P passed | F failed".
    cases=$(sed -n 's/^All tests passed (.* in \([0-9]*\) test case.*/\1/p; s/^test cases: *\([0-9]*\).*/\1/p' "$build/result")
    passed=$(sed -n 's/^All tests passed (\([0-9]*\) assertions.*/\1/p; s/^assertions:.*| *\([0-9]*\) passed.*/\1/p' "$build/result")
    failed=$(sed -n 's/^assertions:.*| *\([0-9]*\) failed.*/\1/p' "$build/result")
    if [ "$status" -ne 0 ]; then
      [ -n "$failed" ] || failed="ended with $status"
      grep -B 30 '^===' "$build/result" | tail -n 100
      bad=$((bad + 1))
    fi
    line=$(printf '| %-8s | %-32s | %5s | %10s | %6s | %7s |' "$1" "$2" "${cases:-0}" "${passed:-0}" "${failed:-0}" "$seconds")
  fi
  echo "$line"
  table="$table$line
"
}

for compiler in $compilers; do
  if [ -n "$quick" ]; then
    one "$compiler" "-O3 -march=native -ffast-math"
    continue
  fi
  one "$compiler" "-O0"
  one "$compiler" "-O3 -march=native"
  one "$compiler" "-O2 -mfpmath=sse"
  one "$compiler" "-O2 -ffast-math"
  one "$compiler" "-O3 -march=native -ffast-math"
done

echo
printf '| %-8s | %-32s | %5s | %10s | %6s | %7s |\n' compiler flags cases assertions failed seconds
echo '|---|---|---|---|---|---|'
printf '%s' "$table"
[ "$bad" -eq 0 ]
