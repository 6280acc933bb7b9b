// SPDX-License-Identifier: Apache-2.0
// Draws a script with gnuplot as a child process. Everything on a picture stands in its script and
// tables, so that a user draws it again, or otherwise, without this program.
#pragma once

#include <string>

namespace axg::chart {

/// Of a picture, in pixels; the PNG has so many times as many.
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

/// Runs gnuplot on NAME.gp in `folder`, once for each kind of picture. A picture takes its name
/// when it is complete. What gnuplot complains of goes to stderr.
[[nodiscard]] Drawn draw(const std::string& folder, const std::string& name);

inline constexpr const char* kNoGnuplot =
    "gnuplot is not installed, so the tables and scripts are written and the pictures are not; "
    "install it (Debian: apt-get install gnuplot-nox) and run this again, or gnuplot on a "
    "script";

}  // namespace axg::chart
