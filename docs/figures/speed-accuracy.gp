# SPDX-License-Identifier: Apache-2.0
# gnuplot speed-accuracy.gp draws speed-accuracy.svg; gnuplot -e "kind='png'" speed-accuracy.gp draws speed-accuracy.png. gnuplot 5.4 or later.
if (!exists('kind')) kind = 'svg'
if (!exists('part')) part = ''
if (kind eq 'svg') set terminal svg size 600,880 font 'Arial,14' background 'white'
if (kind eq 'png') set terminal pngcairo size 1200,1760 font 'DejaVu Sans,10.5' background 'white' fontscale 2 linewidth 2 pointscale 2
set output 'speed-accuracy.' . kind . part
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
set lmargin at screen 0.125; set rmargin at screen 0.975
unset key
set logscale xy
set xrange [4.93012:3816.64]
set xtics ('5 ns' 5, '10' 10, '20' 20, '50' 50, '100 ns' 100, '200' 200, '500' 500, '1 µs' 1e3, '10 µs' 1e4, '100 µs' 1e5)
set mxtics 10
set label '{/:Bold Tests of two triangles: time against error}' at screen 0.5,0.9773 center font ',16' textcolor rgb ink
set label 'axguard and exact arithmetic: proven, misses no contact' at screen 0.1350,0.9500 left point pointtype 5 pointsize mark linecolor rgb blue offset 1.6,0 font ',' . small textcolor rgb ink
set label 'the seed paper''s test, float' at screen 0.1350,0.9295 left point pointtype 13 pointsize 1.7*mark linecolor rgb ink offset 1.6,0 font ',' . small textcolor rgb ink
set label 'other tests, float; number: contacts missed' at screen 0.1350,0.9091 left point pointtype 7 pointsize mark linecolor rgb red offset 1.6,0 font ',' . small textcolor rgb ink
set label 'the same in double' at screen 0.1350,0.8886 left point pointtype 6 pointsize mark linewidth 1.5 linecolor rgb red offset 1.6,0 font ',' . small textcolor rgb ink
set label '94068 pairs within 4 m and longer than 1 µm, of 1000 of each of 109 kinds, seed 1' at screen 0.5,0.0455 center font ',' . small noenhanced textcolor rgb ink
set label 'one core of an AMD EPYC, avx512 with 16 lanes, least of 9 passes' at screen 0.5,0.0284 center font ',' . small noenhanced textcolor rgb ink
set label 'all compiled with FMA; axguard in lanes, others a pair at a time; dotted: no test is better in both' at screen 0.5,0.0114 center font ',' . small noenhanced textcolor rgb ink
set multiplot
$marks0 << EOD
7.39518,1e-11,0
40.964,1e-11,0
388.831,1e-11,0
78.0952,0.0188778,2
120.713,1e-09,3
51.4192,0.0188778,2
65.1543,1e-09,3
51.7749,0.0188778,1
60.9654,1e-09,3
311.324,1e-11,2
429.374,1e-11,3
117.029,44721.4,2
126.855,1.60153,3
63.4847,44721.4,2
64.6876,1.60153,3
44.8049,44721.4,2
45.3401,44721.4,3
51.8976,44721.4,2
52.5183,44721.4,3
64.3518,44721.4,2
67.9769,44721.4,3
218.786,1.30661,2
150.555,0.038147,3
583.811,44721.4,2
517.562,9.76563,3
426.669,171.444,2
419.362,1e-11,3
2385.4,1e-11,0
EOD
$joined0 << EOD
1,1

78.0952,0.0188778
120.713,1e-09

51.4192,0.0188778
65.1543,1e-09

51.7749,0.0188778
60.9654,1e-09

311.324,1e-11
429.374,1e-11

117.029,44721.4
126.855,1.60153

63.4847,44721.4
64.6876,1.60153

44.8049,44721.4
45.3401,44721.4

51.8976,44721.4
52.5183,44721.4

64.3518,44721.4
67.9769,44721.4

218.786,1.30661
150.555,0.038147

583.811,44721.4
517.562,9.76563

426.669,171.444
419.362,1e-11

