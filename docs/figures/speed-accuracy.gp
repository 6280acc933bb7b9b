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
set lmargin at screen 0.15; set rmargin at screen 0.975
unset key
set logscale xy
set xrange [4.91104:1180.38]
set xtics ('5 ns' 5, '10' 10, '20' 20, '50' 50, '100 ns' 100, '200' 200, '500' 500, '1 µs' 1e3, '10 µs' 1e4, '100 µs' 1e5)
set mxtics 10
set label '{/:Bold Tests of two triangles: time against error}' at screen 0.5,0.9773 center font ',16' textcolor rgb ink
set label 'axguard and exact arithmetic: proven, misses no contact' at screen 0.1600,0.9500 left point pointtype 5 pointsize mark linecolor rgb blue offset 1.6,0 font ',' . small textcolor rgb ink
set label 'the seed paper''s test, float' at screen 0.1600,0.9295 left point pointtype 13 pointsize 1.7*mark linecolor rgb ink offset 1.6,0 font ',' . small textcolor rgb ink
set label 'other tests, float; number: contacts missed' at screen 0.1600,0.9091 left point pointtype 7 pointsize mark linecolor rgb red offset 1.6,0 font ',' . small textcolor rgb ink
set label 'the same in double' at screen 0.1600,0.8886 left point pointtype 6 pointsize mark linewidth 1.5 linecolor rgb red offset 1.6,0 font ',' . small textcolor rgb ink
set label '94068 pairs within 4 m and longer than 1 µm, of 1000 of each of 109 kinds, seed 1' at screen 0.5,0.0455 center font ',' . small noenhanced textcolor rgb ink
set label 'one core of an AMD EPYC, avx512 with 16 lanes, least of 9 passes' at screen 0.5,0.0284 center font ',' . small noenhanced textcolor rgb ink
set label 'all compiled with FMA; axguard in lanes, others a pair at a time; dotted: no test is better in both' at screen 0.5,0.0114 center font ',' . small noenhanced textcolor rgb ink
set multiplot
$marks0 << EOD
7.36655,1e-11,0
39.8741,1e-11,0
137.385,1e-11,0
78.0544,0.0188778,2
90.2747,1e-09,3
51.4699,0.0188778,2
63.3429,1e-09,3
51.5256,0.0188778,1
59.401,1e-09,3
155.925,1e-11,2
184.292,1e-11,3
66.486,44721.4,2
63.8074,1.60153,3
64.0546,44721.4,2
63.6841,1.60153,3
44.6683,44721.4,2
45.3992,44721.4,3
52.68,44721.4,2
52.4357,44721.4,3
65.9749,44721.4,2
66.3955,44721.4,3
89.1095,1.30661,2
80.8116,0.038147,3
209.507,44721.4,2
215.584,9.76563,3
162.562,171.444,2
173.229,1e-11,3
737.74,1e-11,0
EOD
$joined0 << EOD
1,1

78.0544,0.0188778
90.2747,1e-09

51.4699,0.0188778
63.3429,1e-09

51.5256,0.0188778
59.401,1e-09

155.925,1e-11
184.292,1e-11

66.486,44721.4
63.8074,1.60153

64.0546,44721.4
63.6841,1.60153

44.6683,44721.4
45.3992,44721.4

52.68,44721.4
52.4357,44721.4

65.9749,44721.4
66.3955,44721.4

89.1095,1.30661
80.8116,0.038147

209.507,44721.4
215.584,9.76563

162.562,171.444
173.229,1e-11

