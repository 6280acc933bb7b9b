# SPDX-License-Identifier: Apache-2.0
# gnuplot not-told-apart.gp draws not-told-apart.svg; gnuplot -e "kind='png'" not-told-apart.gp draws not-told-apart.png. gnuplot 5.4 or later.
if (!exists('kind')) kind = 'svg'
if (!exists('part')) part = ''
if (kind eq 'svg') set terminal svg size 878,981 font 'Arial,14' background 'white'
if (kind eq 'png') set terminal pngcairo size 878,981 font 'DejaVu Sans,10.5' background 'white'
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
20,6,0.6944,0
20,7,0.2469,0
12,8,1.222,0
20,8,0.2445,0
4,9,0.978,0
6,9,0.978,0
10,9,1.711,0
16,9,1.956,0
18,9,0.2445,0
16,10,1.053,0
18,10,1.404,0
18,11,0.6557,0
20,12,0.3378,0
16,13,1.65,0
10,14,20.46,0
12,14,12.21,0
18,14,34.82,0
4,15,4.319,0
10,15,1.661,0
14,15,7.973,0
16,15,14.95,0
20,16,0.7426,2500
20,17,0.3571,2344
21,17,0.722,4687
4,18,0.2004,0
6,18,0.2004,0
10,18,0.4008,0
12,18,0.8016,0
13,18,1.156,0
14,18,0.4008,0
15,18,0.289,0
16,18,2.405,3168
20,18,0.4008,0
21,18,0.289,0
12,19,0.2488,0
13,19,0.4975,0
6,20,0.2342,0
11,20,0.369,0
14,20,0.4684,1690
16,20,0.4684,0
20,20,0.7026,1032
21,20,0.369,0
20,21,1.119,2500
21,21,1.293,0
4,22,100,1e+04
5,22,100,1e+04
4,23,100,1.904e+04
5,23,100,1.72e+04
4,24,100,1.48e+04
5,24,100,1.38e+04
14,24,0.7937,1.23e+04
15,24,0.8043,4474
4,25,100,1e+04
5,25,100,1e+04
18,25,0.3145,0
4,26,100,1e+04
5,26,100,1e+04
4,27,100,1e+04
5,27,100,1e+04
18,27,0.4673,0
4,28,4.561,0
5,28,5.479,0
10,28,15.09,5000
14,28,3.158,1e+04
15,28,1.37,1250
16,28,6.316,1250
4,29,23.83,1e+04
5,29,27.03,1e+04
10,29,18.79,1e+04
14,29,7.718,2382
15,29,6.757,0
16,29,15.1,2382
18,29,0.3356,0
21,30,0.8333,0
21,31,0.9615,0
20,32,0.3846,0
20,33,1.205,0
21,34,0.8772,0
4,35,100,0
5,35,100,0
4,36,100,0
5,36,100,0
4,37,100,0
5,37,100,0
4,38,100,0
5,38,100,0
4,39,100,0
5,39,100,0
4,40,100,0
5,40,100,0
6,41,0.2907,2.566e+04
7,41,0.2907,2.566e+04
10,41,0.2907,2.566e+04
11,41,0.2907,2.566e+04
12,41,0.2907,2.566e+04
13,41,0.2907,2.566e+04
14,41,0.2907,2.566e+04
15,41,0.2907,2.566e+04
6,42,0.2845,0
7,42,0.2845,0
10,42,0.1422,0
11,42,0.1422,0
12,42,0.1422,0
13,42,0.2845,0
14,42,0.1422,0
15,42,0.1422,0
4,43,2.115,1.15e+04
5,43,2.115,1.15e+04
18,44,0.295,0
20,44,0.295,0
21,44,0.2933,0
18,45,1.416,0
19,45,2.557,0
20,45,0.8499,0
21,45,1.136,0
12,46,4.306,0
0,47,12.76,0
8,47,0.2058,0
16,47,0.2058,0
18,47,0.4115,0
20,47,0.6173,0
0,48,24.67,0
2,48,8.66,0
4,48,8.66,0
6,48,8.824,2.116e+06
8,48,9.641,0
10,48,2.288,0
12,48,3.758,0
14,48,4.902,0
16,48,8.333,0
18,48,5.392,0
20,48,1.307,0
0,49,23.06,0
2,49,4.647,0
4,49,4.819,0
6,49,4.819,0
8,49,3.787,0
10,49,4.475,0
12,49,1.033,2746
14,49,11.88,0
16,49,17.9,2.813e+06
18,49,2.41,0
20,49,0.3442,0
6,50,1.515,1223
7,50,1.987,0
10,50,1.515,1223
11,50,1.987,0
12,50,41.82,1e+04
13,50,39.07,1e+04
14,50,1.515,1223
15,50,1.987,0
12,51,44.11,1e+04
13,51,42.27,5000
4,52,4.03,5000
5,52,2.083,2500
12,52,3.023,0
13,52,4.688,0
14,52,3.526,5000
15,52,1.562,2500
18,52,0.2519,0
6,53,100,1e+04
7,53,100,1e+04
10,53,76.13,1e+04
11,53,73.4,1e+04
12,53,76.13,1e+04
13,53,73.4,1e+04
14,53,76.13,1e+04
15,53,73.4,1e+04
18,53,2.01,0
0,54,0.8811,0
2,54,100,1e+04
3,54,100,1e+04
4,54,100,1e+04
5,54,100,1e+04
6,54,100,1e+04
7,54,100,1e+04
8,54,100,1e+04
9,54,100,1e+04
14,54,63.44,1e+04
15,54,59.83,1e+04
2,55,100,1e+04
3,55,100,1e+04
4,55,100,1e+04
5,55,100,1e+04
6,55,100,1e+04
7,55,100,1e+04
8,55,100,1e+04
9,55,100,1e+04
14,55,100,1e+04
15,55,100,1e+04
12,56,34.38,4.791e+04
13,56,45.45,4.791e+04
END
set ytics scale 0 ('pierced by a needle' 0, 'vertex on sliver 1e4' 1, 'vertex on sliver 1e6' 2, 'vertex on face, 1e5 mm away' 3, 'small vertex on large face' 4, 'large vertex on small face' 5, 'edges' 6, 'edges of slivers 1e4' 7, 'edges of slivers 1e6' 8, 'needles along one another' 9, 'edges, angle 2^-12' 10, 'edges, 1e4 mm away' 11, 'edges, one way' 12, 'vertex on edge of sliver 1e5' 13, 'vertex on edge, 1e5 mm away' 14, 'tips of needles' 15, 'parallel faces' 16, 'parallel faces, 300 mm' 17, 'parallel slivers' 18, 'parallel faces, grid' 19, 'nearly parallel faces' 20, 'parallel faces, one way' 21, 'one plane, vertex at edge' 22, 'one plane, anywhere' 23, 'one plane, grid' 24, 'one plane, edges on one line' 25, 'one plane, edges, grid' 26, 'one plane, slivers' 27, 'one plane, turned and rounded' 28, 'one plane, rational turn' 29, 'only edges 0, 2' 30, 'only edges 1, 0' 31, 'only edges 1, 1' 32, 'only edges 1, 2' 33, 'only edges 2, 0' 34, 'only in-plane 0 of a' 35, 'only in-plane 1 of a' 36, 'only in-plane 2 of a' 37, 'only in-plane 0 of b' 38, 'only in-plane 1 of b' 39, 'only in-plane 2 of b' 40, 'lattice, integer turn' 41, 'lattice, rational turn' 42, 'sides of boxes, micrometre grid' 43, 'trunnion, vertex on face' 44, 'trunnion, edges' 45, 'subnormal against 1 mm' 46, 'large 1e4' 47, 'large 1e5' 48, 'large 1e5 against small' 49, 'segment on face' 50, 'point on face' 51, 'point on edge, grid' 52, 'segments' 53, 'segments in one plane, grid' 54, 'points' 55, 'pierced by a rounded line' 56) noenhanced
set x2tics scale 0 rotate by 60 left ('certified-f32' 0, 'certified-f32+f64' 1, 'sat17-f32' 2, 'sat17-f64' 3, 'sat11-f32' 4, 'sat11-f64' 5, 'paper-6-11-f32' 6, 'paper-6-11-f64' 7, 'sat17-normalised-eps-f32' 8, 'sat17-normalised-eps-f64' 9, 'moller-f32' 10, 'moller-f64' 11, 'held-f32' 12, 'held-f64' 13, 'guigue-devillers-f32' 14, 'guigue-devillers-f64' 15, 'six-segment-f32' 16, 'six-segment-f64' 17, 'pqp-distance-f32' 18, 'pqp-distance-f64' 19, 'gjk-f32' 20, 'gjk-f64' 21, 'exact' 22) noenhanced
small = kind eq 'svg' ? '11' : '8'; mark = kind eq 'svg' ? 0.55 : 0.85
set lmargin at screen 0.3132; set rmargin at screen 0.8633
set bmargin at screen 0.0510; set tmargin at screen 0.8063
set label 'Pairs more than 1 µm apart that a test does not tell apart' at screen 0.5,0.9796 center font ',16'
set label 'called touching, or left undecided; disc: one of them more than 1 mm apart; blank: none' at screen 0.5,0.9541 center font ',' . small textcolor rgb ink
set label '109000 pairs: 1000 of each of 109 kinds, answers from exact arithmetic, seed 1' at screen 0.5,0.0183 center font ',' . small textcolor rgb ink
unset xtics
set ytics font ',' . small; set x2tics font ',' . small
set border 15 linecolor rgb pale
set xrange [-0.5:22.5]; set link x2
set yrange [56.5:-0.5]
set grid front noxtics noytics
faint = '#eeeeee'
do for [i=1:22] {
    set arrow from i-0.5,graph 0 to i-0.5,graph 1 nohead back linecolor rgb faint
}
do for [i=1:56] {
    set arrow from graph 0,first i-0.5 to graph 1,first i-0.5 nohead back linecolor rgb faint
}
set palette defined (0 '#fdeec4', 1 '#f5b041', 2 '#d1480b', 3 '#3a0a05')
set logscale cb
set colorbox user origin 0.8793,0.5719 size 0.0137,0.2243
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
