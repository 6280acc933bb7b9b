# SPDX-License-Identifier: Apache-2.0
# gnuplot speed-accuracy.gp draws speed-accuracy.svg; gnuplot -e "kind='png'" speed-accuracy.gp draws speed-accuracy.png. gnuplot 5.4 or later.
if (!exists('kind')) kind = 'svg'
if (!exists('part')) part = ''
if (kind eq 'svg') set terminal svg size 1000,680 font 'Arial,14' background 'white'
if (kind eq 'png') set terminal pngcairo size 1000,680 font 'DejaVu Sans,10.5' background 'white'
set output 'speed-accuracy.' . kind . part
set encoding utf8
set datafile separator ','
# Okabe and Ito's colours, which people who see few colours tell apart; in grey they differ too.
ink = '#202020'; grey = '#8a8a8a'; pale = '#dddddd'
blue = '#0b5394'; red = '#d55e00'; green = '#009e73'; gold = '#e69f00'; sky = '#56b4e9'
set border 3 linecolor rgb grey
set tics nomirror textcolor rgb ink
set grid linecolor rgb pale linetype 1 linewidth 0.7

small = kind eq 'svg' ? '12.5' : '9'
set lmargin at screen 0.11; set rmargin at screen 0.975
set bmargin at screen 0.185; set tmargin at screen 0.885
mark = kind eq 'svg' ? 0.75 : 1.2
set label "What a test of two triangles costs, and what it cannot tell" at screen 0.5,0.965 \
    center font ',17'
unset key
set label "  proven: no contact is ever missed" at screen 0.13,0.915 left \
    point pointtype 5 pointsize mark linecolor rgb blue
set label "  not proven, none missed here" at screen 0.45,0.915 left \
    point pointtype 7 pointsize mark linecolor rgb grey
set label "  misses contacts" at screen 0.74,0.915 left \
    point pointtype 6 pointsize mark linewidth 2 linecolor rgb red
set logscale xy
set xrange [4.60955:1344.61]
set yrange [1.66667e-10:357771]
set xlabel "mean time of a pair (all on the same pairs; touching or apart, whichever is slower)"
set ylabel "deepest contact missed, or where proven: widest gap undecided"
set ytics ('≤ 1 fm' 1e-9, '1 pm' 1e-6, '1 nm' 1e-3, '1 µm' 1, '1 mm' 1e3, '1 m' 1e6)
set xtics ('1 ns' 1, '10 ns' 10, '100 ns' 100, '1 µs' 1e3, '10 µs' 1e4, '100 µs' 1e5, '1 ms' 1e6, \
           '10 ms' 1e7)