EOD
$pareto0 << EOD
7.36655,1e-11
EOD
set tmargin at screen 0.8300; set bmargin at screen 0.5150
set yrange [1e-12:1e+06]
set ytics ('none' 1e-11, '≤ 1 fm' 1e-9, '1 pm' 1e-6, '1 nm' 1e-3, '1 µm' 1, '1 mm' 1e3, '1 m' 1e6)
set label '{/:Bold Danger: contacts missed}' at screen 0.1500,0.8436 left font ',14' textcolor rgb ink
set label 'deepest contact missed' at screen 0.0233,0.6725 center rotate by 90 textcolor rgb ink
unset xlabel
set label '{/:Bold axguard stage 1}' at screen 0.1662,0.5520 left front font ',' . small textcolor rgb blue
set label '{/:Bold axguard float}' at screen 0.2607,0.5325 left front font ',' . small textcolor rgb blue
set label '{/:Bold axguard recheck}' at screen 0.4288,0.5509 left front font ',' . small textcolor rgb blue
set label '17 axes 788' at screen 0.3454,0.6769 left front font ',' . small textcolor rgb red
set arrow from screen 0.5662,0.6948 to screen 0.4922,0.6848 nohead back linecolor rgb grey linewidth 0.7
set label '11 axes 763' at screen 0.3401,0.6948 left front font ',' . small textcolor rgb red
set label '{/:Bold seed paper 581}' at screen 0.2944,0.7132 left front font ',' . small textcolor rgb ink
set label '17 axes, epsilon' at screen 0.6968,0.5501 left front font ',' . small textcolor rgb red
set label 'Möller 5767' at screen 0.3835,0.7898 left front font ',' . small textcolor rgb red
set label 'Held 4735' at screen 0.5482,0.7880 left front font ',' . small textcolor rgb red
set label 'Guigue-Devillers 5646' at screen 0.1770,0.7705 left front font ',' . small textcolor rgb red
set arrow from screen 0.4822,0.8064 to screen 0.4422,0.7785 nohead back linecolor rgb grey linewidth 0.7
set label 'Shen 6074' at screen 0.3453,0.8179 left front font ',' . small textcolor rgb red
set arrow from screen 0.5071,0.8064 to screen 0.4684,0.8099 nohead back linecolor rgb grey linewidth 0.7
set label 'Tropp 4971' at screen 0.5609,0.8064 left front font ',' . small textcolor rgb red
set label 'six segments 8258' at screen 0.2943,0.7450 left front font ',' . small textcolor rgb red
set arrow from screen 0.5862,0.7270 to screen 0.5121,0.7370 nohead back linecolor rgb grey linewidth 0.7
set label 'PQP 196' at screen 0.7348,0.8064 left front font ',' . small textcolor rgb red
set label 'GJK 852' at screen 0.5605,0.7641 left front font ',' . small textcolor rgb red
set label '{/:Bold exact}' at screen 0.8051,0.5325 left front font ',' . small textcolor rgb blue
set arrow from screen 0.2147,0.5985 to screen 0.1747,0.5780 filled linewidth 2 linecolor rgb green
set label '{/:Bold better}' at screen 0.2228,0.5903 left font ',' . small textcolor rgb green
plot $pareto0 using 1:2 with lines linewidth 1.5 dashtype 3 linecolor rgb blue, \
     $joined0 using 1:2 with lines linewidth 0.8 linecolor rgb grey, \
     $marks0 using ($3==0 ? $1 : NaN):2 with points pointtype 5 pointsize mark linecolor rgb blue, \
     $marks0 using ($3==1 ? $1 : NaN):2 with points pointtype 13 pointsize 1.7*mark linecolor rgb ink, \
     $marks0 using ($3==2 ? $1 : NaN):2 with points pointtype 7 pointsize mark linecolor rgb red, \
     $marks0 using ($3==3 ? $1 : NaN):2 with points pointtype 6 pointsize mark linewidth 1.5 linecolor rgb red, \
     $marks0 using ($3==4 ? $1 : NaN):2 with points pointtype 8 pointsize 1.3*mark linewidth 1.5 linecolor rgb blue
unset label; unset arrow
$marks1 << EOD
7.36655,10000,0
39.8741,1.2207,0
137.385,3.72529e-05,0
78.0544,10000,2
90.2747,10000,3
51.4699,19039.4,2
63.3429,17201.7,3
51.5256,25663,1
59.401,25663,3
155.925,10000,2
184.292,10000,3
66.486,25663,2
63.8074,25663,3
64.0546,47907.8,2
63.6841,47907.8,3
44.6683,25663,2
45.3992,25663,3
52.68,25663,2
52.4357,25663,3
65.9749,65890.1,2
66.3955,65890.1,3
89.1095,1250,2
80.8116,0.000186265,3
209.507,2.4413,2
215.584,1,3
162.562,75000,2
173.229,10000,3
737.74,1e-11,0
EOD
$joined1 << EOD
1,1

78.0544,10000
90.2747,10000

51.4699,19039.4
63.3429,17201.7

51.5256,25663
59.401,25663

155.925,10000
184.292,10000

66.486,25663
63.8074,25663

64.0546,47907.8
63.6841,47907.8

44.6683,25663
45.3992,25663

52.68,25663
52.4357,25663

65.9749,65890.1
66.3955,65890.1

89.1095,1250
80.8116,0.000186265

209.507,2.4413
215.584,1

162.562,75000
173.229,10000

