# SPDX-License-Identifier: Apache-2.0
# gnuplot model-levels.gp draws model-levels.svg; gnuplot -e "kind='png'" model-levels.gp draws model-levels.png. gnuplot 5.4 or later.
if (!exists('kind')) kind = 'svg'
if (!exists('part')) part = ''
if (kind eq 'svg') set terminal svg size 1000,620 font 'Arial,14' background 'white'
if (kind eq 'png') set terminal pngcairo size 1000,620 font 'DejaVu Sans,10.5' background 'white'
set output 'model-levels.' . kind . part
set encoding utf8
set datafile separator ','
# Okabe and Ito's colours, which people who see few colours tell apart; in grey they differ too.
ink = '#202020'; grey = '#8a8a8a'; pale = '#dddddd'
blue = '#0b5394'; red = '#d55e00'; green = '#009e73'; gold = '#e69f00'; sky = '#56b4e9'
set border 3 linecolor rgb grey
set tics nomirror textcolor rgb ink
set grid linecolor rgb pale linetype 1 linewidth 0.7
set title 'fine: time of a cycle against inflation, one core, avx512' noenhanced font ',16'
set xlabel 'inflation of a pair, mm (both certified deviations)'
set ylabel 'us a cycle'
set y2label 'a stop comes so much earlier, mm of way (median)' textcolor rgb red
set y2tics nomirror textcolor rgb red
set border 11 linecolor rgb grey
set logscale y
set yrange [*:*] noextend
set y2range [0:*]
set key top right reverse Left samplen 2 noenhanced
set bmargin 5.5
set label '300 positions spread over the travel, 59 approaches to a stop; each time the least of 2 passes; one core, avx512' at screen 0.5,0.03 center font ',11' noenhanced textcolor rgb ink
file = 'model-levels.csv'
style = 'with linespoints linewidth 2'
plot file skip 1 using 3:9 @style pointtype 7 linecolor rgb blue title 'stoppable, p99', \
     file skip 1 using 3:10 @style pointtype 6 dashtype 2 linecolor rgb blue \
         title 'stoppable, slowest', \
     file skip 1 using 3:6 @style pointtype 5 linecolor rgb green title 'contact mode, p99', \
     file skip 1 using 3:18 axes x1y2 @style pointtype 9 linecolor rgb red \
         title 'a stop comes earlier (right)'
