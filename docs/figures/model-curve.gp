# SPDX-License-Identifier: Apache-2.0
# gnuplot model-curve.gp draws model-curve.svg; gnuplot -e "kind='png'" model-curve.gp draws model-curve.png. gnuplot 5.4 or later.
if (!exists('kind')) kind = 'svg'
if (!exists('part')) part = ''
if (kind eq 'svg') set terminal svg size 600,760 font 'Arial,14' background 'white'
if (kind eq 'png') set terminal pngcairo size 1200,1520 font 'DejaVu Sans,10.5' background 'white' fontscale 2 linewidth 2 pointscale 2
set output 'model-curve.' . kind . part
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
set xrange [200:7000]
set xtics ('200 µs' 200, '500 µs' 500, '1 ms' 1000, '2 ms' 2000, '5 ms' 5000)
set mxtics 10
set label '{/:Bold What a shorter cycle costs: coarser models}' at screen 0.5,0.9737 center font ',16' textcolor rgb ink
set label 'a level of detail, by how far it may deviate' at screen 0.1600,0.9421 left point pointtype 5 pointsize mark linecolor rgb blue offset 1.6,0 font ',' . small textcolor rgb ink
set label 'bends back: takes longer than a finer one' at screen 0.1600,0.9184 left point pointtype 7 pointsize mark linecolor rgb red offset 1.6,0 font ',' . small textcolor rgb ink
set label 'lost: clear positions called contact, of 300 (fine) and 1,000 (real);' at screen 0.5,0.0526 center font ',' . small noenhanced textcolor rgb ink
set label 'records of docs/measurements/levels.md' at screen 0.5,0.0329 center font ',' . small noenhanced textcolor rgb ink
set label 'dotted: nothing is better in both' at screen 0.5,0.0132 center font ',' . small noenhanced textcolor rgb ink
set multiplot
$marks0 << EOD
2546.54,0.03,0
2416.54,0.1983,0
1868.8,0.3701,0
1557.97,0.7084,0
1293.24,1.4212,0
EOD
$joined0 << EOD
1,1

2546.54,0.03
2416.54,0.1983

2416.54,0.1983
1868.8,0.3701

1868.8,0.3701
1557.97,0.7084

1557.97,0.7084
1293.24,1.4212

EOD
$pareto0 << EOD
1293.24,1.4212
1557.97,1.4212
1557.97,0.7084
1868.8,0.7084
1868.8,0.3701
2416.54,0.3701
2416.54,0.1983
2546.54,0.1983
2546.54,0.03
EOD
set tmargin at screen 0.8500; set bmargin at screen 0.5300
set yrange [0.015:6]
set ytics ('none' 0.03, '0.1 mm' 0.1, '0.3 mm' 0.3, '1 mm' 1, '3 mm' 3)
set label '{/:Bold The fine machine, 249,408 triangles}' at screen 0.1500,0.8658 left font ',14' textcolor rgb ink
set label 'a stop comes earlier by' at screen 0.0233,0.6900 center rotate by 90 textcolor rgb ink
unset xlabel
set label '{/:Bold whole}' at screen 0.7604,0.5670 left front font ',' . small textcolor rgb blue
set label '{/:Bold 0.05 mm}' at screen 0.7482,0.6679 left front font ',' . small textcolor rgb blue
set label '{/:Bold 0.1 mm}' at screen 0.6863,0.7177 left front font ',' . small textcolor rgb blue
set label '{/:Bold 0.2 mm, 2 lost}' at screen 0.6441,0.7523 left front font ',' . small textcolor rgb blue
set label '{/:Bold 0.4 mm, 10 lost}' at screen 0.6009,0.7895 left front font ',' . small textcolor rgb blue
set arrow from screen 0.2147,0.5633 to screen 0.1747,0.5396 filled linewidth 2 linecolor rgb green
set label '{/:Bold better}' at screen 0.2228,0.5538 left font ',' . small textcolor rgb green
set arrow from first 500, graph 0 to first 500, graph 1 nohead back dashtype 2 linewidth 2 linecolor rgb ink
set label 'deadline, 500 µs' at screen 0.3543,0.8355 right font ',' . small textcolor rgb ink
plot $pareto0 using 1:2 with lines linewidth 1.5 dashtype 3 linecolor rgb blue, \
     $joined0 using 1:2 with lines linewidth 0.8 linecolor rgb grey, \
     $marks0 using ($3==0 ? $1 : NaN):2 with points pointtype 5 pointsize mark linecolor rgb blue, \
     $marks0 using ($3==1 ? $1 : NaN):2 with points pointtype 13 pointsize 1.7*mark linecolor rgb ink, \
     $marks0 using ($3==2 ? $1 : NaN):2 with points pointtype 7 pointsize mark linecolor rgb red, \
     $marks0 using ($3==3 ? $1 : NaN):2 with points pointtype 6 pointsize mark linewidth 1.5 linecolor rgb red, \
     $marks0 using ($3==4 ? $1 : NaN):2 with points pointtype 8 pointsize 1.3*mark linewidth 1.5 linecolor rgb blue
