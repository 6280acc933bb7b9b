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
0,0,53,2.348
1,0,52,2.304
2,0,47,2.082
3,0,48,2.127
4,0,0,0
0,1,1,0.04431
1,1,1,0.04431
2,1,0,0
3,1,1,0.04431
4,1,0,0
0,2,192,8.507
1,2,191,8.463
2,2,30,1.329
3,2,312,13.82
4,2,224,2.481
5,2,203,8.994
6,2,208,9.216
7,2,41,1.817
8,2,355,15.73
9,2,254,2.813
0,3,137,6.07
1,3,127,5.627
2,3,25,1.108
3,3,246,10.9
4,3,105,1.163
5,3,127,5.627
6,3,135,5.981
7,3,31,1.374
8,3,274,12.14
9,3,126,1.396
0,4,202,8.95
1,4,198,8.773
2,4,31,1.374
3,4,483,21.4
4,4,221,2.448
5,4,205,9.083
6,4,214,9.482
7,4,43,1.905
8,4,507,22.46
9,4,250,2.769
0,5,140,6.203
1,5,133,5.893
2,5,24,1.063
3,5,423,18.74
4,5,104,1.152
5,5,127,5.627
6,5,136,6.026
7,5,30,1.329
8,5,430,19.05
9,5,124,1.374
0,6,187,8.285
1,6,189,8.374
2,6,31,1.374
3,6,294,13.03
4,6,188,2.082
5,6,222,9.836
6,6,223,9.88
7,6,63,2.791
8,6,375,16.61
9,6,225,2.492
0,7,135,5.981
1,7,127,5.627
2,7,22,0.9747
3,7,211,9.349
4,7,86,0.9526
5,7,147,6.513
6,7,155,6.868
7,7,51,2.26
8,7,292,12.94
9,7,109,1.207
0,8,0,0
1,8,0,0
2,8,4,0.1772
3,8,2,0.08861
4,8,0,0
5,8,2,0.08861
6,8,1,0.04431
7,8,5,0.2215
8,8,7,0.3101
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
0,10,389,17.24
1,10,400,17.72
2,10,481,21.31
3,10,642,28.44
4,10,1055,11.69
5,10,466,20.65
6,10,443,19.63
7,10,520,23.04
8,10,732,32.43
9,10,1110,12.3
0,11,64,2.836
1,11,64,2.836
2,11,69,3.057
3,11,74,3.279
4,11,187,2.071
5,11,75,3.323
6,11,69,3.057
7,11,65,2.88
8,11,100,4.431
9,11,182,2.016
0,12,503,22.29
1,12,494,21.89
2,12,602,26.67
3,12,643,28.49
4,12,1248,13.82
5,12,542,24.01
6,12,526,23.31
7,12,615,27.25
8,12,694,30.75
9,12,1309,14.5
0,13,282,12.49
1,13,279,12.36
2,13,263,11.65
3,13,297,13.16
4,13,382,4.231
5,13,293,12.98
6,13,296,13.11
7,13,272,12.05
8,13,319,14.13
9,13,403,4.464
0,14,297,13.16
1,14,302,13.38
2,14,190,8.418
3,14,572,25.34
4,14,750,8.307
5,14,427,18.92
6,14,417,18.48
7,14,293,12.98
8,14,664,29.42
9,14,1081,11.97
0,15,227,10.06
1,15,218,9.659
2,15,134,5.937
3,15,510,22.6
4,15,601,6.657
5,15,346,15.33
6,15,346,15.33
7,15,261,11.56
8,15,603,26.72
9,15,966,10.7
0,16,481,21.31
1,16,479,21.22
2,16,244,10.81
3,16,845,37.44
4,16,1310,14.51
5,16,498,22.06
6,16,498,22.06
7,16,267,11.83
8,16,790,35
9,16,1424,15.77
0,17,265,11.74
1,17,257,11.39
2,17,152,6.735
3,17,300,13.29
4,17,1350,14.95
5,17,277,12.27
6,17,287,12.72
7,17,179,7.931
8,17,323,14.31
9,17,1448,16.04
0,18,82,3.633
1,18,77,3.412
2,18,67,2.969
3,18,75,3.323
4,18,129,1.429
5,18,66,2.924
6,18,70,3.101
7,18,65,2.88
8,18,85,3.766
9,18,113,1.252
0,19,33,1.462
1,19,33,1.462
2,19,31,1.374
3,19,37,1.639
4,19,72,0.7975
5,19,33,1.462
6,19,33,1.462
7,19,31,1.374
8,19,41,1.817
9,19,72,0.7975
0,20,66,2.924
1,20,60,2.658
2,20,60,2.658
3,20,66,2.924
4,20,139,1.54
5,20,67,2.969
6,20,69,3.057
7,20,64,2.836
8,20,71,3.146
9,20,137,1.518
0,21,3,0.1329
1,21,2,0.08861
2,21,1,0.04431
3,21,1,0.04431
4,21,0,0
5,21,6,0.2658
6,21,10,0.4431
7,21,2,0.08861
8,21,4,0.1772
9,21,0,0
END
set ytics scale 0 ('certified-f32' 0, 'certified-f32+f64' 1, 'sat17-f32' 2, 'sat17-f64' 3, 'sat11-f32' 4, 'sat11-f64' 5, 'paper-6-11-f32' 6, 'paper-6-11-f64' 7, 'sat17-normalised-eps-f32' 8, 'sat17-normalised-eps-f64' 9, 'moller-f32' 10, 'moller-f64' 11, 'held-f32' 12, 'held-f64' 13, 'guigue-devillers-f32' 14, 'guigue-devillers-f64' 15, 'six-segment-f32' 16, 'six-segment-f64' 17, 'pqp-distance-f32' 18, 'pqp-distance-f64' 19, 'gjk-f32' 20, 'gjk-f64' 21) noenhanced
set x2tics scale 0 ("as it is" 0, "quarter turn" 1, "1.5 m away" 2, "turned" 3, "contacts\ncalled apart" 4, "as it is" 5, "quarter turn" 6, "1.5 m away" 7, "turned" 8, "contacts\ncalled apart" 9)
small = kind eq 'svg' ? '11.5' : '8.5'
set lmargin at screen 0.1896; set rmargin at screen 0.9800
set bmargin at screen 0.0731; set tmargin at screen 0.7807
set label "Pairs whose verdict changes with the order of vertices and triangles" \
    at screen 0.5,0.9678 center font ',16'
set label 'of 2257 pairs in 72 orders each, in each frame rounded to what the method computes in; last columns: all frames' at screen 0.5,0.0292 center font ',' . small
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
