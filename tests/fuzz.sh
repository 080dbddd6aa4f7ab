#!/bin/sh
# Builds the fuzzers of tests/fuzz and runs each for its share of the time, from the seeds in tests/fuzz/corpus and from
# what earlier runs have found. The last line counts the executions of all.
set -u

usage="usage: tests/fuzz.sh [SECONDS [SEED]]
       tests/fuzz.sh --runs RUNS [SEED]

  SECONDS   of all fuzzers together, 60 by default; at least one for each
  RUNS      executions of each fuzzer, from the seeds alone: with a seed the same ones in every run
  SEED      of what is tried; another one each time by default
  --help    this

What a fuzzer finds is kept in build/fuzz/findings. In numbers, to be made a test of:

  PHIMIS_FUZZ_TELL=1 build/fuzz/tests/fuzz/fuzz_NAME build/fuzz/findings/NAME-crash-..."

[ "${1-}" != --help ] || { echo "$usage"; exit 0; }
runs=
if [ "${1-}" = --runs ]; then
  [ $# -ge 2 ] || { echo "tests/fuzz.sh: --runs wants a number; --help tells more" >&2; exit 2; }
  runs=$2
  shift
fi
[ $# -le 2 ] || { echo "tests/fuzz.sh: a number and a seed, not $*; --help tells more" >&2; exit 2; }
for number; do
  case $number in
    *[!0-9]* | '' | 0*) echo "tests/fuzz.sh: '$number' is no number from 1 on; --help tells more" >&2; exit 2 ;;
  esac
done
seconds=${1-60}
seed=${2-0}  # which libFuzzer takes for any

cd "$(dirname "$0")/.." || exit 1
if ! command -v clang++ >/dev/null; then
  echo "tests/fuzz.sh: no clang++ here; sh cmake/install_packages.sh tests installs it" >&2
  exit 1
fi
cmake --preset fuzz </dev/null || exit 1
cmake --build --preset fuzz </dev/null || exit 1

names=
for source in tests/fuzz/*.cpp; do
  name=$(basename "$source" .cpp)
  [ ! -x "build/fuzz/tests/fuzz/fuzz_$name" ] || names="$names $name"
done
# shellcheck disable=SC2086  # a list of names
set -- $names
[ $# -gt 0 ] || { echo "tests/fuzz.sh: no fuzzer was built" >&2; exit 1; }
share=$((seconds / $#))
[ "$share" -gt 0 ] || share=1

findings=build/fuzz/findings
mkdir -p "$findings"
total=0
failed=
words=
for name; do
  begin=$(date +%s)
  if [ -n "$runs" ]; then
    # What is tried must depend neither on addresses, by which sets of pointers are ordered, nor on how a directory lists its files.
    grown=build/fuzz/corpus_of_runs/$name
    rm -rf "$grown"
    seeds=build/fuzz/$name.seeds
    (LC_ALL=C; printf '%s,' "tests/fuzz/corpus/$name"/*) | sed 's/,$//' >"$seeds"
    launcher="env -i"
    if setarch -R true 2>/dev/null; then launcher="env -i setarch -R"; fi
    how="-runs=$runs -use_cmp=0 -use_memmem=0 -seed_inputs=@$seeds $grown"
  else
    grown=build/fuzz/corpus/$name
    launcher=
    how="-max_total_time=$share $grown tests/fuzz/corpus/$name"
  fi
  log=build/fuzz/$name.log
  mkdir -p "$grown"
  # A unit that takes 20 seconds is a finding. Long inputs say little that short ones do not.
  # shellcheck disable=SC2086  # words
  if $launcher "build/fuzz/tests/fuzz/fuzz_$name" -seed="$seed" -reload=0 -timeout=20 -max_len=600 \
    -print_final_stats=1 -artifact_prefix="$findings/$name-" $how </dev/null >"$log" 2>&1
  then
    result=clean
  else
    failed="$failed $name"
    words="$words$(grep -a -e '^broken' -e '^==[0-9]*== *ERROR' -e '^Base64' "$log")
"
    result=FAILED
    grep -v '^#[0-9]' "$log" | tail -n 60
  fi
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  : "${executions:=0}"
  total=$((total + executions))
  echo "$name: $executions executions in $(($(date +%s) - begin)) s, $result"
done

if [ -n "$failed" ]; then
  printf '%s' "$words"
  echo "fuzz: $total executions of $# fuzzers; failed:$failed; inputs in $PWD/$findings"
  exit 1
fi
echo "fuzz: $total executions of $# fuzzers, no finding"
