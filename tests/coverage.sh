#!/bin/sh
# Which lines of include/ does no test run? Builds the tests with counters of lines, runs them, and prints the lines that were
# not run and the share of those that were.
set -u

usage="usage: tests/coverage.sh [--no-build] [LEAST]

  LEAST       fails where less than this share of the lines is run, in percent; 98 by default
  --no-build  reports on what build/coverage has been run for
  --help      this

Lines that are not run, with the reason, are in docs/robustness.md."

least=
build=yes
for option; do
  case $option in
    --no-build) build= ;;
    --help) echo "$usage"; exit 0 ;;
    [0-9]*) [ -z "$least" ] || { echo "tests/coverage.sh: one LEAST, not '$least' and '$option'" >&2; exit 2; }
            least=$option ;;
    *) echo "tests/coverage.sh: unknown option '$option'; --help lists them" >&2; exit 2 ;;
  esac
done

cd "$(dirname "$0")/.." || exit 1
sh cmake/install_packages.sh coverage || exit 1
if [ -n "$build" ]; then
  jobs=${CMAKE_BUILD_PARALLEL_LEVEL:-$(getconf _NPROCESSORS_ONLN)}
  cmake --preset coverage </dev/null || exit 1
  cmake --build --preset coverage --parallel "$jobs" </dev/null || exit 1
  find build/coverage -name '*.gcda' -exec rm -f {} +
  ctest --preset coverage --parallel "$jobs" </dev/null || exit 1
fi

report=build/coverage/coverage.txt
# A line of a template was run where it was in any of its instances.
gcovr --root . --filter 'include/' --exclude-unreachable-branches --object-directory build/coverage --txt "$report" \
  --json-summary build/coverage/coverage.json build/coverage || exit 1
# A long name has its numbers on the next line.
awk '/^include/ && NF == 1 { name = $0; next } /%/ && !/^TOTAL/ && !/100%/ { print name $0 } { name = "" }' "$report"
share=$(awk '/^TOTAL/ { sub("%", "", $4); print 100 * $3 / $2 }' "$report")
awk '/^TOTAL/ { printf "coverage: %d of %d lines, %.2f %%\n", $3, $2, 100 * $3 / $2 }' "$report"
awk -v share="$share" -v least="${least:-98}" 'BEGIN { exit !(share >= least) }'
