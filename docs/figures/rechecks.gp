# SPDX-License-Identifier: Apache-2.0
# gnuplot rechecks.gp draws rechecks.svg; gnuplot -e "kind='png'" rechecks.gp draws rechecks.png. gnuplot 5.4 or later.
if (!exists('kind')) kind = 'svg'
if (!exists('part')) part = ''
if (kind eq 'svg') set terminal svg size 1000,540 font 'Arial,14' background 'white'
if (kind eq 'png') set terminal pngcairo size 1000,540 font 'DejaVu Sans,10.5' background 'white'
set output 'rechecks.' . kind . part
set encoding utf8
set datafile separator ','
# Okabe and Ito's colours, which people who see few colours tell apart; in grey they differ too.
ink = '#202020'; grey = '#8a8a8a'; pale = '#dddddd'
blue = '#0b5394'; red = '#d55e00'; green = '#009e73'; gold = '#e69f00'; sky = '#56b4e9'
set border 3 linecolor rgb grey
set tics nomirror textcolor rgb ink
set grid linecolor rgb pale linetype 1 linewidth 0.7

set title "Pairs of triangles that float leaves to double, in the neediest question of a cycle" \
    font ',16'
set bmargin 7
small = kind eq 'svg' ? '12' : '9'
set xlabel "rechecks of that question (to twice as many, less one)"
set ylabel "share of the cycles"
set logscale y
set yrange [*:180]
set xrange [-0.5:14.5]
set ytics ('100%%' 100, '10%%' 10, '1%%' 1, '0.1%%' 0.1, '0.01%%' 0.01, '0.001%%' 0.001)
set xtics ('0' 0, '1' 1, '2' 2, '4' 3, '8' 4, '16' 5, '32' 6, '64' 7, '128' 8, '256' 9, '512' 10, '1024' 11, '2048' 12, '4096' 13, '8192' 14)
set key top right reverse Left width -2 samplen 2.5
set arrow from first 11, graph 0 to first 11, graph 0.62 nohead \
    linecolor rgb red linewidth 2 dashtype 2
set label "the list: 1024" at first 11, graph 0.66 center textcolor rgb red
set label "machine paper-trunnion, eight pairs; 100000, 10000, 10000 and 50000 cycles, contacts among them\nworst: cutter-c at X -0.621568829, Y 31.0713763, Z -283.185871, A -102.743371, C 197.810071" at screen 0.5,0.07 center font ',' . small textcolor rgb ink
plot 'rechecks.csv' skip 1 using 0:($3 > 0 ? 100.0 * $3 / 100000 : NaN) with linespoints linewidth 2 linecolor rgb grey pointtype 7 pointsize 0.8 title 'anywhere: most 347', \
     'rechecks.csv' skip 1 using 0:($4 > 0 ? 100.0 * $4 / 10000 : NaN) with linespoints linewidth 2 linecolor rgb sky pointtype 9 pointsize 0.8 title 'near contact: most 94', \
     'rechecks.csv' skip 1 using 0:($5 > 0 ? 100.0 * $5 / 10000 : NaN) with linespoints linewidth 2 linecolor rgb red pointtype 5 pointsize 0.8 title 'sliding: most 261', \
     'rechecks.csv' skip 1 using 0:($6 > 0 ? 100.0 * $6 / 50000 : NaN) with linespoints linewidth 2 linecolor rgb ink pointtype 2 pointsize 0.8 title 'climb to the most: most 404'
