# SPDX-License-Identifier: Apache-2.0
# gnuplot model-curve.gp draws model-curve.svg; gnuplot -e "kind='png'" model-curve.gp draws model-curve.png. gnuplot 5.4 or later.
if (!exists('kind')) kind = 'svg'
if (!exists('part')) part = ''
if (kind eq 'svg') set terminal svg size 1000,560 font 'Arial,14' background 'white'
if (kind eq 'png') set terminal pngcairo size 1000,560 font 'DejaVu Sans,10.5' background 'white'
set output 'model-curve.' . kind . part
set encoding utf8
set datafile separator ','
# Okabe and Ito's colours, which people who see few colours tell apart; in grey they differ too.
ink = '#202020'; grey = '#8a8a8a'; pale = '#dddddd'
blue = '#0b5394'; red = '#d55e00'
set border 3 linecolor rgb grey
set tics nomirror textcolor rgb ink
set grid linecolor rgb pale linetype 1 linewidth 0.7
set title 'What a shorter cycle costs: coarser models of two machines' font ',16'
set xlabel 'us a certificate at rest, p99, one core, avx512'
set ylabel 'a stop comes earlier, mm of way (median)'
set logscale x
set xrange [430:2800]
set yrange [-0.1:1.9]
set xtics (500, 750, 1000, 1250, 1500, 2000, 2500)
set key top right reverse Left samplen 2
set bmargin 5.5
set label 'beside each point: simplify_mm, and pairs lost at 300 (fine) and 1,000 (real) positions' at screen 0.5,0.03 center font ',11' noenhanced textcolor rgb ink
set arrow from 500, graph 0 to 500, graph 1 nohead dashtype 2 linewidth 2 linecolor rgb ink
set label 'deadline, 500 us' at 508,1.8 left textcolor rgb ink
set label 'bends back: 0.05 and 0.1 mm take longer than whole' at 2290,0.42 right textcolor rgb red
text(mm, lost) = (mm == 0 ? 'whole' : sprintf('%g mm, %d', mm, lost))
plot 'model-levels.csv' skip 1 using 9:18 with linespoints linewidth 2 pointtype 7 linecolor rgb blue title 'the fine machine, 249,408 triangles', \
     '' skip 1 using 9:18:(text($1, $15)) with labels right offset -0.8,-0.6 font ',11' textcolor rgb blue notitle, \
     'model-levels-real.csv' skip 1 using 9:18 with linespoints linewidth 2 dashtype 2 pointtype 5 linecolor rgb red title 'the real machine, 16,442 triangles', \
     '' skip 1 using 9:18:(text($1, $15)) with labels left offset 0.8,0.5 font ',11' textcolor rgb red notitle
