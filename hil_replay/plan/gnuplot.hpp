// SPDX-License-Identifier: Apache-2.0
// Draws a script with gnuplot as a child process. The script and its tables contain the whole
// figure, so that a user can draw it again, or differently, without this program.
#pragma once

#include <string>

namespace axg::chart {

/// Size of a figure in pixels; a PNG has `png_scale` times as many in each direction.
struct PictureSize {
    unsigned width = 1000, height = 640;
    unsigned png_scale = 1;
};

/// A whole script: terminals, names and the colours of the house, then `body`, which plots once.
/// It draws NAME.svg, or with kind='png' on gnuplot's command line NAME.png.
[[nodiscard]] std::string gnuplot_script(const std::string& name, PictureSize size,
                                         const std::string& body);

/// `text` between single quotes, as gnuplot reads a string that it must not interpret.
[[nodiscard]] std::string quoted_for_gnuplot(const std::string& text);

enum class Drawn { yes, no_gnuplot, failed };

/// Runs gnuplot on NAME.gp in `folder`, once for each file format. A file gets its name only when
/// it is complete. Messages of gnuplot go to stderr.
[[nodiscard]] Drawn draw(const std::string& folder, const std::string& name);

inline constexpr const char* kNoGnuplot =
    "gnuplot is not installed, so the tables and scripts are written and the pictures are not; "
    "install it (Debian: apt-get install gnuplot-nox) and run this again, or gnuplot on a "
    "script";

}  // namespace axg::chart
