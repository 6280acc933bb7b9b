# SPDX-License-Identifier: Apache-2.0
# gnuplot simplified-sides.gp draws simplified-sides.svg; gnuplot -e "kind='png'" simplified-sides.gp draws simplified-sides.png. gnuplot 5.4 or later.
if (!exists('kind')) kind = 'svg'
if (!exists('part')) part = ''
if (kind eq 'svg') set terminal svg size 1000,720 font 'Arial,13' background 'white'
if (kind eq 'png') set terminal pngcairo size 1000,720 font 'DejaVu Sans,9.5' background 'white'
set output 'simplified-sides.' . kind . part
set encoding utf8
set datafile separator ','
# Okabe and Ito's colours, which people who see few colours tell apart; in grey they differ too.
ink = '#202020'; grey = '#8a8a8a'; pale = '#dddddd'
blue = '#0b5394'; red = '#d55e00'
file = 'simplified-sides.csv'
set border 11 linecolor rgb grey
set tics nomirror textcolor rgb ink
set grid linecolor rgb pale linetype 1 linewidth 0.7
set logscale xy
set xrange [0.045:0.45]
set yrange [0.01:0.5]
set y2range [0:100]
set xtics (0.05, 0.1, 0.2, 0.4)
set ytics (0.01, 0.02, 0.05, 0.1, 0.2, 0.4)
set y2tics 25 nomirror textcolor rgb grey
unset key
set label 1 'simplify_mm' at screen 0.5,0.065 center noenhanced
set label 2 'mm' at screen 0.012,0.5 rotate by 90 center
set label 3 '% of the triangles' at screen 0.99,0.5 rotate by 90 center textcolor rgb grey
set label 4 '1,000,000 points a side, and all corners; what was sampled below 0.01 mm is not drawn' at screen 0.5,0.022 center font ',11' noenhanced textcolor rgb ink
set label 5 '● deviation, proven: how far the whole leaves the simplified' at screen 0.045,0.925 textcolor rgb blue
set label 6 '■ excess, proven: how far this sticks out' at screen 0.49,0.925 textcolor rgb red
set label 7 '×  +  sampled' at screen 0.795,0.925 textcolor rgb ink
set label 8 '▮ triangles left' at screen 0.905,0.925 textcolor rgb grey
set multiplot layout 2,3 title 'How far a simplified surface is from the whole one: both sides, proven and sampled' font ',15' margins 0.065,0.94,0.14,0.86 spacing 0.075,0.1
do for [name in "ball ring table a_axis c_axis headstock"] {
    set title name noenhanced font ',13' offset 0,-0.6
    plot file skip 1 using (strcol(1) eq name ? $2 : NaN):(100.0 * $4 / $3) axes x1y2 with impulses linewidth 6 linecolor rgb pale, \
         file skip 1 using (strcol(1) eq name && $5 > 0 ? $2 : NaN):5 with linespoints linewidth 2 pointtype 7 linecolor rgb blue, \
         file skip 1 using (strcol(1) eq name && $5 > 0 ? $2 : NaN):6 with points linewidth 1.5 pointtype 2 linecolor rgb ink, \
         file skip 1 using (strcol(1) eq name && $5 > 0 ? $2 : NaN):7 with linespoints linewidth 2 dashtype 2 pointtype 5 linecolor rgb red, \
         file skip 1 using (strcol(1) eq name && $5 > 0 ? $2 : NaN):8 with points linewidth 1.5 pointtype 1 linecolor rgb ink
    unset label
}
unset multiplot
