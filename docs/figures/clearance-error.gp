# SPDX-License-Identifier: Apache-2.0
# gnuplot clearance-error.gp draws clearance-error.svg; gnuplot -e "kind='png'" clearance-error.gp draws clearance-error.png. gnuplot 5.4 or later.
if (!exists('kind')) kind = 'svg'
if (!exists('part')) part = ''
if (kind eq 'svg') set terminal svg size 1000,620 font 'Arial,14' background 'white'
if (kind eq 'png') set terminal pngcairo size 1000,620 font 'DejaVu Sans,10.5' background 'white'
set output 'clearance-error.' . kind . part
set encoding utf8
set datafile separator ','
# Okabe and Ito's colours, which people who see few colours tell apart; in grey they differ too.
ink = '#202020'; grey = '#8a8a8a'; pale = '#dddddd'
blue = '#0b5394'; red = '#d55e00'; green = '#009e73'; gold = '#e69f00'; sky = '#56b4e9'
set border 3 linecolor rgb grey
set tics nomirror textcolor rgb ink
set grid linecolor rgb pale linetype 1 linewidth 0.7
set title "Reported clearance less the true distance" font ',17'
small = kind eq 'svg' ? 0.45 : 0.7
set bmargin 6.5
tiny = kind eq 'svg' ? '12' : '9'
# Both signs on a logarithmic scale: decades of um above and below 1e-10, which is drawn as zero.
folded(um) = abs(um) <= 1e-10 ? 0 : sgn(um) * (log10(abs(um)) + 10)
set logscale x
set xrange [1e-6:1000]
set yrange [-15:15]
set xtics ('1 nm' 1e-6, '10 nm' 1e-5, '0.1 µm' 1e-4, '1 µm' 1e-3, '10 µm' 1e-2, '0.1 mm' 0.1, \
           '1 mm' 1, '10 mm' 10, '0.1 m' 100, '1 m' 1000)
set ytics ('+1 mm' 13, '+1 µm' 10, '+1 nm' 7, '+1 pm' 4, '0' 0, \
           '-1 pm' -4, '-1 nm' -7, '-1 µm' -10, '-1 mm' -13)
set xlabel "true distance of the two bodies"
set ylabel "error"
set object 1 rectangle from graph 0,first 0 to graph 1,graph 1 behind \
    fillcolor rgb '#fbe9e0' fillstyle solid noborder
set label "claims more than there is" at graph 0.01,0.965 textcolor rgb red
set label "claims less: safe" at graph 0.01,0.035 textcolor rgb blue
set key top right reverse Left samplen 1 noenhanced
set label '1019 pairs of the machine paper-trunnion near contact; 240 poses of the meshes of the folder tritri; distances from exact arithmetic' at screen 0.5,0.04 center font ',' . tiny textcolor rgb ink
file = 'clearance-error.csv'
plot 0 linecolor rgb ink linewidth 1.5 notitle, \
     file skip 1 using (strcol(1) eq 'axguard engine' ? $3 : NaN):(folded($4)) with points pointtype 7 pointsize small linecolor rgb blue title 'axguard engine: 0 of 1177 above', \
     file skip 1 using (strcol(1) eq 'certified-f32' ? $3 : NaN):(folded($4)) with points pointtype 5 pointsize small linecolor rgb sky title 'certified-f32: 0 of 158 above', \
     file skip 1 using (strcol(1) eq 'pqp-distance-f32' ? $3 : NaN):(folded($4)) with points pointtype 6 pointsize small linecolor rgb red title 'pqp-distance-f32: 61 of 158 above', \
     file skip 1 using (strcol(1) eq 'gjk-f32' ? $3 : NaN):(folded($4)) with points pointtype 2 pointsize small linecolor rgb gold title 'gjk-f32: 50 of 158 above'