EOD
$pareto1 << EOD
7.36655,10000
39.8741,10000
39.8741,1.2207
80.8116,1.2207
80.8116,0.000186265
137.385,0.000186265
137.385,3.72529e-05
737.74,3.72529e-05
737.74,1e-11
EOD
set tmargin at screen 0.4550; set bmargin at screen 0.1250
set yrange [1e-12:1e+06]
set ytics ('none' 1e-11, '≤ 1 fm' 1e-9, '1 pm' 1e-6, '1 nm' 1e-3, '1 µm' 1, '1 mm' 1e3, '1 m' 1e6)
set label '{/:Bold Cost: gaps not told from a contact}' at screen 0.1500,0.4686 left font ',14' textcolor rgb ink
set label 'widest gap undecided' at screen 0.0233,0.2900 center rotate by 90 textcolor rgb ink
set xlabel 'mean time of a pair, touching or apart, whichever is slower'
set label '{/:Bold axguard stage 1}' at screen 0.1882,0.3429 left front font ',' . small textcolor rgb blue
set arrow from screen 0.2110,0.4183 to screen 0.2110,0.3508 nohead back linecolor rgb grey linewidth 0.7
set label '{/:Bold axguard float}' at screen 0.2690,0.3650 left front font ',' . small textcolor rgb blue
set label '{/:Bold axguard recheck}' at screen 0.6691,0.2780 left front font ',' . small textcolor rgb blue
set label '17 axes' at screen 0.4769,0.3725 left front font ',' . small textcolor rgb red
set arrow from screen 0.5662,0.4183 to screen 0.5662,0.3804 nohead back linecolor rgb grey linewidth 0.7
set label '11 axes' at screen 0.5616,0.4379 left front font ',' . small textcolor rgb red
set arrow from screen 0.5036,0.4235 to screen 0.5583,0.4299 nohead back linecolor rgb grey linewidth 0.7
set label '{/:Bold seed paper}' at screen 0.3063,0.3980 left front font ',' . small textcolor rgb ink
set arrow from screen 0.5037,0.4258 to screen 0.4547,0.4060 nohead back linecolor rgb grey linewidth 0.7
set label '17 axes, epsilon' at screen 0.6968,0.4359 left front font ',' . small textcolor rgb red
set label 'Möller' at screen 0.5996,0.3804 left front font ',' . small textcolor rgb red
set arrow from screen 0.5421,0.4258 to screen 0.5963,0.3883 nohead back linecolor rgb grey linewidth 0.7
set label 'Held' at screen 0.4818,0.4047 left front font ',' . small textcolor rgb red
set label 'Guigue-Devillers' at screen 0.2215,0.4402 left front font ',' . small textcolor rgb red
set arrow from screen 0.4822,0.4258 to screen 0.4275,0.4323 nohead back linecolor rgb grey linewidth 0.7
set label 'Shen' at screen 0.4347,0.4442 left front font ',' . small textcolor rgb red
set label 'Tropp' at screen 0.6107,0.3987 left front font ',' . small textcolor rgb red
set arrow from screen 0.5409,0.4333 to screen 0.6073,0.4066 nohead back linecolor rgb grey linewidth 0.7
set label 'six segments' at screen 0.6912,0.4018 left front font ',' . small textcolor rgb red
set arrow from screen 0.5862,0.4018 to screen 0.6878,0.3938 nohead back linecolor rgb grey linewidth 0.7
set label 'PQP' at screen 0.7348,0.3521 left front font ',' . small textcolor rgb red
set label 'GJK' at screen 0.7183,0.3806 left front font ',' . small textcolor rgb red
set arrow from screen 0.6766,0.4344 to screen 0.7150,0.3885 nohead back linecolor rgb grey linewidth 0.7
set label '{/:Bold exact}' at screen 0.8134,0.1617 left front font ',' . small textcolor rgb blue
set arrow from screen 0.2147,0.1587 to screen 0.1747,0.1382 filled linewidth 2 linecolor rgb green
set label '{/:Bold better}' at screen 0.2228,0.1505 left font ',' . small textcolor rgb green
plot $pareto1 using 1:2 with lines linewidth 1.5 dashtype 3 linecolor rgb blue, \
     $joined1 using 1:2 with lines linewidth 0.8 linecolor rgb grey, \
     $marks1 using ($3==0 ? $1 : NaN):2 with points pointtype 5 pointsize mark linecolor rgb blue, \
     $marks1 using ($3==1 ? $1 : NaN):2 with points pointtype 13 pointsize 1.7*mark linecolor rgb ink, \
     $marks1 using ($3==2 ? $1 : NaN):2 with points pointtype 7 pointsize mark linecolor rgb red, \
     $marks1 using ($3==3 ? $1 : NaN):2 with points pointtype 6 pointsize mark linewidth 1.5 linecolor rgb red, \
     $marks1 using ($3==4 ? $1 : NaN):2 with points pointtype 8 pointsize 1.3*mark linewidth 1.5 linecolor rgb blue
unset label; unset arrow
unset multiplot
