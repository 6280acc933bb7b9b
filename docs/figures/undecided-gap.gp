# SPDX-License-Identifier: Apache-2.0
# gnuplot undecided-gap.gp draws undecided-gap.svg; gnuplot -e "kind='png'" undecided-gap.gp draws undecided-gap.png. gnuplot 5.4 or later.
if (!exists('kind')) kind = 'svg'
if (!exists('part')) part = ''
if (kind eq 'svg') set terminal svg size 1000,600 font 'Arial,14' background 'white'
if (kind eq 'png') set terminal pngcairo size 1000,600 font 'DejaVu Sans,10.5' background 'white'
set output 'undecided-gap.' . kind . part
set encoding utf8
set datafile separator ','
# Okabe and Ito's colours, which people who see few colours tell apart; in grey they differ too.
ink = '#202020'; grey = '#8a8a8a'; pale = '#dddddd'
blue = '#0b5394'; red = '#d55e00'; green = '#009e73'; gold = '#e69f00'; sky = '#56b4e9'
set border 3 linecolor rgb grey
set tics nomirror textcolor rgb ink
set grid linecolor rgb pale linetype 1 linewidth 0.7
set title "How wide a gap must be for the certified test to see it" font ',17'
set bmargin 6.5
tiny = kind eq 'svg' ? '12' : '9'
set logscale x
set xrange [0.001:1000]
set yrange [0:105]
set xtics ('1 nm' 1e-3, '10 nm' 1e-2, '0.1 µm' 0.1, '1 µm' 1, '10 µm' 10, '0.1 mm' 100, '1 mm' 1000)
set xlabel "true gap between two triangles of 100 mm"
set ylabel "left undecided, % of the pairs"
set key top right reverse Left samplen 3 noenhanced spacing 1.15
set label '95295 pairs a line: vertex, edge and face against one another, turned at random, rounded to float; true gap from exact arithmetic' at screen 0.5,0.04 center font ',' . tiny textcolor rgb ink
plot 'undecided-gap.csv' every ::1::24 using (sqrt($3*$4)):7 with linespoints linewidth 3.2 dashtype 1 linecolor rgb ink pointtype 7 pointsize 1.1 title 'certified-f32, slivers 1:1', \
     'undecided-gap.csv' every ::25::48 using (sqrt($3*$4)):7 with linespoints linewidth 2.3000000000000003 dashtype 1 linecolor rgb red pointtype 5 pointsize 0.8500000000000001 title 'certified-f32, slivers 1:100', \
     'undecided-gap.csv' every ::49::72 using (sqrt($3*$4)):7 with linespoints linewidth 1.4000000000000001 dashtype 1 linecolor rgb sky pointtype 9 pointsize 0.6000000000000001 title 'certified-f32, slivers 1:10000', \
     'undecided-gap.csv' every ::73::96 using (sqrt($3*$4)):7 with linespoints linewidth 3.2 dashtype 2 linecolor rgb ink pointtype 7 pointsize 1.1 title 'certified-f32+f64, slivers 1:1', \
     'undecided-gap.csv' every ::97::120 using (sqrt($3*$4)):7 with linespoints linewidth 2.3000000000000003 dashtype 2 linecolor rgb red pointtype 5 pointsize 0.8500000000000001 title 'certified-f32+f64, slivers 1:100', \
     'undecided-gap.csv' every ::121::144 using (sqrt($3*$4)):7 with linespoints linewidth 1.4000000000000001 dashtype 2 linecolor rgb sky pointtype 9 pointsize 0.6000000000000001 title 'certified-f32+f64, slivers 1:10000', \
     'undecided-gap.csv' every ::145::168 using (sqrt($3*$4)):7 with linespoints linewidth 3.2 dashtype 3 linecolor rgb ink pointtype 7 pointsize 1.1 title 'certified-shared-f32, slivers 1:1', \
     'undecided-gap.csv' every ::169::192 using (sqrt($3*$4)):7 with linespoints linewidth 2.3000000000000003 dashtype 3 linecolor rgb red pointtype 5 pointsize 0.8500000000000001 title 'certified-shared-f32, slivers 1:100', \
     'undecided-gap.csv' every ::193::216 using (sqrt($3*$4)):7 with linespoints linewidth 1.4000000000000001 dashtype 3 linecolor rgb sky pointtype 9 pointsize 0.6000000000000001 title 'certified-shared-f32, slivers 1:10000'
