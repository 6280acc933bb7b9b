# SPDX-License-Identifier: Apache-2.0
# gnuplot not-told-apart.gp draws not-told-apart.svg; gnuplot -e "kind='png'" not-told-apart.gp draws not-told-apart.png. gnuplot 5.4 or later.
if (!exists('kind')) kind = 'svg'
if (!exists('part')) part = ''
if (kind eq 'svg') set terminal svg size 878,929 font 'Arial,14' background 'white'
if (kind eq 'png') set terminal pngcairo size 878,929 font 'DejaVu Sans,10.5' background 'white'
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
12,0,12.5,0
16,1,0.5714,0
18,1,0.5714,0
10,2,3.704,0
12,2,1.14,0
16,2,0.2849,0
18,2,0.2849,0
20,2,0.2849,0
10,3,23.56,0
12,3,15.56,0
12,4,11.09,0
20,4,0.2132,0
20,5,1.075,0
21,6,0.5263,0
12,7,1.222,0
21,7,0.4566,0
4,8,0.978,0
6,8,0.978,0
10,8,1.711,0
16,8,1.956,0
18,8,0.2445,0
16,9,1.053,0
18,9,1.404,0
18,10,0.9772,0
21,10,0.6536,0
20,11,0.3367,0
16,12,4.95,0
10,13,20.23,0
12,13,12.94,0
18,13,34.47,0
4,14,4.319,0
10,14,1.661,0
14,14,7.973,0
16,14,14.95,0
20,15,0.7426,2500
20,16,0.3571,2344
21,16,0.722,4687
4,17,0.2004,0
6,17,0.2004,0
10,17,0.4008,0
12,17,0.8016,0
13,17,1.156,0
14,17,0.4008,0
15,17,0.289,0
16,17,2.405,3168
20,17,0.4008,0
21,17,0.289,0
12,18,0.2488,0
13,18,0.4975,0
4,19,0.4651,1267
10,19,0.2326,1267
14,19,0.2326,1690
15,19,0.361,0
16,19,0.4651,1690
20,19,0.4651,1250
20,20,1.119,2500
21,20,1.293,0
4,21,100,1e+04
5,21,100,1e+04
4,22,100,1.904e+04
5,22,100,1.72e+04
4,23,100,1.48e+04
5,23,100,1.38e+04
14,23,0.7937,1.23e+04
15,23,0.8043,4474
4,24,100,1e+04
5,24,100,1e+04
18,24,0.3145,0
4,25,100,1e+04
5,25,100,1e+04
4,26,100,1e+04
5,26,100,1e+04
18,26,0.4673,0
4,27,4.561,0
5,27,5.479,0
10,27,15.09,5000
14,27,3.158,1e+04
15,27,1.37,1250
16,27,6.316,1250
4,28,23.83,1e+04
5,28,27.03,1e+04
10,28,18.79,1e+04
14,28,7.718,2382
15,28,6.757,0
16,28,15.1,2382
18,28,0.3356,0
20,29,0.3953,0
21,30,0.8333,0
4,31,100,0
5,31,100,0
4,32,100,0
5,32,100,0
4,33,100,0
5,33,100,0
4,34,100,0
5,34,100,0
4,35,100,0
5,35,100,0
4,36,100,0
5,36,100,0
6,37,0.2907,2.566e+04
7,37,0.2907,2.566e+04
10,37,0.2907,2.566e+04
11,37,0.2907,2.566e+04
12,37,0.2907,2.566e+04
13,37,0.2907,2.566e+04
14,37,0.2907,2.566e+04
15,37,0.2907,2.566e+04
6,38,0.2845,0
7,38,0.2845,0
10,38,0.1422,0
11,38,0.1422,0
12,38,0.1422,0
13,38,0.2845,0
14,38,0.1422,0
15,38,0.1422,0
4,39,2.115,1.15e+04
5,39,2.115,1.15e+04
18,40,0.295,0
20,40,0.295,0
21,40,0.2933,0
18,41,1.143,0
19,41,1.983,0
20,41,0.2857,0
21,41,0.5666,0
12,42,4.306,0
0,43,12.76,0
2,43,0.4115,0
4,43,0.4115,0
6,43,0.4115,0
20,43,0.2058,0
0,44,24.67,0
2,44,8.66,0
4,44,8.66,0
6,44,8.824,2.116e+06
8,44,9.641,0
10,44,2.288,0
12,44,3.758,0
14,44,4.902,0
16,44,8.333,0
18,44,5.392,0
20,44,1.307,0
0,45,22.36,0
2,45,3.986,0
4,45,3.986,0
6,45,3.986,0
8,45,3.986,0
10,45,5.199,0
12,45,1.906,1373
14,45,10.4,0
16,45,13.69,3.516e+05
18,45,0.8666,0
20,45,0.8666,0
6,46,1.515,1223
7,46,1.987,0
10,46,1.515,1223
11,46,1.987,0
12,46,41.82,1e+04
13,46,39.07,1e+04
14,46,1.515,1223
15,46,1.987,0
12,47,44.11,1e+04
13,47,42.27,5000
4,48,4.03,5000
5,48,2.083,2500
12,48,3.023,0
13,48,4.688,0
14,48,3.526,5000
15,48,1.562,2500
18,48,0.2519,0
6,49,100,1e+04
7,49,100,1e+04
10,49,76.38,1e+04
11,49,74.47,1e+04
12,49,76.38,1e+04
13,49,74.47,1e+04
14,49,76.38,1e+04
15,49,74.47,1e+04
18,49,0.7538,0
20,49,0.7538,0
0,50,0.8811,0
2,50,100,1e+04
3,50,100,1e+04
4,50,100,1e+04
5,50,100,1e+04
6,50,100,1e+04
7,50,100,1e+04
8,50,100,1e+04
9,50,100,1e+04
14,50,63.44,1e+04
15,50,59.83,1e+04
2,51,100,1e+04
3,51,100,1e+04
4,51,100,1e+04
5,51,100,1e+04
6,51,100,1e+04
7,51,100,1e+04
8,51,100,1e+04
9,51,100,1e+04
14,51,100,1e+04
15,51,100,1e+04
12,52,34.38,4.791e+04
13,52,45.45,4.791e+04
END
set ytics scale 0 ('pierced by a needle' 0, 'vertex on sliver 1e4' 1, 'vertex on sliver 1e6' 2, 'vertex on face, 1e5 mm away' 3, 'small vertex on large face' 4, 'large vertex on small face' 5, 'edges of slivers 1e4' 6, 'edges of slivers 1e6' 7, 'needles along one another' 8, 'edges, angle 2^-12' 9, 'edges, 1e4 mm away' 10, 'edges, one way' 11, 'vertex on edge of sliver 1e5' 12, 'vertex on edge, 1e5 mm away' 13, 'tips of needles' 14, 'parallel faces' 15, 'parallel faces, 300 mm' 16, 'parallel slivers' 17, 'parallel faces, grid' 18, 'nearly parallel faces' 19, 'parallel faces, one way' 20, 'one plane, vertex at edge' 21, 'one plane, anywhere' 22, 'one plane, grid' 23, 'one plane, edges on one line' 24, 'one plane, edges, grid' 25, 'one plane, slivers' 26, 'one plane, turned and rounded' 27, 'one plane, rational turn' 28, 'only edges 0, 0' 29, 'only edges 0, 2' 30, 'only in-plane 0 of a' 31, 'only in-plane 1 of a' 32, 'only in-plane 2 of a' 33, 'only in-plane 0 of b' 34, 'only in-plane 1 of b' 35, 'only in-plane 2 of b' 36, 'lattice, integer turn' 37, 'lattice, rational turn' 38, 'sides of boxes, micrometre grid' 39, 'trunnion, vertex on face' 40, 'trunnion, edges' 41, 'subnormal against 1 mm' 42, 'large 1e4' 43, 'large 1e5' 44, 'large 1e5 against small' 45, 'segment on face' 46, 'point on face' 47, 'point on edge, grid' 48, 'segments' 49, 'segments in one plane, grid' 50, 'points' 51, 'pierced by a rounded line' 52) noenhanced
set x2tics scale 0 rotate by 60 left ('certified-f32' 0, 'certified-f32+f64' 1, 'sat17-f32' 2, 'sat17-f64' 3, 'sat11-f32' 4, 'sat11-f64' 5, 'paper-6-11-f32' 6, 'paper-6-11-f64' 7, 'sat17-normalised-eps-f32' 8, 'sat17-normalised-eps-f64' 9, 'moller-f32' 10, 'moller-f64' 11, 'held-f32' 12, 'held-f64' 13, 'guigue-devillers-f32' 14, 'guigue-devillers-f64' 15, 'six-segment-f32' 16, 'six-segment-f64' 17, 'pqp-distance-f32' 18, 'pqp-distance-f64' 19, 'gjk-f32' 20, 'gjk-f64' 21, 'exact' 22) noenhanced
small = kind eq 'svg' ? '11' : '8'; mark = kind eq 'svg' ? 0.55 : 0.85
set lmargin at screen 0.3132; set rmargin at screen 0.8633
set bmargin at screen 0.0538; set tmargin at screen 0.7955
set label 'Pairs more than 1 µm apart that a test does not tell apart' at screen 0.5,0.9785 center font ',16'
set label 'called touching, or left undecided; disc: one of them more than 1 mm apart; blank: none' at screen 0.5,0.9516 center font ',' . small textcolor rgb ink
set label '109000 pairs: 1000 of each of 109 kinds, answers from exact arithmetic, seed 1' at screen 0.5,0.0194 center font ',' . small textcolor rgb ink
unset xtics
set ytics font ',' . small; set x2tics font ',' . small
set border 15 linecolor rgb pale
set xrange [-0.5:22.5]; set link x2
set yrange [52.5:-0.5]
set grid front noxtics noytics
faint = '#eeeeee'
do for [i=1:22] {
    set arrow from i-0.5,graph 0 to i-0.5,graph 1 nohead back linecolor rgb faint
}
do for [i=1:52] {
    set arrow from graph 0,first i-0.5 to graph 1,first i-0.5 nohead back linecolor rgb faint
}
set palette defined (0 '#fdeec4', 1 '#f5b041', 2 '#d1480b', 3 '#3a0a05')
set logscale cb
set colorbox user origin 0.8793,0.5479 size 0.0137,0.2368
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
