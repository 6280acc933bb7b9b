# SPDX-License-Identifier: Apache-2.0
# gnuplot cycle-accuracy.gp draws cycle-accuracy.svg; gnuplot -e "kind='png'" cycle-accuracy.gp draws cycle-accuracy.png. gnuplot 5.4 or later.
if (!exists('kind')) kind = 'svg'
if (!exists('part')) part = ''
if (kind eq 'svg') set terminal svg size 600,860 font 'Arial,14' background 'white'
if (kind eq 'png') set terminal pngcairo size 1200,1720 font 'DejaVu Sans,10.5' background 'white' fontscale 2 linewidth 2 pointscale 2
set output 'cycle-accuracy.' . kind . part
set encoding utf8
set datafile separator ','
# Okabe and Ito's colours, which people who see few colours tell apart; in grey they differ too.
ink = '#202020'; grey = '#8a8a8a'; pale = '#dddddd'
blue = '#0b5394'; red = '#d55e00'; green = '#009e73'; gold = '#e69f00'; sky = '#56b4e9'
set border 3 linecolor rgb grey
set tics nomirror textcolor rgb ink
set grid linecolor rgb pale linetype 1 linewidth 0.7
small = kind eq 'svg' ? '12' : '9'
mark = kind eq 'svg' ? 0.6 : 1.0
set lmargin at screen 0.15; set rmargin at screen 0.975
unset key
set logscale xy
set xrange [0.1:300000]
set xtics ('0.1' 0.1, '1 µs' 1, '10 µs' 10, '100 µs' 100, '1 ms' 1e3, '10 ms' 1e4, '100 ms' 1e5)
set mxtics 10
set label '{/:Bold Whole cycles: time against early stops}' at screen 0.5,0.9767 center font ',16' textcolor rgb ink
set label 'axguard, proven' at screen 0.1600,0.9488 left point pointtype 5 pointsize mark linecolor rgb blue offset 1.6,0 font ',' . small textcolor rgb ink
set label 'the seed paper''s test of every pair of triangles' at screen 0.1600,0.9279 left point pointtype 13 pointsize 1.7*mark linecolor rgb ink offset 1.6,0 font ',' . small textcolor rgb ink
set label 'other libraries, volumes, contact mode' at screen 0.1600,0.9070 left point pointtype 7 pointsize mark linecolor rgb red offset 1.6,0 font ',' . small textcolor rgb ink
set label 'predicted, not measured' at screen 0.1600,0.8860 left point pointtype 8 pointsize 1.3*mark linewidth 1.5 linecolor rgb blue offset 1.6,0 font ',' . small textcolor rgb ink
set label 'measured here: contact mode, positions only, longest cycle;' at screen 0.5,0.0465 center font ',' . small noenhanced textcolor rgb ink
set label 'one core of an AMD EPYC, avx512 with 16 lanes; the rest: records' at screen 0.5,0.0291 center font ',' . small noenhanced textcolor rgb ink
set label 'dotted: nothing is better in both' at screen 0.5,0.0116 center font ',' . small noenhanced textcolor rgb ink
set multiplot
$marks0 << EOD
4.236,0.01,0
79.287,0.01,2
95.792,0.01,2
197.712,0.01,2
64.395,0.01,2
53156.1,0.01,1
0.34,189.812,2
0.161,315.818,2
30.5,0.01,0
182.72,0.01,1
EOD
$joined0 << EOD
1,1

