// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/page/run_page.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <memory>
#include <optional>

#include "firmware_if/cli/whole_file.hpp"
#include "hil_replay/page/page_parts.hpp"

namespace axg {
namespace {

constexpr std::array kLibraries = {
    "three/three.min.js", "three/examples/js/controls/OrbitControls.js", "dygraphs/dygraph.min.js"};
constexpr const char* kLibraryStyle = "dygraphs/dygraph.min.css";
constexpr const char* kInstall =
    "--report needs three.js and dygraphs. Install them (Debian: libjs-three, libjs-dygraphs).";
constexpr std::array kScriptsOfPage = {"closest.js", "machine_view.js", "plots.js",
                                       "why.js",     "program.js",      "page.js"};

/// Appends a text in <script>; escapes each "</script" in it.
void append_script(std::string& page, const std::string& text) {
    std::string body = text;
    for (std::size_t at = 0; (at = body.find("</script", at)) != std::string::npos; at += 9) {
        body.replace(at, 2, "<\\/");
    }
    page += "<script>\n" + body + "\n</script>\n";
}

}  // namespace

std::string printed_text(const std::function<void(std::FILE*)>& print) {
    char* text = nullptr;
    std::size_t size = 0;
    std::FILE* stream = open_memstream(&text, &size);
    if (stream == nullptr) {
        return {};
    }
    print(stream);
    std::fclose(stream);
    const std::unique_ptr<char, decltype(&std::free)> owned(text, &std::free);
    return {text, size};
}

bool write_run_page(const std::string& path, const RunPage& page, std::FILE* messages) {
    const auto own = [messages](const char* name) { return own_part(name, messages); };
    const auto library = [messages](const char* name) {
        return library_part(name, kInstall, messages);
    };
    const std::optional<std::string> head = own("page.html"), style = own("page.css"),
                                     library_style = library(kLibraryStyle);
    if (!head || !style || !library_style) {
        return false;
    }
    std::string text = *head + "<style>\n" + *library_style + *style + "</style>\n";
    text += "<script type=\"application/json\" id=\"data\">" + page_data(page) + "</script>\n";
    for (const char* name : kLibraries) {
        const std::optional<std::string> script = library(name);
        if (!script) {
            return false;
        }
        append_script(text, *script);
    }
    for (const char* name : kScriptsOfPage) {
        const std::optional<std::string> script = own(name);
        if (!script) {
            return false;
        }
        append_script(text, *script);
    }
    text += "</body>\n</html>\n";
    return write_whole_file(path, text, messages);
}

}  // namespace axg
