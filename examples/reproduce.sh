#!/bin/sh
# Reproduces the tables and figures of the papers from a fresh clone: installs what is missing, builds the programs,
# runs them.
set -eu

usage="usage: examples/reproduce.sh [--quick|--full] [FOLDER]

  FOLDER    where tables, figures, images and their data go; build/reproduction by default
  --quick   few repetitions: a check that everything runs
  --full    the papers' own protocol, repeated; without either, within ten minutes on two cores
  --help    this"

programs="tsallis_figures linear_heuristic_figures variance_tables direct_lighting environment_lighting"
effort=
folder=
for option; do
  case $option in
    --quick | --full) effort=$option ;;
    --help) echo "$usage"; exit 0 ;;
    -*) echo "examples/reproduce.sh: unknown option '$option'; --help lists them" >&2; exit 2 ;;
    *) [ -z "$folder" ] || { echo "examples/reproduce.sh: one FOLDER, not '$folder' and '$option'" >&2; exit 2; }
       folder=$option ;;
  esac
done

here=$(pwd)
cd "$(dirname "$0")/.."
case ${folder:=$PWD/build/reproduction} in
  /*) ;;
  *) folder=$here/$folder ;;
esac
for program in $programs; do
  [ -f "examples/$program.cpp" ] || { echo "examples/reproduce.sh: there is no examples/$program.cpp" >&2; exit 1; }
done

sh cmake/install_packages.sh examples
cmake --preset release </dev/null
cmake --build --preset examples </dev/null
mkdir -p "$folder"
for program in $programs; do
  studies=
  [ "$program" != direct_lighting ] || studies="--table1 --overhead --convergence --never-worse"
  # shellcheck disable=SC2086  # no effort, no argument
  "build/release/examples/$program" --output "$folder" $studies $effort </dev/null
done
echo "reproduced into $folder"