EOD
$pareto0 << EOD
0.161,315.818
0.34,315.818
0.34,189.812
4.236,189.812
4.236,0.01
EOD
set tmargin at screen 0.8300; set bmargin at screen 0.5200
set yrange [0.003:3000]
set ytics ('none' 0.01, '0.1 mm' 0.1, '1 mm' 1, '10 mm' 10, '100 mm' 100)
set label '{/:Bold Is there a contact? (yes or no)}' at screen 0.1500,0.8440 left font ',14' textcolor rgb ink
set label 'clearance called contact' at screen 0.0233,0.6750 center rotate by 90 textcolor rgb ink
unset xlabel
set label '{/:Bold axguard}' at screen 0.2401,0.5658 left front font ',' . small textcolor rgb blue
set label 'FCL' at screen 0.5344,0.5640 left front font ',' . small textcolor rgb red
set label 'Coal' at screen 0.4574,0.5658 left front font ',' . small textcolor rgb red
set label 'Bullet' at screen 0.6298,0.5470 left front font ',' . small textcolor rgb red
set arrow from screen 0.5698,0.5470 to screen 0.6265,0.5389 nohead back linecolor rgb grey linewidth 0.7
set label 'ODE' at screen 0.4834,0.5836 left front font ',' . small textcolor rgb red
set arrow from screen 0.5078,0.5470 to screen 0.5078,0.5755 nohead back linecolor rgb grey linewidth 0.7
set label '{/:Bold paper''s test on one core}' at screen 0.5819,0.6748 left front font ',' . small textcolor rgb ink
set arrow from screen 0.8793,0.5470 to screen 0.8793,0.6667 nohead back linecolor rgb grey linewidth 0.7
set label 'one box a body' at screen 0.2355,0.7826 left front font ',' . small textcolor rgb red
set label 'one sphere a body' at screen 0.1985,0.8014 left front font ',' . small textcolor rgb red
set label '{/:Bold axguard on an H200}' at screen 0.6404,0.5834 left front font ',' . small textcolor rgb blue
set arrow from screen 0.4664,0.5470 to screen 0.6371,0.5753 nohead back linecolor rgb grey linewidth 0.7
set label '{/:Bold paper''s kernels on an H200 (max)}' at screen 0.4822,0.6074 left front font ',' . small textcolor rgb ink
set arrow from screen 0.5655,0.5470 to screen 0.5655,0.5993 nohead back linecolor rgb grey linewidth 0.7
set arrow from screen 0.2147,0.6339 to screen 0.1747,0.6130 filled linewidth 2 linecolor rgb green
set label '{/:Bold better}' at screen 0.2228,0.6256 left font ',' . small textcolor rgb green
set arrow from first 500, graph 0 to first 500, graph 1 nohead back dashtype 2 linewidth 2 linecolor rgb ink
set label 'deadline, 500 µs' at screen 0.6128,0.8172 right font ',' . small textcolor rgb ink
plot $pareto0 using 1:2 with lines linewidth 1.5 dashtype 3 linecolor rgb blue, \
     $joined0 using 1:2 with lines linewidth 0.8 linecolor rgb grey, \
     $marks0 using ($3==0 ? $1 : NaN):2 with points pointtype 5 pointsize mark linecolor rgb blue, \
     $marks0 using ($3==1 ? $1 : NaN):2 with points pointtype 13 pointsize 1.7*mark linecolor rgb ink, \
     $marks0 using ($3==2 ? $1 : NaN):2 with points pointtype 7 pointsize mark linecolor rgb red, \
     $marks0 using ($3==3 ? $1 : NaN):2 with points pointtype 6 pointsize mark linewidth 1.5 linecolor rgb red, \
     $marks0 using ($3==4 ? $1 : NaN):2 with points pointtype 8 pointsize 1.3*mark linewidth 1.5 linecolor rgb blue
unset label; unset arrow
$marks1 << EOD
5.148,1000,2
92.828,6.24,0
434.623,6.24,0
31,0.738,0
1286,6.24,0
912,6.24,4
EOD
$joined1 << EOD
1,1

EOD
$pareto1 << EOD
5.148,1000
31,1000
31,0.738
EOD
set tmargin at screen 0.4600; set bmargin at screen 0.1300
set yrange [0.03:30000]
set ytics ('0.1 mm' 0.1, '1 mm' 1, '10 mm' 10, '100 mm' 100, 'touches' 1000)
set label '{/:Bold Can it still stop in time?}' at screen 0.1500,0.4740 left font ',14' textcolor rgb ink
set label 'stops early by (median)' at screen 0.0233,0.2950 center rotate by 90 textcolor rgb ink
set xlabel 'time of a cycle of eight pairs; p99 unless stated'
set label 'contact mode: touches' at screen 0.3109,0.3987 left front font ',' . small textcolor rgb red
set label '{/:Bold positions only (p99 at rest)}' at screen 0.2101,0.1803 left front font ',' . small textcolor rgb blue
set arrow from screen 0.5280,0.2575 to screen 0.5280,0.1884 nohead back linecolor rgb grey linewidth 0.7
set label '{/:Bold longest cycle}' at screen 0.6568,0.2942 left front font ',' . small textcolor rgb blue
set arrow from screen 0.6134,0.2575 to screen 0.6535,0.2860 nohead back linecolor rgb grey linewidth 0.7
set label '{/:Bold look-ahead path}' at screen 0.2448,0.2253 left front font ',' . small textcolor rgb blue
set label '{/:Bold H200 longest}' at screen 0.6381,0.2375 left front font ',' . small textcolor rgb blue
set label 'AGX Orin predicted' at screen 0.6695,0.2744 left front font ',' . small textcolor rgb blue
set arrow from screen 0.2147,0.1608 to screen 0.1747,0.1399 filled linewidth 2 linecolor rgb green
set label '{/:Bold better}' at screen 0.2228,0.1525 left font ',' . small textcolor rgb green
set arrow from first 500, graph 0 to first 500, graph 1 nohead back dashtype 2 linewidth 2 linecolor rgb ink
set label 'deadline, 500 µs' at screen 0.6128,0.4472 right font ',' . small textcolor rgb ink
plot $pareto1 using 1:2 with lines linewidth 1.5 dashtype 3 linecolor rgb blue, \
     $joined1 using 1:2 with lines linewidth 0.8 linecolor rgb grey, \
     $marks1 using ($3==0 ? $1 : NaN):2 with points pointtype 5 pointsize mark linecolor rgb blue, \
     $marks1 using ($3==1 ? $1 : NaN):2 with points pointtype 13 pointsize 1.7*mark linecolor rgb ink, \
     $marks1 using ($3==2 ? $1 : NaN):2 with points pointtype 7 pointsize mark linecolor rgb red, \
     $marks1 using ($3==3 ? $1 : NaN):2 with points pointtype 6 pointsize mark linewidth 1.5 linecolor rgb red, \
     $marks1 using ($3==4 ? $1 : NaN):2 with points pointtype 8 pointsize 1.3*mark linewidth 1.5 linecolor rgb blue
unset label; unset arrow
unset multiplot
