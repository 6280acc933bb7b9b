# SPDX-License-Identifier: Apache-2.0
# gnuplot not-told-apart.gp draws not-told-apart.svg; gnuplot -e "kind='png'" not-told-apart.gp draws not-told-apart.png. gnuplot 5.4 or later.
if (!exists('kind')) kind = 'svg'
if (!exists('part')) part = ''
if (kind eq 'svg') set terminal svg size 983,1163 font 'Arial,14' background 'white'
if (kind eq 'png') set terminal pngcairo size 983,1163 font 'DejaVu Sans,10.5' background 'white'
set output 'not-told-apart.' . kind . part
set encoding utf8
set datafile separator ','
# Okabe and Ito's colours, which people who see few colours tell apart; in grey they differ too.
ink = '#202020'; grey = '#8a8a8a'; pale = '#dddddd'
blue = '#0b5394'; red = '#d55e00'; green = '#009e73'; gold = '#e69f00'; sky = '#56b4e9'
set border 3 linecolor rgb grey
set tics nomirror textcolor rgb ink
set grid linecolor rgb pale linetype 1 linewidth 0.7
$cells << END
13,0,12.5,0
0,1,13,0
0,2,16.63,0
0,3,22.83,0
0,4,2.286,0
21,4,0.5714,0
23,4,0.5714,0
0,5,2.279,0
11,5,3.704,0
13,5,1.14,0
19,5,1.994,0
21,5,0.2849,0
23,5,0.2849,0
25,5,0.2849,0
11,6,23.56,0
13,6,15.56,0
17,6,23.56,0
19,6,2,0
0,7,12.79,0
13,7,11.09,0
25,7,0.2132,0
0,8,36.02,0
25,8,1.075,0
0,9,0.3472,0
25,9,0.6944,0
0,10,0.2469,0
25,10,0.2469,0
13,11,1.222,0
19,11,0.2445,0
25,11,0.2445,0
0,12,97.8,1e+04
5,12,0.978,0
7,12,0.978,0
11,12,1.711,0
17,12,0.2445,0
21,12,1.956,0
23,12,0.2445,0
0,13,28.52,0
0,14,3.509,0
21,14,1.053,0
23,14,1.404,0
0,15,5.864,0
0,16,18.94,0
0,17,1.027,0
23,18,0.6557,0
25,19,0.3378,0
21,20,1.65,0
0,21,0.9901,0
11,21,20.46,0
13,21,12.21,0
17,21,10.07,0
19,21,7.261,0
23,21,34.82,0
0,22,0.277,0
0,23,5.648,0
5,23,4.319,0
11,23,1.661,0
15,23,7.973,0
17,23,7.973,0
21,23,14.95,0
25,24,0.7426,2500
0,25,12.32,0
25,25,0.3571,2344
26,25,0.722,4687
0,26,1.603,0
5,26,0.2004,0
7,26,0.2004,0
11,26,0.4008,0
13,26,0.8016,0
14,26,1.156,0
15,26,0.4008,0
16,26,0.289,0
17,26,0.6012,0
19,26,1.002,0
21,26,2.405,3168
25,26,0.4008,0
26,26,0.289,0
13,27,0.2488,0
14,27,0.4975,0
19,27,0.2488,0
20,27,0.4975,0
7,28,0.2342,0
12,28,0.369,0
15,28,0.4684,1690
17,28,0.4684,0
18,28,0.369,0
21,28,0.4684,0
25,28,0.7026,1032
26,28,0.369,0
25,29,1.119,2500
26,29,1.293,0
0,30,10.31,0
5,30,100,1e+04
6,30,100,1e+04
5,31,100,1.904e+04
6,31,100,1.72e+04
0,32,0.2646,3750
5,32,100,1.48e+04
6,32,100,1.38e+04
15,32,0.7937,1.23e+04
16,32,0.8043,4474
0,33,10.38,0
5,33,100,1e+04
6,33,100,1e+04
23,33,0.3145,0
0,34,8.081,0
5,34,100,1e+04
6,34,100,1e+04
0,35,100,1e+04
5,35,100,1e+04
6,35,100,1e+04
23,35,0.4673,0
0,36,8.421,0
5,36,4.561,0
6,36,5.479,0
11,36,15.09,5000
15,36,3.158,1e+04
16,36,1.37,1250
17,36,15.09,5000
18,36,14.38,1e+04
21,36,6.316,1250
0,37,7.383,0
5,37,23.83,1e+04
6,37,27.03,1e+04
11,37,18.79,1e+04
15,37,7.718,2382
16,37,6.757,0
17,37,15.77,5000
18,37,13.51,5000
21,37,15.1,2382
23,37,0.3356,0
0,38,0.7905,0
0,39,1.172,0
0,40,0.7874,0
26,40,0.8333,0
0,41,0.8299,0
26,41,0.9615,0
0,42,0.3846,0
25,42,0.3846,0
0,43,0.4016,0
25,43,1.205,0
0,44,2.135,0
26,44,0.8772,0
0,45,1.487,0
0,46,2.058,0
0,47,52.9,0
5,47,100,0
6,47,100,0
0,48,36.29,0
5,48,100,0
6,48,100,0
0,49,52.02,0
5,49,100,0
6,49,100,0
0,50,54.22,0
5,50,100,0
6,50,100,0
0,51,32.35,0
5,51,100,0
6,51,100,0
0,52,53.3,0
5,52,100,0
6,52,100,0
7,53,0.2907,2.566e+04
8,53,0.2907,2.566e+04
11,53,0.2907,2.566e+04
12,53,0.2907,2.566e+04
13,53,0.2907,2.566e+04
14,53,0.2907,2.566e+04
15,53,0.2907,2.566e+04
16,53,0.2907,2.566e+04
17,53,0.2907,2.566e+04
18,53,0.2907,2.566e+04
19,53,0.2907,6.454e+04
20,53,0.2907,6.454e+04
7,54,0.2845,0
8,54,0.2845,0
11,54,0.1422,0
12,54,0.1422,0
13,54,0.1422,0
14,54,0.2845,0
15,54,0.1422,0
16,54,0.1422,0
17,54,0.1422,0
18,54,0.1422,0
19,54,0.2845,1600
20,54,0.4267,1961
0,55,2.266,0
5,55,2.115,1.15e+04
6,55,2.115,1.15e+04
0,56,4.036,0
0,57,0.295,0
23,57,0.295,0
25,57,0.295,0
26,57,0.2933,0
0,58,30.88,0
23,58,1.416,0
24,58,2.557,0
25,58,0.8499,0
26,58,1.136,0
0,59,5.351,0
13,60,4.306,0
0,61,36.01,0
1,61,12.76,0
9,61,0.2058,0
21,61,0.2058,0
23,61,0.4115,0
25,61,0.6173,0
0,62,39.54,1374
1,62,24.67,0
3,62,8.66,0
5,62,8.66,0
7,62,8.824,2.116e+06
9,62,9.641,0
11,62,2.288,0
13,62,3.758,0
15,62,4.902,0
17,62,2.288,0
19,62,6.046,0
21,62,8.333,0
23,62,5.392,0
25,62,1.307,0
0,63,41.82,1.099e+04
1,63,23.06,0
3,63,4.647,0
5,63,4.819,0
7,63,4.819,0
9,63,3.787,0
11,63,4.475,0
13,63,1.033,2746
15,63,11.88,0
17,63,1.033,0
19,63,1.893,0
21,63,17.9,2.813e+06
23,63,2.41,0
25,63,0.3442,0
7,64,1.515,1223
8,64,1.987,0
11,64,1.515,1223
12,64,1.987,0
13,64,41.82,1e+04
14,64,39.07,1e+04
15,64,1.515,1223
16,64,1.987,0
17,64,1.515,1223
18,64,1.987,0
19,64,38.79,1e+04
20,64,42.38,1e+04
13,65,44.11,1e+04
14,65,42.27,5000
19,65,38.34,1e+04
20,65,39.09,1e+04
5,66,4.03,5000
6,66,2.083,2500
13,66,3.023,0
14,66,4.688,0
15,66,3.526,5000
16,66,1.562,2500
19,66,3.778,0
20,66,4.167,0
23,66,0.2519,0
7,67,100,1e+04
8,67,100,1e+04
11,67,76.13,1e+04
12,67,73.4,1e+04
13,67,76.13,1e+04
14,67,73.4,1e+04
15,67,76.13,1e+04
16,67,73.4,1e+04
17,67,76.13,1e+04
18,67,73.4,1e+04
19,67,76.13,1e+04
20,67,73.4,1e+04
23,67,2.01,0
0,68,100,1e+04
1,68,0.8811,0
3,68,100,1e+04
4,68,100,1e+04
5,68,100,1e+04
6,68,100,1e+04
7,68,100,1e+04
8,68,100,1e+04
9,68,100,1e+04
10,68,100,1e+04
15,68,63.44,1e+04
16,68,59.83,1e+04
0,69,100,1e+04
3,69,100,1e+04
4,69,100,1e+04
5,69,100,1e+04
6,69,100,1e+04
7,69,100,1e+04
8,69,100,1e+04
9,69,100,1e+04
10,69,100,1e+04
15,69,100,1e+04
16,69,100,1e+04
0,70,3.125,0
13,70,34.38,4.791e+04
14,70,45.45,4.791e+04
19,70,10.94,6.589e+04
20,70,6.061,6.589e+04
END
set ytics scale 0 ('pierced by a needle' 0, 'vertex on face, 300 mm' 1, 'vertex on face, 1 m' 2, 'vertex on sliver 1e2' 3, 'vertex on sliver 1e4' 4, 'vertex on sliver 1e6' 5, 'vertex on face, 1e5 mm away' 6, 'small vertex on large face' 7, 'large vertex on small face' 8, 'edges' 9, 'edges of slivers 1e4' 10, 'edges of slivers 1e6' 11, 'needles along one another' 12, 'edges, angle 2^-6' 13, 'edges, angle 2^-12' 14, 'edges, angle 2^-26' 15, 'parallel edges, 1 m' 16, 'edges, grid' 17, 'edges, 1e4 mm away' 18, 'edges, one way' 19, 'vertex on edge of sliver 1e5' 20, 'vertex on edge, 1e5 mm away' 21, 'vertex on vertex' 22, 'tips of needles' 23, 'parallel faces' 24, 'parallel faces, 300 mm' 25, 'parallel slivers' 26, 'parallel faces, grid' 27, 'nearly parallel faces' 28, 'parallel faces, one way' 29, 'one plane, vertex at edge' 30, 'one plane, anywhere' 31, 'one plane, grid' 32, 'one plane, edges on one line' 33, 'one plane, edges, grid' 34, 'one plane, slivers' 35, 'one plane, turned and rounded' 36, 'one plane, rational turn' 37, 'only edges 0, 0' 38, 'only edges 0, 1' 39, 'only edges 0, 2' 40, 'only edges 1, 0' 41, 'only edges 1, 1' 42, 'only edges 1, 2' 43, 'only edges 2, 0' 44, 'only edges 2, 1' 45, 'only edges 2, 2' 46, 'only in-plane 0 of a' 47, 'only in-plane 1 of a' 48, 'only in-plane 2 of a' 49, 'only in-plane 0 of b' 50, 'only in-plane 1 of b' 51, 'only in-plane 2 of b' 52, 'lattice, integer turn' 53, 'lattice, rational turn' 54, 'sides of boxes, micrometre grid' 55, 'cutter in a slot' 56, 'trunnion, vertex on face' 57, 'trunnion, edges' 58, 'small steps of a rotary axis' 59, 'subnormal against 1 mm' 60, 'large 1e4' 61, 'large 1e5' 62, 'large 1e5 against small' 63, 'segment on face' 64, 'point on face' 65, 'point on edge, grid' 66, 'segments' 67, 'segments in one plane, grid' 68, 'points' 69, 'pierced by a rounded line' 70) noenhanced
set x2tics scale 0 rotate by 60 left ('certified-shared-f32' 0, 'certified-f32' 1, 'certified-f32+f64' 2, 'sat17-f32' 3, 'sat17-f64' 4, 'sat11-f32' 5, 'sat11-f64' 6, 'paper-6-11-f32' 7, 'paper-6-11-f64' 8, 'sat17-normalised-eps-f32' 9, 'sat17-normalised-eps-f64' 10, 'moller-f32' 11, 'moller-f64' 12, 'held-f32' 13, 'held-f64' 14, 'guigue-devillers-f32' 15, 'guigue-devillers-f64' 16, 'shen-f32' 17, 'shen-f64' 18, 'tropp-f32' 19, 'tropp-f64' 20, 'six-segment-f32' 21, 'six-segment-f64' 22, 'pqp-distance-f32' 23, 'pqp-distance-f64' 24, 'gjk-f32' 25, 'gjk-f64' 26, 'exact' 27) noenhanced
small = kind eq 'svg' ? '11' : '8'; mark = kind eq 'svg' ? 0.55 : 0.85
set lmargin at screen 0.2798; set rmargin at screen 0.8779
set bmargin at screen 0.0430; set tmargin at screen 0.8366
set label 'Pairs more than 1 µm apart that a test does not tell apart' at screen 0.5,0.9828 center font ',16'
set label 'called touching, or left undecided; disc: one of them more than 1 mm apart; blank: none' at screen 0.5,0.9613 center font ',' . small textcolor rgb ink
set label '109000 pairs: 1000 of each of 109 kinds, answers from exact arithmetic, seed 1' at screen 0.5,0.0155 center font ',' . small textcolor rgb ink
unset xtics
set ytics font ',' . small; set x2tics font ',' . small
set border 15 linecolor rgb pale
set xrange [-0.5:27.5]; set link x2
set yrange [70.5:-0.5]
set grid front noxtics noytics
faint = '#eeeeee'
do for [i=1:27] {
    set arrow from i-0.5,graph 0 to i-0.5,graph 1 nohead back linecolor rgb faint
}
do for [i=1:70] {
    set arrow from graph 0,first i-0.5 to graph 1,first i-0.5 nohead back linecolor rgb faint
}
set palette defined (0 '#fdeec4', 1 '#f5b041', 2 '#d1480b', 3 '#3a0a05')
set logscale cb
set colorbox user origin 0.8922,0.6389 size 0.0122,0.1892
set cbrange [0.1:100]
set cbtics ('≤ 0.1 %%' 0.1, '1 %%' 1, '10 %%' 10, '100 %%' 100) font ',' . small
set cblabel 'of the pairs more than 1 µm apart' font ',' . small
set style fill solid 1 noborder
unset key
plot $cells using 1:2:($1-0.46):($1+0.46):($2-0.46):($2+0.46):3 with boxxyerror \
       linecolor palette, \
     '' using 1:($4>1 ? $2 : NaN) with points pointtype 7 pointsize mark linecolor rgb 'white', \
     '' using 1:($4>1 ? $2 : NaN) with points pointtype 6 pointsize mark linewidth 1.5 \
       linecolor rgb blue, \
     '' using 1:($4>1000 ? $2 : NaN) with points pointtype 7 pointsize mark linecolor rgb blue