EOD
$pareto0 << EOD
7.39518,1e-11
EOD
set tmargin at screen 0.8300; set bmargin at screen 0.5150
set yrange [1e-12:1e+06]
set ytics ('none' 1e-11, '≤ 1 fm' 1e-9, '1 pm' 1e-6, '1 nm' 1e-3, '1 µm' 1, '1 mm' 1e3, '1 m' 1e6)
set label '{/:Bold Danger: contacts missed}' at screen 0.1250,0.8436 left font ',14' textcolor rgb ink
set ylabel 'deepest contact missed' offset 0.6,0
unset xlabel
set label '{/:Bold axguard stage 1}' at screen 0.1919,0.5491 left front font ',' . small textcolor rgb blue
set label '{/:Bold axguard float}' at screen 0.4156,0.5325 left front font ',' . small textcolor rgb blue
set label '{/:Bold axguard recheck}' at screen 0.7096,0.5501 left front font ',' . small textcolor rgb blue
set label '17 axes 788' at screen 0.4958,0.6806 left front font ',' . small textcolor rgb red
set label '11 axes 763' at screen 0.2744,0.6948 left front font ',' . small textcolor rgb red
set label '{/:Bold seed paper 581}' at screen 0.2295,0.7132 left front font ',' . small textcolor rgb ink
set label '17 axes, epsilon' at screen 0.4537,0.5509 left front font ',' . small textcolor rgb red
set label 'Möller 5767' at screen 0.5497,0.8064 left front font ',' . small textcolor rgb red
set label 'Held 4735' at screen 0.3299,0.7898 left front font ',' . small textcolor rgb red
set label 'Guigue-Devillers 5646' at screen 0.1969,0.7474 left front font ',' . small textcolor rgb red
set arrow from screen 0.4070,0.8064 to screen 0.4070,0.7553 nohead back linecolor rgb grey linewidth 0.7
set label 'Shen 6074' at screen 0.2773,0.8179 left front font ',' . small textcolor rgb red
set arrow from screen 0.4258,0.8064 to screen 0.3872,0.8099 nohead back linecolor rgb grey linewidth 0.7
set label 'Tropp 4971' at screen 0.2915,0.7705 left front font ',' . small textcolor rgb red
set arrow from screen 0.4533,0.8064 to screen 0.4132,0.7785 nohead back linecolor rgb grey linewidth 0.7
set label 'six segments 8258' at screen 0.7010,0.6839 left front font ',' . small textcolor rgb red
set arrow from screen 0.6097,0.7270 to screen 0.6977,0.6918 nohead back linecolor rgb grey linewidth 0.7
set label 'PQP 196' at screen 0.7551,0.8064 left front font ',' . small textcolor rgb red
set label 'GJK 852' at screen 0.6261,0.7836 left front font ',' . small textcolor rgb red
set label '{/:Bold exact}' at screen 0.8291,0.5325 left front font ',' . small textcolor rgb blue
set arrow from screen 0.1905,0.5985 to screen 0.1505,0.5780 filled linewidth 2 linecolor rgb green
set label '{/:Bold better}' at screen 0.1985,0.5903 left font ',' . small textcolor rgb green
plot $pareto0 using 1:2 with lines linewidth 1.5 dashtype 3 linecolor rgb blue, \
     $joined0 using 1:2 with lines linewidth 0.8 linecolor rgb grey, \
     $marks0 using ($3==0 ? $1 : NaN):2 with points pointtype 5 pointsize mark linecolor rgb blue, \
     $marks0 using ($3==1 ? $1 : NaN):2 with points pointtype 13 pointsize 1.7*mark linecolor rgb ink, \
     $marks0 using ($3==2 ? $1 : NaN):2 with points pointtype 7 pointsize mark linecolor rgb red, \
     $marks0 using ($3==3 ? $1 : NaN):2 with points pointtype 6 pointsize mark linewidth 1.5 linecolor rgb red, \
     $marks0 using ($3==4 ? $1 : NaN):2 with points pointtype 8 pointsize 1.3*mark linewidth 1.5 linecolor rgb blue
unset label; unset arrow
$marks1 << EOD
7.39518,10000,0
40.964,1.2207,0
388.831,3.72529e-05,0
78.0952,10000,2
120.713,10000,3
51.4192,19039.4,2
65.1543,17201.7,3
51.7749,25663,1
60.9654,25663,3
311.324,10000,2
429.374,10000,3
117.029,25663,2
126.855,25663,3
63.4847,47907.8,2
64.6876,47907.8,3
44.8049,25663,2
45.3401,25663,3
51.8976,25663,2
52.5183,25663,3
64.3518,65890.1,2
67.9769,65890.1,3
218.786,1250,2
150.555,0.000186265,3
583.811,2.4413,2
517.562,1,3
426.669,75000,2
419.362,10000,3
2385.4,1e-11,0
EOD
$joined1 << EOD
1,1

78.0952,10000
120.713,10000

51.4192,19039.4
65.1543,17201.7

51.7749,25663
60.9654,25663

311.324,10000
429.374,10000

117.029,25663
126.855,25663

63.4847,47907.8
64.6876,47907.8

44.8049,25663
45.3401,25663

51.8976,25663
52.5183,25663

64.3518,65890.1
67.9769,65890.1