unset label; unset arrow
$marks1 << EOD
1670.57,0.03,0
2336.33,0.1204,2
1934.96,0.2405,2
1790.83,0.4928,2
1304.23,0.9177,0
EOD
$joined1 << EOD
1,1

1670.57,0.03
2336.33,0.1204

2336.33,0.1204
1934.96,0.2405

1934.96,0.2405
1790.83,0.4928

1790.83,0.4928
1304.23,0.9177

EOD
$pareto1 << EOD
1304.23,0.9177
1670.57,0.9177
1670.57,0.03
EOD
set tmargin at screen 0.4600; set bmargin at screen 0.1400
set yrange [0.015:6]
set ytics ('none' 0.03, '0.1 mm' 0.1, '0.3 mm' 0.3, '1 mm' 1, '3 mm' 3)
set label '{/:Bold The real machine, 16,442 triangles}' at screen 0.1500,0.4758 left font ',14' textcolor rgb ink
set label 'a stop comes earlier by' at screen 0.0233,0.3000 center rotate by 90 textcolor rgb ink
set xlabel 'time of a certificate at rest, p99, one core'
set label '{/:Bold whole}' at screen 0.6625,0.1770 left front font ',' . small textcolor rgb blue
set label '0.05 mm, bends back' at screen 0.7404,0.2512 left front font ',' . small textcolor rgb red
set label '0.1 mm, 2 lost, bends back' at screen 0.6273,0.3756 left front font ',' . small textcolor rgb red
set arrow from screen 0.6766,0.2882 to screen 0.6766,0.3664 nohead back linecolor rgb grey linewidth 0.7
set label '0.2 mm, 4 lost, bends back' at screen 0.4982,0.3969 left front font ',' . small textcolor rgb red
set arrow from screen 0.6587,0.3265 to screen 0.6587,0.3877 nohead back linecolor rgb grey linewidth 0.7
set label '{/:Bold 0.4 mm, 5 lost}' at screen 0.3697,0.3762 left front font ',' . small textcolor rgb blue
set arrow from screen 0.2147,0.1733 to screen 0.1747,0.1496 filled linewidth 2 linecolor rgb green
set label '{/:Bold better}' at screen 0.2228,0.1638 left font ',' . small textcolor rgb green
set arrow from first 500, graph 0 to first 500, graph 1 nohead back dashtype 2 linewidth 2 linecolor rgb ink
set label 'deadline, 500 µs' at screen 0.3543,0.4455 right font ',' . small textcolor rgb ink
plot $pareto1 using 1:2 with lines linewidth 1.5 dashtype 3 linecolor rgb blue, \
     $joined1 using 1:2 with lines linewidth 0.8 linecolor rgb grey, \
     $marks1 using ($3==0 ? $1 : NaN):2 with points pointtype 5 pointsize mark linecolor rgb blue, \
     $marks1 using ($3==1 ? $1 : NaN):2 with points pointtype 13 pointsize 1.7*mark linecolor rgb ink, \
     $marks1 using ($3==2 ? $1 : NaN):2 with points pointtype 7 pointsize mark linecolor rgb red, \
     $marks1 using ($3==3 ? $1 : NaN):2 with points pointtype 6 pointsize mark linewidth 1.5 linecolor rgb red, \
     $marks1 using ($3==4 ? $1 : NaN):2 with points pointtype 8 pointsize 1.3*mark linewidth 1.5 linecolor rgb blue
unset label; unset arrow
unset multiplot
