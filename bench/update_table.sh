#!/bin/sh
# The benchmark of updates as a Markdown table: ns a row, the ratio of one evaluation to the limit, and the evaluations of
# a whole update. Needs the release preset.
set -eu
cd "$(dirname "$0")/.."
echo "| real | γ | rows | one evaluation, ns a row | ratio to the limit | exact update, ns a row | evaluations | Newton–Raphson, ns a row |"
echo "|---|---|---|---|---|---|---|---|"
build/release/bench/bench_update --benchmark_format=csv --benchmark_min_time=0.1 2>/dev/null |
  awk -F, '
    $1 == "name" { for (i = 1; i <= NF; ++i) { gsub(/"/, "", $i); column[$i] = i } next }
    NF > 5 {
      gsub(/"/, "", $1); split($1, part, "/")
      sub("gamma:", "", part[3])
      key = part[2] "|" part[3] "|" part[4]
      if (!(key in seen)) { seen[key] = 1; order[++n] = key }
      ns[part[1] key] = $column["ns_per_row"]
      ratio[part[1] key] = $column["ratio"]
      evaluations[part[1] key] = $column["evaluations"]
    }
    END {
      for (i = 1; i <= n; ++i) {
        key = order[i]; split(key, part, "|")
        printf "| %s | %s | %s | %.2f | %.2f | %.1f | %d | %.1f |\n", part[1], part[2], part[3],
          ns["one_evaluation" key], ratio["one_evaluation" key], ns["exact_update" key],
          evaluations["exact_update" key], ns["newton_update" key]
      }
    }'
