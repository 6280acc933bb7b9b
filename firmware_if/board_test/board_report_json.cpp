// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "firmware_if/board_test/board_report.hpp"
#include "firmware_if/cli/document_json.hpp"

namespace axg {

std::string describe_board_test(const Machine& machine, const std::string& bus,
                                const BoardTestResult& result) {
    const BoardTestCounts counts = counts_of(result);
    nlohmann::ordered_json rules = nlohmann::ordered_json::array();
    for (const BoardFinding& finding : result.findings) {
        nlohmann::ordered_json row{{"name", finding.name},
                                   {"rule", finding.rule},
                                   {"demands", finding.demands},
                                   {"outcome", to_text(finding.outcome)},
                                   {"found", finding.found}};
        if (finding.at_us != 0) {
            row["frame_us"] = finding.at_us;
        }
        if (finding.outcome == Outcome::failed) {
            row["mend"] = finding.mend;
        }
        rules.push_back(std::move(row));
    }
    return text_of({{"machine", machine.name},
                    {"bus", bus},
                    {"passed", counts.passed},
                    {"failed", counts.failed},
                    {"unclear", counts.unclear},
                    {"not_tested", counts.not_tested},
                    {"abandoned", result.abandoned},
                    {"stops", result.stops.size()},
                    {"board_reaction_ms", result.reaction_s * 1e3},
                    {"sync",
                     {{"samples", result.sync.samples},
                      {"period_us", result.sync.mean_us},
                      {"jitter_us", result.sync.jitter_us_max}}},
                    {"rules", std::move(rules)},
                    {"machine_keys", machine_keys(machine, result)}});
}

}  // namespace axg
