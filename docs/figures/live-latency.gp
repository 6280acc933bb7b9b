# SPDX-License-Identifier: Apache-2.0
# Draws docs/figures/live-latency.svg (or .png: gnuplot -e "kind='png'") from live-latency.csv: how long after the last frame of a
# sample its answer was on the bus, in the guest (docs/measurements/live-guest.md).
#   gnuplot docs/figures/live-latency.gp, in the folder of the project
if (!exists("kind")) kind = 'svg'
if (kind eq 'png') { set terminal pngcairo size 900,380 font 'sans,11' } else { set terminal svg size 900,380 font 'sans,11' background '#ffffff' }
set output 'docs/figures/live-latency.'.kind
set datafile separator ','
file = 'docs/figures/live-latency.csv'
stats "< awk -F, '$1==\"permit\"' ".file using 2 nooutput name 'P'
stats "< awk -F, '$1==\"stop\"' ".file using 2 nooutput name 'S'
set title sprintf('axguardd on vcan, user-mode Linux: N = %d permits, the latest after %d us; 3/N = %.1g; the stop after %d us', P_records, P_max, 3.0 / P_records, S_max) font ',10'
set xlabel 'us from the last frame of a sample to its answer, both stamped by the kernel (bins of 10)'
set ylabel 'permits'
set logscale y
set yrange [0.5:*]
set xrange [0:1000]
set grid ytics lc '#dddddd'
set style fill solid 0.8
set boxwidth 9
unset key
set arrow from S_max, graph 0 to S_max, graph 0.9 nohead lc rgb '#c0392b' lw 2
set label 'the stop' at S_max + 8, graph 0.85 tc rgb '#c0392b'
plot "< awk -F, '$1==\"permit\"' ".file using (10 * floor($2 / 10) + 5):(1) smooth frequency with boxes lc rgb '#2471a3'
