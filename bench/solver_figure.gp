# SPDX-License-Identifier: MIT
# gnuplot -e "data = 'FILE.csv'; picture = 'FILE.svg'": seconds against m, a row for each γ and a column for each n.
set encoding utf8
set terminal svg size 1280,820 dynamic enhanced font 'DejaVu Sans,15' background '#ffffff'
set output picture
set datafile separator ','
set grid linecolor rgb '#dddddd' linetype 1
set border 3
set tics nomirror
set logscale x 2
set logscale y
set xrange [1.7:75]
set yrange [1e-6:30]
set format y '10^{%T}'
unset mytics
unset mxtics
unset key
set multiplot title "Time to the best fractions, of n observations, to a residual of 10^{-8}" font ',19'
names = 'phimis multiplicative slsqp'
legends = '"phimis::minimise" "multiplicative step" "SLSQP (NLopt)"'
colours = '#0072B2 #D55E00 #757575'
shapes = '7 5 9'
hollow = '6 4 8'
seconds(s, g, n, in_time) = (strcol(4) eq 'anywhere' && strcol(5) eq word(names, s) && column(1) == g && column(2) == n && column(8) == in_time) ? column(6) : NaN
any(s, g, n) = (strcol(4) eq 'anywhere' && strcol(5) eq word(names, s) && column(1) == g && column(2) == n) ? column(6) : NaN
do for [g = 1:2] {
  do for [c = 0:3] {
    decade = int(word('2 4 5 6', c + 1))
    n = 10**decade
    left = 0.075 + 0.23 * c
    set lmargin at screen left
    set rmargin at screen left + 0.195
    set tmargin at screen (g == 1 ? 0.865 : 0.475)
    set bmargin at screen (g == 1 ? 0.565 : 0.175)
    set title sprintf("γ = %d, n = 10^{%d}", g, decade) font ',15' offset 0,-0.4
    if (g == 2) { set xlabel "techniques m" offset 0,0.4 } else { unset xlabel }
    if (c == 0) { set ylabel "time, s" offset 1,0; set format y '10^{%T}' } else { unset ylabel; set format y '' }
    set datafile missing NaN
    plot for [s = 1:3] data using (any(s, g, n) > 0 ? column(3) : NaN):(any(s, g, n)) skip 1 with lines linewidth 2 linecolor rgb word(colours, s), \
         for [s = 1:3] data using 3:(seconds(s, g, n, 1)) skip 1 with points pointtype int(word(shapes, s)) pointsize 0.8 linecolor rgb word(colours, s), \
         for [s = 1:3] data using 3:(seconds(s, g, n, 0)) skip 1 with points pointtype int(word(hollow, s)) pointsize 1.1 linewidth 1.5 linecolor rgb word(colours, s)
  }
}
# The legend: a plot of nothing along the lower edge.
reset
set border 0
unset tics
set lmargin at screen 0.05
set rmargin at screen 0.98
set bmargin at screen 0.0
set tmargin at screen 0.1
set xrange [0:1]
set yrange [0:1]
set key at screen 0.5,0.035 center center horizontal Left reverse maxcols 4 maxrows 1 width 1 samplen 3 font ',16'
plot for [s = 1:3] NaN with linespoints linewidth 2 pointtype int(word(shapes, s)) pointsize 0.9 linecolor rgb word(colours, s) title word(legends, s), \
     NaN with points pointtype 4 pointsize 1.1 linewidth 1.5 linecolor rgb '#D55E00' title "not there after 5 s"
unset multiplot
unset output
