// SPDX-License-Identifier: Apache-2.0
// Reads the forms of a number in G-code: digits, a parameter, an expression. Angles in degrees.
// Source: LinuxCNC "G-code overview", parameters and expressions; tests/oracle/rs274_test.py
// compares them with its interpreter.
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

/// Numbered and named parameters. Every call resets the local ones of a subroutine.
class GcodeParameters {
  public:
    /// Returns a parameter of the control itself (5220, 5400, 5420 to 5428), or nothing.
    using Live = std::function<std::optional<double>(std::uint32_t)>;
    explicit GcodeParameters(Live live);

    /// Returns nothing for a number that this reader does not support, or a name never set.
    [[nodiscard]] std::optional<double> numbered(std::uint32_t index) const;
    [[nodiscard]] std::optional<double> named(const std::string& name) const;
    /// False: a program may not write this parameter.
    [[nodiscard]] bool set_numbered(std::uint32_t index, double value);
    void set_named(const std::string& name, double value);
    /// Names that only the control sets, such as "_LINE" and "_INI[...".
    [[nodiscard]] static bool is_read_only(const std::string& name);

    /// Begins a call: #1 to #30 are the arguments, the rest of them 0; local names (without a
    /// leading '_') are undefined.
    void enter(const std::vector<double>& arguments);
    /// Begins a call by M98: only names without a leading '_' are its own.
    void enter_names();
    void leave();

  private:
    using Names = std::map<std::string, double, std::less<>>;
    struct Scope {
        std::vector<double> numbered;  // of the caller, #1 to #30; empty: shared with it
        Names names;
    };
    static bool is_global(const std::string& name) { return !name.empty() && name[0] == '_'; }

    Live live_;
    std::vector<double> numbered_;
    Names global_, local_;
    std::vector<Scope> callers_;
};

/// One parameter that a line sets, effective after the whole line was read.
struct GcodeAssignment {
    std::uint32_t index = 0;  // 0: named
    std::string name;
    double value = 0;
};

/// Reads values from the start of a text without blanks, in upper case.
class GcodeValueReader {
  public:
    /// @param parameters  null: accepts only plain numbers, refuses parameters and expressions
    GcodeValueReader(std::string_view text, const GcodeParameters* parameters)
        : rest_(text), parameters_(parameters) {}

    /// Reads a number, #parameter, [expression] or function, with or without a sign.
    [[nodiscard]] std::optional<double> value();
    /// "#3=..." or "#<name>=...".
    [[nodiscard]] std::optional<GcodeAssignment> assignment();
    [[nodiscard]] std::string_view rest() const noexcept { return rest_; }
    /// The reason if value() or assignment() returned nothing.
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
