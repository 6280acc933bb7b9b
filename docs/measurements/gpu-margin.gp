# SPDX-License-Identifier: Apache-2.0
# Draws docs/figures/gpu-margin.svg (or .png: gnuplot -e "kind='png'") from gpu-margin.csv: p50 and p99 of a cycle in us.
#   gnuplot docs/measurements/gpu-margin.gp, in the folder of the project
if (!exists("kind")) kind = 'svg'
if (kind eq 'png') { set terminal pngcairo size 640,440 font 'sans,11' } else { set terminal svg size 640,440 font 'sans,11' background '#ffffff' }
set output 'docs/figures/gpu-margin.'.kind
set datafile separator ','
set title '512 questions, 248,832 triangles: median (line), p99 (dashes)'
set xlabel 'margin, mm'
set ylabel 'us a cycle'
set xrange [-0.02:0.52]
set yrange [0:320]
set grid ytics lc '#dddddd'
set key top left reverse Left
engines = 'cpu gpu8 gpu16 gpu'
titles = '"CPU, 1 core" "GPU, 8 multiprocessors" "16" "whole (132)"'
colours = '#444444 #c0392b #e08e0b #2471a3'
rows(e) = sprintf("< awk -F, '$1==\"%s\"' docs/measurements/gpu-margin.csv", e)
plot for [i=1:4] rows(word(engines,i)) using 2:3 with linespoints pt 7 lw 2 lc rgb word(colours,i) title word(titles,i), \
     for [i=1:4] rows(word(engines,i)) using 2:4 with linespoints pt 6 dt 2 lc rgb word(colours,i) notitle
