# SPDX-License-Identifier: Apache-2.0
# Draws Figs. 4 to 7 and 10 to 15 from what ci/figures recorded, in the folder where that lies, into the folder
# that is its argument.
folder = ARG1
set datafile separator ','
set terminal pngcairo size 800,560 font 'sans,10' background '#ffffff'
set grid lc rgb '#dddddd'
set key outside top center horizontal samplen 2
set lmargin 10
set rmargin 2
file(name) = name.'.csv'
est(name) = name.'_est.csv'
TRUTH = '#000000'; EKF = '#d95f02'; NDOB = '#1b7a9e'; OTHER = '#7570b3'

# tau_ext of a run: truth and both estimators; every: samples between two points
tau_ext(name, every) = sprintf("plot '%s' u 't':'ekf_tau_ext1' every %d w l lc rgb EKF t 'EKF', '%s' u 't':'ndob_tau_ext1' every %d w l lc rgb NDOB t 'NDOB', '%s' u 't':'tau_ext1' every %d w l lw 1.5 dt 2 lc rgb TRUTH t 'true'", est(name), every, est(name), every, file(name), every)
motion(name) = sprintf("plot '%s' u 't':'q1' every 10 w l lc rgb TRUTH t 'q [rad]', '%s' u 't':'qd1' every 10 w l lc rgb OTHER t 'qd [rad/s]'", file(name), file(name))

# of joint j of wallmobot3, which are the paper's 2, 3 and 4
joint(name, j) = sprintf("set ylabel 'joint %d'; plot '%s' u 't':'ekf_tau_ext%d' every 10 w l lc rgb EKF t 'EKF', '%s' u 't':'ndob_tau_ext%d' every 10 w l lc rgb NDOB t 'NDOB', '%s' u 't':'tau_ext%d' every 10 w l lw 1.5 dt 2 lc rgb TRUTH t 'true'", j + 1, est(name), j, est(name), j, file(name), j)
states(name, what, unit) = sprintf("set ylabel '%s [%s]'; plot for [j=1:3] '%s' u 't':'%s'.j every 10 w l t 'joint '.(j + 1)", what, unit, file(name), what)
do for [f in "4:step 5:ramp 6:sine"] {
  name = f[3:*]
  set terminal pngcairo size 800,1000 font 'sans,10' background '#ffffff'
  set output folder.'/figure'.f[1:1].'.png'
  set multiplot layout 5,1 title 'Fig. '.f[1:1].', '.name.': q, qd and tau\_{ext} [N m]'
  eval states(name, 'q', 'rad')
  eval states(name, 'qd', 'rad/s')
  do for [j=1:3] { eval joint(name, j) }
  unset multiplot
}
set terminal pngcairo size 800,560 font 'sans,10' background '#ffffff'
set output folder.'/figure7.png'
set multiplot layout 2,1 title 'Fig. 7: tau\_{ext} of joint 2 [N m] and fiducial marks; (a) a slow load, (b) a collision at 5 s'
do for [name in "sine collision"] {
  set ylabel name
  plot est(name) u 't':'ekf_tau_ext1' every 5 w l lc rgb EKF t 'EKF', \
       est(name) u 't':(column('ekf_pan_tompkins_mark') > 0 ? column('ekf_tau_ext1') : NaN) w p pt 9 ps 2 lc rgb TRUTH t 'mark'
}
unset multiplot

set output folder.'/figure10.png'
set multiplot layout 2,1 title 'Fig. 10, model\_check: down and up, no load'
eval motion('model_check')
set ylabel 'tau [N m]'; set xlabel 't [s]'
plot file('model_check') u 't':'tau1' every 10 w l lc rgb '#aaaaaa' t 'loadcell', \
     '< paste -d, '.file('model_check').' '.est('model_check') u 't':(column('tau1') - column('inverse_dynamics_tau_ext1')) every 10 w l lc rgb EKF t 'model (36)'
unset multiplot

set output folder.'/figure11.png'
set multiplot layout 2,1 title 'Fig. 11, manual: a hand moves the arm'
unset xlabel; unset ylabel
eval motion('manual')
set ylabel 'tau_{ext} [N m]'; set xlabel 't [s]'
eval tau_ext('manual', 10)
unset multiplot

set output folder.'/figure12.png'
set multiplot layout 2,1 title 'Fig. 12, hold: 3.3 kg at q = 0.5 rad from t = 25 s, 19.9 N m'
eval tau_ext('hold', 10)
set xrange [24.9:25.6]
eval tau_ext('hold', 1)
set xrange [*:*]
unset multiplot

set output folder.'/figure13.png'
set multiplot layout 2,1 title 'Fig. 13, swing: 3.3 kg, swung from 13 s, dropped at 32 s; the arm sticks'
eval tau_ext('swing', 10)
set xrange [15:20]; set yrange [16:23]
eval tau_ext('swing', 5)
set xrange [*:*]; set yrange [*:*]
unset multiplot

set output folder.'/figure14.png'
set multiplot layout 2,1 title 'Fig. 14, button: up and down, 1.2 kg from t = 8 s'
unset xlabel; unset ylabel
eval motion('button')
set ylabel 'tau_{ext} [N m]'; set xlabel 't [s]'
eval tau_ext('button', 10)
unset multiplot

set output folder.'/figure15.png'
set multiplot layout 2,1 title 'Fig. 15, collision: into an obstacle at 0.3 rad/s'
set xrange [5.04:5.3]
plot file('unstopped') u 't':'tau_ext1' w l lw 1.5 lc rgb '#999999' t 'true, not stopped', \
     file('stopped') u 't':'tau_ext1' w l lw 1.5 lc rgb TRUTH t 'true, the mark stops the motor', \
     est('stopped') u 't':'ndob_tau_ext1' w l lc rgb NDOB t 'NDOB', \
     est('stopped') u 't':(column('ndob_pan_tompkins_mark') > 0 ? column('ndob_tau_ext1') : NaN) w p pt 7 ps 1.5 lc rgb EKF t 'fiducial mark'
set ylabel 'q [rad]'
plot file('unstopped') u 't':'q1' w l lw 1.5 lc rgb '#999999' t 'not stopped', file('stopped') u 't':'q1' w l lw 1.5 lc rgb TRUTH t 'stopped'
unset multiplot
