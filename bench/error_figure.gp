# gnuplot -e "data = 'FILE.csv'; picture = 'FILE.svg'": RMSE against seconds, a panel for each problem, a line for each method
# through its budgets.
set encoding utf8
set terminal svg size 1280,1690 dynamic enhanced font 'DejaVu Sans,14' background '#ffffff'
set output picture
set datafile separator ','
set grid linecolor rgb '#dddddd' linetype 1
set border 3
set tics nomirror
set logscale xy
set format x '10^{%T}'
set format y '10^{%T}'
unset mytics
unset mxtics
unset key
set xrange [2e-6:1]
problems = 'T1 T2 T3 L4 L5 V1 V2 V3 V4 2-D 5-D lobe'
array names[8] = ["oracle fractions", "default", "default; even iterations by_count", "joint; cross_fitted_control_variates", "equal counts", "Optimal MIS; equal counts", "multichannel β = .25", "VEGAS (GSL)"]
array colours[8] = ["#000000", "#0072B2", "#56B4E9", "#009E73", "#999999", "#D55E00", "#E69F00", "#CC79A7"]
array shapes[8] = [2, 7, 9, 5, 4, 6, 8, 10]
# Below 1e-9 an estimate is exact to rounding, and has no place on the axis.
rmse(p, m) = (strcol(1) eq word(problems, p) && strcol(2) eq names[m] && column(5) / column(3) > 1e-18) ? sqrt(column(5) / column(3)) : NaN
set datafile missing NaN
set multiplot layout 5,3 margins 0.07,0.98,0.04,0.945 spacing 0.07,0.052 title "Error against time: runs of 50, 500, 5000 and 50000 samples" font ',18'
do for [p = 1:12] {
  set title word(problems, p) offset 0,-0.6
  if (p > 9) { set xlabel "processor time of a run, s" offset 0,0.6 } else { unset xlabel }
  if (p % 3 == 1) { set ylabel "RMSE" offset 1,0 } else { unset ylabel }
  if (p == 9) {
    set yrange [1e-9:100]
  } else {
    set autoscale y
  }
  plot for [m = 1:8] data using 8:(rmse(p, m)) skip 1 with linespoints linewidth 1.7 pointtype shapes[m] pointsize 0.7 linecolor rgb colours[m]
}
# The legend, in the place of a thirteenth problem.
unset logscale
unset border
unset tics
unset grid
unset title
unset xlabel
unset ylabel
set xrange [0:1]
set yrange [0:1]
set key at graph 0.0,0.98 left top Left reverse samplen 2.5 spacing 1.35
plot for [m = 1:8] NaN with linespoints linewidth 1.7 pointtype shapes[m] pointsize 0.8 linecolor rgb colours[m] title names[m] noenhanced
unset multiplot
unset output
