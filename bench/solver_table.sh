#!/bin/sh
# The benchmark of solvers: a Markdown table on standard output, docs/figures/speed_solver.csv and the figure of it. Needs
# the release preset and gnuplot; takes minutes, since peers are given ten seconds each.
set -eu
cd "$(dirname "$0")/.."
figure=docs/figures/speed_solver
build/release/bench/bench_solver --csv "$figure.csv"
gnuplot -e "data = '$figure.csv'; picture = '$figure.svg'" bench/solver_figure.gp >&2