218.786,1250
150.555,0.000186265

583.811,2.4413
517.562,1

426.669,75000
419.362,10000

EOD
$pareto1 << EOD
7.39518,10000
40.964,10000
40.964,1.2207
150.555,1.2207
150.555,0.000186265
388.831,0.000186265
388.831,3.72529e-05
2385.4,3.72529e-05
2385.4,1e-11
EOD
set tmargin at screen 0.4550; set bmargin at screen 0.1250
set yrange [1e-12:1e+06]
set ytics ('none' 1e-11, '≤ 1 fm' 1e-9, '1 pm' 1e-6, '1 nm' 1e-3, '1 µm' 1, '1 mm' 1e3, '1 m' 1e6)
set label '{/:Bold Cost: gaps not told from a contact}' at screen 0.1250,0.4686 left font ',14' textcolor rgb ink
set ylabel 'widest gap undecided' offset 0.6,0
set xlabel 'mean time of a pair, touching or apart, whichever is slower'
set label '{/:Bold axguard stage 1}' at screen 0.1413,0.3835 left front font ',' . small textcolor rgb blue
set arrow from screen 0.1768,0.4183 to screen 0.1768,0.3914 nohead back linecolor rgb grey linewidth 0.7
set label '{/:Bold axguard float}' at screen 0.2127,0.3650 left front font ',' . small textcolor rgb blue
set label '{/:Bold axguard recheck}' at screen 0.7009,0.2780 left front font ',' . small textcolor rgb blue
set label '17 axes' at screen 0.5580,0.4183 left front font ',' . small textcolor rgb red
set arrow from screen 0.4780,0.4183 to screen 0.5547,0.4104 nohead back linecolor rgb grey linewidth 0.7
set label '11 axes' at screen 0.3038,0.4013 left front font ',' . small textcolor rgb red
set arrow from screen 0.4246,0.4235 to screen 0.3900,0.4093 nohead back linecolor rgb grey linewidth 0.7
set label '{/:Bold seed paper}' at screen 0.4024,0.3998 left front font ',' . small textcolor rgb ink
set label '17 axes, epsilon' at screen 0.6699,0.4018 left front font ',' . small textcolor rgb red
set label 'Möller' at screen 0.5561,0.4435 left front font ',' . small textcolor rgb red
set label 'Held' at screen 0.4935,0.4423 left front font ',' . small textcolor rgb red
set arrow from screen 0.4515,0.4308 to screen 0.4902,0.4343 nohead back linecolor rgb grey linewidth 0.7
set label 'Guigue-Devillers' at screen 0.1596,0.4402 left front font ',' . small textcolor rgb red
set arrow from screen 0.4070,0.4258 to screen 0.3523,0.4323 nohead back linecolor rgb grey linewidth 0.7
set label 'Shen' at screen 0.3668,0.4442 left front font ',' . small textcolor rgb red
set label 'Tropp' at screen 0.4237,0.3725 left front font ',' . small textcolor rgb red
set arrow from screen 0.4533,0.4333 to screen 0.4533,0.3805 nohead back linecolor rgb grey linewidth 0.7
set label 'six segments' at screen 0.6213,0.3834 left front font ',' . small textcolor rgb red
set label 'PQP' at screen 0.7551,0.3521 left front font ',' . small textcolor rgb red
set label 'GJK' at screen 0.7150,0.4344 left front font ',' . small textcolor rgb red
set label '{/:Bold exact}' at screen 0.8374,0.1617 left front font ',' . small textcolor rgb blue
set arrow from screen 0.1905,0.1587 to screen 0.1505,0.1382 filled linewidth 2 linecolor rgb green
set label '{/:Bold better}' at screen 0.1985,0.1505 left font ',' . small textcolor rgb green
plot $pareto1 using 1:2 with lines linewidth 1.5 dashtype 3 linecolor rgb blue, \
     $joined1 using 1:2 with lines linewidth 0.8 linecolor rgb grey, \
     $marks1 using ($3==0 ? $1 : NaN):2 with points pointtype 5 pointsize mark linecolor rgb blue, \
     $marks1 using ($3==1 ? $1 : NaN):2 with points pointtype 13 pointsize 1.7*mark linecolor rgb ink, \
     $marks1 using ($3==2 ? $1 : NaN):2 with points pointtype 7 pointsize mark linecolor rgb red, \
     $marks1 using ($3==3 ? $1 : NaN):2 with points pointtype 6 pointsize mark linewidth 1.5 linecolor rgb red, \
     $marks1 using ($3==4 ? $1 : NaN):2 with points pointtype 8 pointsize 1.3*mark linewidth 1.5 linecolor rgb blue
unset label; unset arrow
unset multiplot
