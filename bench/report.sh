#!/bin/sh
# How much time do updates and optima take, and how much error is there for how much time? Builds the benchmarks, runs them,
# and writes docs/speed-vs-error.md.
set -eu

usage="usage: bench/report.sh [--quick|--full] [FOLDER]

  FOLDER    where update.csv, optimum.csv, error.csv and all tables go; build/report by default
  --quick   few runs, within two minutes: a check that everything runs; leaves docs/ as it is
  --full    twenty times the runs, ten seconds for each optimum of a peer; without either, within a
            quarter of an hour
  --help    this"

effort=
folder=
for option; do
  case $option in
    --quick | --full) effort=$option ;;
    --help) echo "$usage"; exit 0 ;;
    -*) echo "bench/report.sh: unknown option '$option'; --help lists them" >&2; exit 2 ;;
    *) [ -z "$folder" ] || { echo "bench/report.sh: one FOLDER, not '$folder' and '$option'" >&2; exit 2; }
       folder=$option ;;
  esac
done

here=$(pwd)
cd "$(dirname "$0")/.."
case ${folder:=$PWD/build/report} in
  /*) ;;
  *) folder=$here/$folder ;;
esac
case $effort in
  --quick) error="--runs 400 --most 5000" iterations="--runs 20" update="--benchmark_filter=/(2|16)/(10|100|1000)/"
           solver="--limit 0.1 --rows 1000" ;;
  --full) error="--runs 40000" iterations="--runs 1000" update= solver="--limit 10 --rows 100000" ;;
  *) error="--runs 2000" iterations="--runs 200" update= solver="--limit 0.5 --rows 10000" ;;
esac

programs="bench_update bench_solver bench_error bench_iterations"
sh cmake/install_packages.sh bench
cmake --preset release </dev/null >/dev/null
# shellcheck disable=SC2086  # a list of targets
cmake --build build/release --target $programs </dev/null
mkdir -p "$folder"
built=build/release/bench

echo "updates"
# shellcheck disable=SC2086  # options
sh bench/update_table.sh --csv $update >"$folder/update.csv"

echo "optima"
# shellcheck disable=SC2086
$built/bench_solver --csv "$folder/solver.csv" $solver >"$folder/optimum.md"
awk -F, '
  BEGIN { print "method,gamma,m,n,kkt,seconds,ratio_to_ours" }
  FNR == 1 { next }
  $5 == "gradient" { next }
  $5 == "phimis" { ours[$1, $2, $3, $4] = $6 }
  { printf "%s,%s,%s,%s,%s,%s,%.4g\n", $5 ($4 == "inside" ? "_inside" : ""), $1, $3, $2, $7, $6, $6 / ours[$1, $2, $3, $4] }' \
  "$folder/solver.csv" >"$folder/optimum.csv"

echo "iterations"
# shellcheck disable=SC2086
$built/bench_iterations --csv "$folder/iterations.csv" $iterations >"$folder/iterations.md"

echo "errors"
# shellcheck disable=SC2086
$built/bench_error --csv "$folder/error.csv" $error >"$folder/error.md"
gnuplot -e "data = '$folder/error.csv'; picture = '$folder/speed_vs_error.svg'" bench/error_figure.gp

sh bench/error_page.sh "$folder" >"$folder/speed-vs-error.md"
if [ "$effort" != --quick ]; then
  cp "$folder/speed-vs-error.md" docs/speed-vs-error.md
  cp "$folder/speed_vs_error.svg" docs/figures/speed_vs_error.svg
fi
echo "reported into $folder"
