// SPDX-License-Identifier: Apache-2.0
#include "config/text/fault_list.hpp"

#include <algorithm>
#include <utility>

#include "config/text/fault_text.hpp"
#include "config/text/quote_text.hpp"

namespace axg {
namespace {
constexpr std::size_t kFaultsKeptMax = 1000;
}

std::string to_string(const ConfigFault& fault) {
    std::string text = fault.where + ": ";
    if (!fault.key.empty()) {
        text += fault.key + ": ";
    }
    if (fault.got.starts_with(kUnknownKey) || fault.wanted.starts_with("; ")) {
        return text + fault_text(fault.got, "", fault.wanted);
    }
    return text + fault_text(fault.got.empty()   ? "missing required key"
                             : fault.key.empty() ? "invalid file"
                                                 : "invalid value",
                             fault.got, fault.wanted);
}

FaultList::FaultList(const std::string& file) : file_(escaped(file, 4096)) {}

void FaultList::add(int line, std::string key, std::string got, std::string wanted) {
    if (!faults_.empty() && faults_.back().line == line && faults_.back().fault.key == key &&
        faults_.back().fault.got == got) {
        return;  // one slip that many combinations stumble over is one fault
    }
    if (faults_.size() >= kFaultsKeptMax) {
        ++dropped_;
        return;
    }
    faults_.push_back({line, {where(line), std::move(key), std::move(got), std::move(wanted)}});
}

void FaultList::add_all(int line, const std::vector<ConfigFault>& faults) {
    for (const ConfigFault& fault : faults) {
        if (faults_.size() >= kFaultsKeptMax) {
            ++dropped_;
        } else {
            faults_.push_back({line, fault});
        }
    }
}

std::string FaultList::where(int line) const {
    return file_ + ':' + std::to_string(line);
}

std::vector<ConfigFault> FaultList::in_order() const {
    std::vector<Entry> sorted = faults_;
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const Entry& a, const Entry& b) { return a.line < b.line; });
    const std::size_t shown = std::min(sorted.size(), kFaultsShownMax);
    std::vector<ConfigFault> out;
    for (std::size_t i = 0; i < shown; ++i) {
        out.push_back(std::move(sorted[i].fault));
    }
    if (count() > shown) {
        out.push_back({file_, "", std::to_string(count() - shown) + " more faults",
                       "; correct the faults above first"});
    }
    return out;
}

}  // namespace axg
