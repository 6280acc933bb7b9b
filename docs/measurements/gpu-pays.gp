# SPDX-License-Identifier: Apache-2.0
# Draws docs/figures/gpu-pays.svg (or .png: gnuplot -e "kind='png'") from gpu-pays.csv: a cycle's median (lines) and p99 (dashes, third panel) in us.
#   gnuplot docs/measurements/gpu-pays.gp, in the folder of the project
if (!exists("kind")) kind = 'svg'
if (kind eq 'png') { set terminal pngcairo size 1400,440 font 'sans,11' } else { set terminal svg size 1400,440 font 'sans,11' background '#ffffff' }
set output 'docs/figures/gpu-pays.'.kind
set datafile separator ','
set multiplot layout 1,3 title 'A cycle on one CPU core, and on a GPU'
set logscale xy
set format x '10^{%T}'
set yrange [0.2:2000]
set ylabel 'us a cycle, median'
set grid ytics lc '#dddddd'
set key top left reverse Left
engines = 'cpu gpu8 gpu16 gpu'
titles = '"CPU, 1 core" "GPU, 8 multiprocessors" "16" "whole (132)"'
colours = '#444444 #c0392b #e08e0b #2471a3'
rows(e, where) = sprintf("< awk -F, '$1==\"%s\" && %s' docs/measurements/gpu-pays.csv", e, where)
set xlabel 'questions a cycle (248,832 triangles, margin 1 mm)'
plot for [i=1:4] rows(word(engines,i), '$3==248832 && $4==1') using 2:5 with linespoints pt 7 lw 2 lc rgb word(colours,i) title word(titles,i)
set xlabel 'triangles of sixteen bodies (512 questions, margin 1 mm)'
unset key
plot for [i=1:4] rows(word(engines,i), '$2==512 && $4==1') using 3:5 with linespoints pt 7 lw 2 lc rgb word(colours,i) notitle
unset logscale
set format x '%g'
set xrange [-0.04:1.04]
set yrange [0:320]
set ylabel 'us a cycle, median (line) and p99 (dashes)'
set xlabel 'margin, mm (512 questions, 248,832 triangles)'
plot for [i=1:4] rows(word(engines,i), '$2==512 && $3==248832') using 4:5 with linespoints pt 7 lw 2 lc rgb word(colours,i) notitle, \
     for [i=1:4] rows(word(engines,i), '$2==512 && $3==248832') using 4:6 with linespoints pt 6 dt 2 lc rgb word(colours,i) notitle
unset multiplot
