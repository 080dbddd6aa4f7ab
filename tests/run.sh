#!/bin/sh
# Runs the tests from a fresh clone: installs what is missing, runs the workflow of every preset with tests, the hard cases
# under -ffast-math, a minute of fuzzing, then the quick reproduction. The summary names what failed, and its last line
# counts the tests of all.
set -u

usage="usage: tests/run.sh [--fast]

  --fast   only the preset dev: g++, no sanitizers, no other flags, no fuzzing, no reproduction
  --help   this"

presets="dev dev-clang sanitize"
more="flags fuzz reproduction"
for option; do
  case $option in
    --fast) presets=dev more= ;;
    --help) echo "$usage"; exit 0 ;;
    *) echo "tests/run.sh: unknown option '$option'; --help lists them" >&2; exit 2 ;;
  esac
done

cd "$(dirname "$0")/.." || exit 1
sh cmake/install_packages.sh tests || exit 1
jobs=$(getconf _NPROCESSORS_ONLN)
export CMAKE_BUILD_PARALLEL_LEVEL="$jobs" CTEST_PARALLEL_LEVEL="$jobs"

passed=0
failed=0
summary=

# number_of failures build/dev/tests.xml: that attribute of the JUnit file's first element.
number_of() {
  sed -n "/<testcase/q; s/^[[:space:]]*$1=\"\([0-9]*\)\".*/\1/p" "$2"
}

for preset in $presets; do
  results=build/$preset/tests.xml
  rm -f "$results"
  echo "== $preset"
  failures=
  begin=$(date +%s)
  status=0
  cmake --workflow --preset "$preset" </dev/null || status=$?
  if [ -f "$results" ]; then
    bad=$(number_of failures "$results")
    good=$(($(number_of tests "$results") - bad - $(number_of skipped "$results") - $(number_of disabled "$results")))
    # CTest fails, too, where a test could not be run at all.
    if [ "$status" -ne 0 ] && [ "$bad" -eq 0 ]; then bad=1; fi
    failures=$(sed -n 's/.*<testcase name="\([^"]*\)".*status="fail".*/  failed: \1/p' "$results")
  else
    failures="  not built"
    good=0 bad=1
  fi
  passed=$((passed + good))
  failed=$((failed + bad))
  summary="$summary$preset: $good passed, $bad failed, $(($(date +%s) - begin)) s
${failures:+$failures
}"
done

for step in $more; do
  echo "== $step"
  failures=
  begin=$(date +%s)
  good=1
  log=build/$step.log
  case $step in
    flags) sh tests/hard_flags.sh --quick ;;
    fuzz) sh tests/fuzz.sh --runs 10000 1 ;;  # what is new is searched for in longer runs
    reproduction) sh examples/reproduce.sh --quick ;;
  esac </dev/null >"$log" 2>&1 || good=0
  cat "$log"
  [ $good -eq 1 ] || failures=$(tail -n 5 "$log" | sed 's/^/  /')
  passed=$((passed + good))
  failed=$((failed + 1 - good))
  summary="$summary$step: $good passed, $((1 - good)) failed, $(($(date +%s) - begin)) s
${failures:+$failures
}"
done

echo "== summary"
printf '%s' "$summary"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
