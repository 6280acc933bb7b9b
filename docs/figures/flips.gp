# SPDX-License-Identifier: Apache-2.0
# gnuplot flips.gp draws flips.svg; gnuplot -e "kind='png'" flips.gp draws flips.png. gnuplot 5.4 or later.
if (!exists('kind')) kind = 'svg'
if (!exists('part')) part = ''
if (kind eq 'svg') set terminal svg size 1002,684 font 'Arial,14' background 'white'
if (kind eq 'png') set terminal pngcairo size 1002,684 font 'DejaVu Sans,10.5' background 'white'
set output 'flips.' . kind . part
set encoding utf8
set datafile separator ','
# Okabe and Ito's colours, which people who see few colours tell apart; in grey they differ too.
ink = '#202020'; grey = '#8a8a8a'; pale = '#dddddd'
blue = '#0b5394'; red = '#d55e00'; green = '#009e73'; gold = '#e69f00'; sky = '#56b4e9'
set border 3 linecolor rgb grey
set tics nomirror textcolor rgb ink
set grid linecolor rgb pale linetype 1 linewidth 0.7
$cells << END
0,0,55,2.436
1,0,53,2.347
2,0,49,2.17
3,0,46,2.037
4,0,0,0
0,1,1,0.04429
1,1,1,0.04429
2,1,0,0
3,1,1,0.04429
4,1,0,0
0,2,193,8.547
1,2,191,8.459
2,2,30,1.329
3,2,325,14.39
4,2,222,2.458
5,2,207,9.167
6,2,212,9.389
7,2,40,1.771
8,2,354,15.68
9,2,248,2.746
0,3,128,5.669
1,3,120,5.314
2,3,25,1.107
3,3,244,10.81
4,3,97,1.074
5,3,128,5.669
6,3,132,5.846
7,3,30,1.329
8,3,279,12.36
9,3,133,1.473
0,4,202,8.946
1,4,200,8.857
2,4,31,1.373
3,4,498,22.05
4,4,219,2.425
5,4,210,9.3
6,4,220,9.743
7,4,42,1.86
8,4,509,22.54
9,4,245,2.713
0,5,132,5.846
1,5,127,5.624
2,5,24,1.063
3,5,422,18.69
4,5,95,1.052
5,5,129,5.713
6,5,133,5.89
7,5,29,1.284
8,5,429,19
9,5,131,1.45
0,6,187,8.282
1,6,192,8.503
2,6,31,1.373
3,6,300,13.29
4,6,185,2.048
5,6,229,10.14
6,6,231,10.23
7,6,62,2.746
8,6,371,16.43
9,6,219,2.425
0,7,129,5.713
1,7,123,5.447
2,7,22,0.9743
3,7,210,9.3
4,7,77,0.8525
5,7,150,6.643
6,7,154,6.82
7,7,51,2.259
8,7,295,13.06
9,7,116,1.284
0,8,0,0
1,8,0,0
2,8,4,0.1771
3,8,2,0.08857
4,8,0,0
5,8,2,0.08857
6,8,1,0.04429
7,8,5,0.2214
8,8,7,0.31
9,8,0,0
0,9,0,0
1,9,0,0
2,9,0,0
3,9,0,0
4,9,0,0
5,9,0,0
6,9,0,0
7,9,0,0
8,9,0,0
9,9,0,0
0,10,391,17.32
1,10,405,17.94
2,10,481,21.3
3,10,650,28.79
4,10,1056,11.69
5,10,470,20.81
6,10,454,20.11
7,10,512,22.67
8,10,735,32.55
9,10,1106,12.25
0,11,63,2.79
1,11,63,2.79
2,11,69,3.056
3,11,70,3.1
4,11,201,2.225
5,11,74,3.277
6,11,71,3.144
7,11,67,2.967
8,11,97,4.296
9,11,196,2.17
0,12,498,22.05
1,12,492,21.79
2,12,601,26.62
3,12,644,28.52
4,12,1223,13.54
5,12,537,23.78
6,12,536,23.74
7,12,610,27.02
8,12,692,30.65
9,12,1296,14.35
0,13,272,12.05
1,13,275,12.18
2,13,262,11.6
3,13,286,12.67
4,13,375,4.152
5,13,288,12.75
6,13,291,12.89
7,13,269,11.91
8,13,321,14.22
9,13,399,4.418
0,14,298,13.2
1,14,303,13.42
2,14,190,8.415
3,14,570,25.24
4,14,742,8.215
5,14,434,19.22
6,14,423,18.73
7,14,294,13.02
8,14,664,29.41
9,14,1077,11.92
0,15,226,10.01
1,15,221,9.787
2,15,134,5.934
3,15,500,22.14
4,15,596,6.599
5,15,347,15.37
6,15,352,15.59
7,15,263,11.65
8,15,602,26.66
9,15,971,10.75
0,16,486,21.52
1,16,480,21.26
2,16,245,10.85
3,16,844,37.38
4,16,1302,14.42
5,16,504,22.32
6,16,504,22.32
7,16,267,11.82
8,16,785,34.77
9,16,1416,15.68
0,17,260,11.51
1,17,255,11.29
2,17,151,6.687
3,17,305,13.51
4,17,1354,14.99
5,17,271,12
6,17,282,12.49
7,17,177,7.839
8,17,325,14.39
9,17,1447,16.02
0,18,78,3.454
1,18,73,3.233
2,18,65,2.879
3,18,78,3.454
4,18,127,1.406
5,18,62,2.746
6,18,67,2.967
7,18,63,2.79
8,18,83,3.676
9,18,108,1.196
0,19,31,1.373
1,19,31,1.373
2,19,29,1.284
3,19,36,1.594
4,19,72,0.7972
5,19,31,1.373
6,19,31,1.373
7,19,29,1.284
8,19,39,1.727
9,19,72,0.7972
0,20,64,2.834
1,20,62,2.746
2,20,61,2.702
3,20,70,3.1
4,20,142,1.572
5,20,69,3.056
6,20,71,3.144
7,20,63,2.79
8,20,73,3.233
9,20,141,1.561
0,21,3,0.1329
1,21,3,0.1329
2,21,1,0.04429
3,21,1,0.04429
4,21,0,0
5,21,6,0.2657
6,21,10,0.4429
7,21,0,0
8,21,2,0.08857
9,21,0,0
END
set ytics scale 0 ('certified-f32' 0, 'certified-f32+f64' 1, 'sat17-f32' 2, 'sat17-f64' 3, 'sat11-f32' 4, 'sat11-f64' 5, 'paper-6-11-f32' 6, 'paper-6-11-f64' 7, 'sat17-normalised-eps-f32' 8, 'sat17-normalised-eps-f64' 9, 'moller-f32' 10, 'moller-f64' 11, 'held-f32' 12, 'held-f64' 13, 'guigue-devillers-f32' 14, 'guigue-devillers-f64' 15, 'six-segment-f32' 16, 'six-segment-f64' 17, 'pqp-distance-f32' 18, 'pqp-distance-f64' 19, 'gjk-f32' 20, 'gjk-f64' 21) noenhanced
set x2tics scale 0 ("as it is" 0, "quarter turn" 1, "1.5 m away" 2, "turned" 3, "contacts\ncalled apart" 4, "as it is" 5, "quarter turn" 6, "1.5 m away" 7, "turned" 8, "contacts\ncalled apart" 9)
small = kind eq 'svg' ? '11.5' : '8.5'
set lmargin at screen 0.1896; set rmargin at screen 0.9800
set bmargin at screen 0.0731; set tmargin at screen 0.7807
set label "Pairs whose verdict changes with the order of vertices and triangles" \
    at screen 0.5,0.9678 center font ',16'
set label 'of 2258 pairs in 72 orders each, in each frame rounded to what the method computes in; last columns: all frames' at screen 0.5,0.0292 center font ',' . small
set label "compiled without contraction" at first 1.5, screen 0.8904 center font ',' . small
set label "contraction allowed (FMA)" at first 6.5, screen 0.8904 center font ',' . small
unset xtics; unset grid; unset border; unset key
set link x2
set ytics font ',' . small; set x2tics font ',' . small
set xrange [-0.5:9.5]
set yrange [21.5:-0.5]
set palette defined (0 '#fdeec4', 1 '#f5b041', 2 '#d1480b', 3 '#7a1d08')
set logscale cb
set cbrange [0.1:100]
unset colorbox
set style fill solid 1 noborder
set arrow from 4.5,graph 0 to 4.5,graph 1 nohead front linecolor rgb grey linewidth 2
plot $cells using ($3>0 ? $1 : NaN):2:($1-0.47):($1+0.47):($2-0.45):($2+0.45):4 with boxxyerror \
       linecolor palette, \
     '' using 1:2:(sprintf('%d',$3)):($3==0 ? 0x0b5394 : $4>10 ? 0xffffff : 0x202020) \
       with labels textcolor rgb variable font ',' . small
