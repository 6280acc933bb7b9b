// SPDX-License-Identifier: Apache-2.0
// What a number in G-code may be: digits, a parameter, an expression. Angles in degrees.
// Source: LinuxCNC "G-code overview", parameters and expressions; held to its interpreter by
// tests/oracle/rs274_test.py.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace axg {

inline constexpr std::uint32_t kGcodeParametersMax = 5602;  // numbered ones are below

/// Numbered and named parameters. Those of a subroutine's own begin anew with every call.
class GcodeParameters {
  public:
    /// What the control itself keeps there (5220, 5400, 5420 to 5428), or nothing.
    using Live = std::function<std::optional<double>(std::uint32_t)>;
    explicit GcodeParameters(Live live);

    /// Nothing: not kept by this reader, or a name that was never set.
    [[nodiscard]] std::optional<double> numbered(std::uint32_t index) const;
    [[nodiscard]] std::optional<double> named(const std::string& name) const;
    /// False: no program may write there.
    [[nodiscard]] bool set_numbered(std::uint32_t index, double value);
    void set_named(const std::string& name, double value);

    /// A call: #1 to #30 are the arguments, then 0, and names without '_' in front are unknown.
    void enter(const std::vector<double>& arguments);
    void leave();

  private:
    using Names = std::map<std::string, double, std::less<>>;
    struct Scope {
        std::vector<double> numbered;  // of the caller, #1 to #30
        Names names;
    };
    static bool is_global(const std::string& name) { return !name.empty() && name[0] == '_'; }

    Live live_;
    std::vector<double> numbered_;
    Names global_, local_;
    std::vector<Scope> callers_;
};

/// One parameter that a line sets, in effect after the whole line was read.
struct GcodeAssignment {
    std::uint32_t index = 0;  // 0: named
    std::string name;
    double value = 0;
};

/// Reads values from the start of a text without blanks, in upper case.
class GcodeValueReader {
  public:
    /// @param parameters  null: only plain numbers; parameters and expressions are refused
    GcodeValueReader(std::string_view text, const GcodeParameters* parameters)
        : rest_(text), parameters_(parameters) {}

    /// A number, #parameter, [expression] or function, with a sign in front or none.
    [[nodiscard]] std::optional<double> value();
    /// "#3=..." or "#<name>=...".
    [[nodiscard]] std::optional<GcodeAssignment> assignment();
    [[nodiscard]] std::string_view rest() const noexcept { return rest_; }
    /// Why nothing came back.
    [[nodiscard]] const std::string& fault() const noexcept { return fault_; }

  private:
    std::optional<double> refuse(std::string message);
    bool take(std::string_view text);
    std::optional<double> number();
    std::optional<double> bracket();
    std::optional<double> sum_of(int level);
    std::optional<double> parameter();
    std::optional<double> function();
    std::optional<double> exists();
    std::optional<std::string> name();
    std::optional<std::uint32_t> index();

    std::string_view rest_;
    const GcodeParameters* parameters_;
    std::string fault_;
    int depth_ = 0;
};

}  // namespace axg
