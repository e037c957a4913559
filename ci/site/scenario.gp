# SPDX-License-Identifier: Apache-2.0
# gnuplot -c scenario.gp CSV PNG: a scenario's positions and its true external torque
set datafile separator ','
set terminal pngcairo size 900,450 font 'sans,11' background 'white'
set output ARG2
stats ARG1 every ::1 nooutput
n = (STATS_columns - 2) / 4  # t, q, qd, tau, tau_ext of n joints, contact
set y2range [0:1]
set multiplot layout 2,1 margins 0.09,0.98,0.12,0.92 spacing 0,0.04
set grid
set key at graph 1, 1.18 right horizontal samplen 1
set format x ''
set ylabel 'q [rad]'
plot for [j=1:n] ARG1 every ::1 using 1:(column(1 + j)) with lines lw 1.5 lc j title sprintf('joint %d', j)
unset key
set format x
set xlabel 't [s]'
set ylabel 'tau\_ext [N m]'
plot ARG1 every ::1 using 1:(column(2 + 4 * n) > 0 ? 1 : 0) axes x1y2 with filledcurves y1=0 fc rgb '#e0e0e0' notitle, \
     for [j=1:n] ARG1 every ::1 using 1:(column(1 + 3 * n + j)) with lines lw 1.5 lc j
unset multiplot
