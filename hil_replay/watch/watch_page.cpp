// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/watch/watch_page.hpp"

#include <array>

#include "hil_replay/page/page_parts.hpp"

namespace axg {
namespace {

struct NamedPart {
    const char* path;  // that a browser requests
    const char* file;
    const char* type;
};
constexpr const char* kScript = "text/javascript; charset=utf-8";
constexpr std::array kOwnParts = {NamedPart{"/", "live.html", "text/html; charset=utf-8"},
                                  NamedPart{"/live.css", "live.css", "text/css; charset=utf-8"},
                                  NamedPart{"/closest.js", "closest.js", kScript},
                                  NamedPart{"/machine_view.js", "machine_view.js", kScript},
                                  NamedPart{"/why.js", "why.js", kScript},
                                  NamedPart{"/live.js", "live.js", kScript}};
constexpr std::array kLibraries = {
    NamedPart{"/three.js", "three/three.min.js", kScript},
    NamedPart{"/OrbitControls.js", "three/examples/js/controls/OrbitControls.js", kScript}};
constexpr const char* kInstall = "axguard watch needs three.js. Install it (Debian: libjs-three).";

}  // namespace

std::optional<HttpParts> watch_parts(const LoadedMachine& loaded, std::FILE* messages) {
    HttpParts parts;
    for (const NamedPart& part : kOwnParts) {
        std::optional<std::string> text = own_part(part.file, messages);
        if (!text) {
            return std::nullopt;
        }
        parts[part.path] = {part.type, std::move(*text)};
    }
    for (const NamedPart& part : kLibraries) {
        std::optional<std::string> text = library_part(part.file, kInstall, messages);
        if (!text) {
            return std::nullopt;
        }
        parts[part.path] = {part.type, std::move(*text)};
    }
    parts["/machine.json"] = {"application/json", machine_data(loaded)};
    return parts;
}

}  // namespace axg