set mxtics 10
set label '94068 pairs within 4 m and longer than 1 µm, of 1000 of each of 109 kinds; exact answers, seed 1' at screen 0.5,0.048 center font ',' . small textcolor rgb ink noenhanced
set label 'one core of an AMD EPYC, avx512 with 16 lanes, least of 9 passes; the certified ones in lanes, the others one pair at a time' at screen 0.5,0.02 center font ',' . small textcolor rgb ink noenhanced
set label 'certified-shared-f32' at screen 0.1933,0.8236 left front font ',' . small textcolor rgb blue
set label 'certified-f32' at screen 0.3412,0.6259 left front font ',' . small textcolor rgb blue
set label 'certified-f32+f64' at screen 0.6376,0.4387 left front font ',' . small textcolor rgb blue
set label 'sat17-f32: 600 missed' at screen 0.6210,0.5480 left front font ',' . small textcolor rgb red
set label 'sat17-f64: 317 missed' at screen 0.5643,0.2992 left front font ',' . small textcolor rgb red
set arrow from screen 0.6325,0.2205 to screen 0.6325,0.2904 nohead back linecolor rgb grey linewidth 0.6
set label 'sat11-f32: 570 missed' at screen 0.5606,0.5252 left front font ',' . small textcolor rgb red
set label 'sat11-f64: 300 missed' at screen 0.5935,0.2749 left front font ',' . small textcolor rgb red
set arrow from screen 0.5745,0.2205 to screen 0.5915,0.2660 nohead back linecolor rgb grey linewidth 0.6
set label 'paper-6-11-f32: 432 missed' at screen 0.3442,0.5297 left front font ',' . small textcolor rgb red
set label 'paper-6-11-f64: 218 missed' at screen 0.4491,0.2458 left front font ',' . small textcolor rgb red
set label 'sat17-normalised-eps-f32: 27218 false hits' at screen 0.3938,0.1991 left front font ',' . small textcolor rgb grey
set label 'sat17-normalised-eps-f64: 40610 false hits' at screen 0.3991,0.3347 left front font ',' . small textcolor rgb grey
set arrow from screen 0.7146,0.2205 to screen 0.6741,0.3259 nohead back linecolor rgb grey linewidth 0.6
set label 'moller-f32: 5957 missed' at screen 0.5238,0.8185 left front font ',' . small textcolor rgb red
set label 'moller-f64: 1475 missed' at screen 0.5656,0.6408 left front font ',' . small textcolor rgb red
set label 'held-f32: 4716 missed' at screen 0.3824,0.8223 left front font ',' . small textcolor rgb red
set label 'held-f64: 1675 missed' at screen 0.5349,0.6645 left front font ',' . small textcolor rgb red
set label 'guigue-devillers-f32: 3869 missed' at screen 0.3510,0.7430 left front font ',' . small textcolor rgb red
set arrow from screen 0.4583,0.8438 to screen 0.4583,0.7519 nohead back linecolor rgb grey linewidth 0.6
set label 'guigue-devillers-f64: 3097 missed' at screen 0.4841,0.7742 left front font ',' . small textcolor rgb red
set arrow from screen 0.4591,0.8438 to screen 0.4821,0.7830 nohead back linecolor rgb grey linewidth 0.6
set label 'shen-f32: 5127 missed' at screen 0.3773,0.7986 left front font ',' . small textcolor rgb red
set arrow from screen 0.4881,0.8438 to screen 0.4881,0.8075 nohead back linecolor rgb grey linewidth 0.6
set label 'shen-f64: 4287 missed' at screen 0.3236,0.7742 left front font ',' . small textcolor rgb red
set arrow from screen 0.4851,0.8438 to screen 0.4621,0.7830 nohead back linecolor rgb grey linewidth 0.6
set label 'tropp-f32: 4463 missed' at screen 0.3754,0.8675 left front font ',' . small textcolor rgb red
set label 'tropp-f64: 3601 missed' at screen 0.5353,0.8652 left front font ',' . small textcolor rgb red
set label 'six-segment-f32: 7024 missed' at screen 0.5757,0.6979 left front font ',' . small textcolor rgb red
set label 'six-segment-f64: 11082 missed' at screen 0.5641,0.5762 left front font ',' . small textcolor rgb red
set label 'pqp-distance-f32: 223 missed' at screen 0.7144,0.8438 left front font ',' . small textcolor rgb red
set label 'pqp-distance-f64: 45 missed' at screen 0.7181,0.6671 left front font ',' . small textcolor rgb red
set label 'gjk-f32: 901 missed' at screen 0.6756,0.7334 left front font ',' . small textcolor rgb red
set label 'gjk-f64: 44362 false hits' at screen 0.6389,0.2458 left front font ',' . small textcolor rgb grey
set label 'exact' at screen 0.8974,0.2205 left front font ',' . small textcolor rgb blue
floor = 1e-09
blind(certified, missed, undecided) = (d = certified == 1 ? undecided : missed, \
    d < floor ? floor : d)
file = 'speed-accuracy.csv'
plot file skip 1 using ($2==1 && $3==0 ? $4 : NaN):(blind($2,$10,$16)) with linespoints \
       linetype 1 linewidth 1.5 pointtype 5 pointsize mark linecolor rgb blue, \
     '' skip 1 using ($2==0 && $3==0 && $9==0 ? $4 : NaN):(blind($2,$10,$16)) with points \
       pointtype 7 pointsize mark linecolor rgb grey, \
     '' skip 1 using ($2==0 && $3==0 && $9>0 ? $4 : NaN):(blind($2,$10,$16)) with points \
       pointtype 6 pointsize mark linewidth 2 \
       linecolor rgb red
