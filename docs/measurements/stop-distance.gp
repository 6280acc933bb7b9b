# SPDX-License-Identifier: Apache-2.0
# Draws docs/figures/stop-distance.svg (or .png: gnuplot -e "kind='png'") from stop-distance.csv: how early an approach is stopped.
#   gnuplot docs/measurements/stop-distance.gp, in the folder of the project
if (!exists("kind")) kind = 'svg'
if (kind eq 'png') { set terminal pngcairo size 1200,360 font 'sans,11' } else { set terminal svg size 1200,360 font 'sans,11' background '#ffffff' }
set output 'docs/figures/stop-distance.'.kind
set datafile separator ','
set multiplot layout 1,3 title 'Stopped earlier than a straight stop from 10 m/min needs, 100 approaches each'
rows(g) = sprintf("< awk -F, '$1==\"%s\"' docs/measurements/stop-distance.csv", g)
set style fill solid 0.8
set ylabel 'approaches'
set grid ytics lc '#dddddd'
set yrange [0:*]
unset key
bin(x, width) = width * (floor(x / width) + 0.5)
set boxwidth 0.018
set xlabel 'mm, ahead and path kept (bins of 0.02)'
set xrange [0:0.5]
plot rows('ahead') using (bin($3, 0.02)):(1) smooth frequency with boxes lc rgb '#2471a3'
set boxwidth 0.045
set xlabel 'mm, ahead, each axis by itself (0.05; one of 14.2)'
set xrange [-0.5:2]
plot rows('ahead-independent') using (bin($3, 0.05)):(1) smooth frequency with boxes lc rgb '#e08e0b'
set boxwidth 0.45
set xlabel 'mm, positions alone (bins of 0.5)'
set xrange [0:23]
plot rows('state') using (bin($3, 0.5)):(1) smooth frequency with boxes lc rgb '#c0392b'
unset multiplot
