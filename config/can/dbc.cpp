// SPDX-License-Identifier: Apache-2.0
#include "config/can/dbc.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>

#include "config/can/dbc_lexer.hpp"
#include "config/can/dbc_pages.hpp"
#include "config/text/fault_list.hpp"
#include "config/text/quote_text.hpp"

namespace axg {
namespace {

constexpr std::size_t kNameBytesMax = 128;
constexpr std::uint32_t kExtendedFlag = 0x80000000U;
// Holds the signals of no message, under one of two identifiers that no message can have.
constexpr std::string_view kNoMessage = "VECTOR__INDEPENDENT_SIG_MSG";
bool is_of_no_message(std::uint32_t id) noexcept {
    return id == 0xC0000000U || id == 0x40000000U;
}

constexpr std::uint32_t kFrameFormatFd = 14, kFrameFormatExtendedFd = 15;  // of VFrameFormat
// Words that begin a section. A list of names without an end sign ends before one of them.
constexpr std::string_view kSections =
    " VERSION NS_ BS_ BU_ BO_ SG_ BO_TX_BU_ EV_ CM_ BA_DEF_ BA_DEF_DEF_ BA_ VAL_ VAL_TABLE_ "
    "SIG_GROUP_ SIG_VALTYPE_ SG_MUL_VAL_ SIG_TYPE_REF_ ENVVAR_DATA_ EV_DATA_ BA_DEF_REL_ BA_REL_ "
    "BA_DEF_DEF_REL_ BU_SG_REL_ BU_EV_REL_ BU_BO_REL_ SGTYPE_ SGTYPE_VAL_ SIGTYPE_VALTYPE_ "
    "BA_DEF_SGTYPE_ BA_SGTYPE_ CAT_DEF_ CAT_ FILTER ";

bool begins_section(const DbcToken& token) {
    return token.kind == DbcToken::Kind::word &&
           kSections.find(' ' + std::string{token.text} + ' ') != std::string_view::npos;
}

/// A type or a turn that a later line states about a signal.
struct Remark {
    std::uint32_t id;
    std::string_view signal;  // empty: of the whole message
    std::uint32_t value;
    int line;
};

class DbcParser {
  public:
    DbcParser(std::string_view text, const std::string& file) : faults_(file), rest_(text) {
        if (rest_.starts_with("\xEF\xBB\xBF")) {
            rest_.remove_prefix(3);
        }
        advance();
    }

    std::vector<ConfigFault> run(Dbc& out) {
        while (is_sound_ && now_.kind != DbcToken::Kind::end) {
            read_section();
        }
        if (is_sound_) {
            apply_remarks();
            check_names();
        }
        if (faults_.empty()) {
            out = std::move(dbc_);
        }
        return faults_.in_order();
    }

  private:
    void advance() noexcept { now_ = next_dbc_token(rest_, line_); }

    /// Reports what was found instead of `wanted`, and ends the parse.
    bool fail(std::string wanted) {
        const std::string got = now_.kind == DbcToken::Kind::end ? "the end of the file"
                                : now_.kind == DbcToken::Kind::broken && now_.text == "\""
                                    ? "a text without its closing quotation mark"
                                    : quoted(now_.text, 40);
        faults_.add(now_.line, section_, got, std::move(wanted));
        is_sound_ = false;
        return false;
    }

    bool take(std::string_view sign) {
        if (!now_.is(sign)) {
            return fail('"' + std::string{sign} + '"');
        }
        advance();
        return true;
    }

    bool take_word(std::string_view& out, const char* wanted) {
        if (now_.kind != DbcToken::Kind::word || now_.text.size() > kNameBytesMax) {
            return fail(wanted);
        }
        out = now_.text;
        advance();
        return true;
    }

    bool take_whole(std::uint32_t& out, std::uint32_t max, const char* wanted) {
        std::uint32_t value = 0;
        const char* const end = now_.text.data() + now_.text.size();
        const auto read = std::from_chars(now_.text.data(), end, value);
        if (now_.kind != DbcToken::Kind::number || read.ec != std::errc{} || read.ptr != end ||
            value > max) {
            return fail(wanted);
        }
        out = value;
        advance();
        return true;
    }

    bool take_number(double& out) {
        std::string_view text = now_.text;
        text.remove_prefix(text.starts_with('+') ? 1 : 0);
        const char* const end = text.data() + text.size();
        double value = 0;
        const auto read = std::from_chars(text.data(), end, value);
        if (now_.kind != DbcToken::Kind::number || read.ec != std::errc{} || read.ptr != end ||
            !std::isfinite(value)) {
            return fail("a number, such as 0.0001");
        }
        out = value;
        advance();
        return true;
    }

    void skip_words() {
        while (is_sound_ && !begins_section(now_) &&
               (now_.kind == DbcToken::Kind::word || now_.is(","))) {
            advance();
        }
    }

    void skip_line() {
        const int line = now_.line;
        while (now_.line == line && now_.kind != DbcToken::Kind::end) {
            advance();
        }
    }

    void skip_statement() {
        while (!now_.is(";")) {
            const bool is_open_text = now_.kind == DbcToken::Kind::broken && now_.text == "\"";
            if (now_.kind == DbcToken::Kind::end || is_open_text) {
                fail("\";\" at the end of the statement that begins in line " +
                     std::to_string(section_line_));
                return;
            }
            advance();
        }
        advance();
    }

    void read_section();
    void read_new_symbols();
    bool read_message();
    bool read_signal(DbcMessage& message);
    bool read_turn(DbcSignal& signal);
    bool read_bits(DbcSignal& signal);
    bool read_scale(DbcSignal& signal);
    bool read_value_type();
    bool read_type_reference();
    bool read_pages();
    bool read_values(std::vector<SignalSelector::Range>& values);
    bool read_attribute();
    void apply_remarks();
    void apply_type(DbcSignal& signal, const Remark& remark, const std::string& key);
    void check_names();

    FaultList faults_;
    std::string_view rest_;
    int line_ = 1;
    DbcToken now_;
    bool is_sound_ = true;
    std::string section_;  // what is being read, for faults
    int section_line_ = 1;
    Dbc dbc_;
    std::size_t signal_count_ = 0;
    std::vector<Remark> types_, references_, formats_;
    std::map<std::uint32_t, std::vector<DbcPages>> pages_;  // by identifier
};

void DbcParser::read_section() {
    section_ = now_.kind == DbcToken::Kind::word ? escaped(now_.text, 40) : "";
    section_line_ = now_.line;
    if (!begins_section(now_)) {
        section_.clear();
        fail("a section, as BO_ or CM_");
        return;
    }
    const std::string_view name = now_.text;
    if (name == "BO_") {
        read_message();
    } else if (name == "SG_") {
        fail("SG_ only inside a message, after BO_");
    } else if (name == "NS_") {
        read_new_symbols();
    } else if (name == "VERSION") {
        advance();
        if (now_.kind != DbcToken::Kind::text) {
            fail("a text in quotation marks");
            return;
        }
        advance();
    } else if (name == "BS_") {
        skip_line();
    } else if (name == "BU_") {
        advance();
        if (take(":")) {
            skip_words();
        }
    } else if (name == "SIG_VALTYPE_") {
        read_value_type();
    } else if (name == "SG_MUL_VAL_") {
        read_pages();
    } else if (name == "SIG_TYPE_REF_") {
        read_type_reference();
    } else if (name == "BA_") {
        read_attribute();
    } else {
        skip_statement();  // comments, tables of values and the like change no position
    }
}

/// The list of sections that the file may use: each alone in its line.
void DbcParser::read_new_symbols() {
    advance();
    if (!take(":")) {
        return;
    }
    while (now_.kind == DbcToken::Kind::word && now_.text != "BS_" && now_.text != "BU_" &&
           now_.text != "BO_") {
        const DbcToken symbol = now_;
        const std::string_view rest = rest_;
        const int line = line_;
        advance();
        if (now_.line == symbol.line && !begins_section(now_)) {
            now_ = symbol;  // a section of its own: something follows in its line
            rest_ = rest;
            line_ = line;
            return;
        }
    }
}

bool DbcParser::read_message() {
    advance();
    DbcMessage message;
    message.line = now_.line;
    std::uint32_t id = 0;
    std::string_view name;
    std::string_view sender;
    if (!take_whole(id, UINT32_MAX, "an identifier in decimal, such as 385")) {
        return false;
    }
    message.is_extended = (id & kExtendedFlag) != 0;
    message.id = id & ~kExtendedFlag;
    const bool is_message = !is_of_no_message(id) || now_.text != kNoMessage;
    if (is_message && message.id > (message.is_extended ? 0x1FFFFFFFU : 0x7FFU)) {
        faults_.add(message.line, "BO_", std::to_string(id),
                    "an identifier up to 2047, or one of 29 bits with bit 31 set");
    }
    if (!take_word(name, "the message's name: letters, digits and _") || !take(":") ||
        !take_whole(message.length_bytes, 0xFFFF, "the message's length in bytes") ||
        !take_word(sender, "the name of the node that sends it")) {
        return false;
    }
    message.name = name;
    message.is_flexible = message.length_bytes > 8;
    while (is_sound_ && now_.is("SG_")) {
        section_ = "BO_ " + message.name;
        read_signal(message);
    }
    if (!is_message || !is_sound_) {
        return is_sound_;
    }
    if (dbc_.messages.size() >= kDbcMessagesMax) {
        return fail("at most " + std::to_string(kDbcMessagesMax) + " messages");
    }
    dbc_.messages.push_back(std::move(message));
    return true;
}

bool DbcParser::read_signal(DbcMessage& message) {
    advance();
    DbcSignal signal;
    signal.line = now_.line;
    std::string_view name;
    if (!take_word(name, "the signal's name: letters, digits and _")) {
        return false;
    }
    signal.name = name;
    section_ += " SG_ " + signal.name;
    if (!read_turn(signal) || !take(":") || !read_bits(signal) || !read_scale(signal)) {
        return false;
    }
    if (now_.kind != DbcToken::Kind::text) {
        return fail("the unit in quotation marks, \"\" for none");
    }
    signal.unit = now_.text;
    advance();
    skip_words();  // who receives it
    if (++signal_count_ > kDbcSignalsMax) {
        return fail("at most " + std::to_string(kDbcSignalsMax) + " signals");
    }
    message.signals.push_back(std::move(signal));
    return true;
}

/// Reads an optional M, m5 or m5M.
bool DbcParser::read_turn(DbcSignal& signal) {
    if (now_.kind != DbcToken::Kind::word) {
        return true;
    }
    std::string_view text = now_.text;
    if (text == "M") {
        signal.turn = DbcSignal::Turn::selector;
        advance();
        return true;
    }
    const bool is_both = text.ends_with('M');
    text.remove_suffix(is_both ? 1 : 0);
    const char* const end = text.data() + text.size();
    const auto read = text.starts_with('m')
                          ? std::from_chars(text.data() + 1, end, signal.selected_by)
                          : std::from_chars_result{text.data(), std::errc::invalid_argument};
    if (read.ec != std::errc{} || read.ptr != end) {
        return fail("\":\", or M, or m and a number");
    }
    signal.turn = is_both ? DbcSignal::Turn::both : DbcSignal::Turn::selected;
    advance();
    return true;
}

bool DbcParser::read_bits(DbcSignal& signal) {
    std::uint32_t order = 0;
    if (!take_whole(signal.start_bit, 0xFFFF, "the start bit") || !take("|") ||
        !take_whole(signal.length_bits, 0xFFFF, "the length in bits") || !take("@") ||
        !take_whole(order, 1, "the byte order: 0 Motorola, 1 Intel")) {
        return false;
    }
    signal.order = order == 1 ? ByteOrder::little : ByteOrder::big;
    if (!now_.is("+") && !now_.is("-")) {
        return fail("+ (unsigned) or - (signed)");
    }
    signal.is_signed = now_.is("-");
    advance();
    return true;
}

bool DbcParser::read_scale(DbcSignal& signal) {
    return take("(") && take_number(signal.factor) && take(",") && take_number(signal.offset) &&
           take(")") && take("[") && take_number(signal.minimum) && take("|") &&
           take_number(signal.maximum) && take("]");
}

/// SIG_VALTYPE_ 385 PosX : 1; the colon is left out by some.
bool DbcParser::read_value_type() {
    advance();
    Remark remark{.id = 0, .signal = {}, .value = 0, .line = now_.line};
    if (!take_whole(remark.id, UINT32_MAX, "the identifier of a message") ||
        !take_word(remark.signal, "the name of a signal")) {
        return false;
    }
    if (now_.is(":")) {
        advance();
    }
    if (!take_whole(remark.value, 3, "0 integer, 1 float or 2 double") || !take(";")) {
        return false;
    }
    types_.push_back(remark);
    return true;
}

/// One range of SG_MUL_VAL_, such as 1-3.
bool DbcParser::read_values(std::vector<SignalSelector::Range>& values) {
    constexpr const char* kWanted = "a range of multiplexor values, such as 1-3";
    std::uint32_t least = 0, most = 0;
    if (!take_whole(least, UINT32_MAX, kWanted)) {
        return false;
    }
    if (now_.is("-")) {
        advance();
    } else if (now_.kind == DbcToken::Kind::number && now_.text.starts_with('-')) {
        now_.text.remove_prefix(1);  // read as the sign of the number
    } else {
        return fail(kWanted);
    }
    if (!take_whole(most, UINT32_MAX, kWanted)) {
        return false;
    }
    values.push_back({least, most});
    return true;
}

/// SG_MUL_VAL_ 400 P0 Page 0-0, 4-7;
bool DbcParser::read_pages() {
    std::uint32_t id = 0;
    DbcPages pages;
    advance();
    if (!take_whole(id, UINT32_MAX, "the identifier of a message") ||
        !take_word(pages.signal, "the name of a signal") ||
        !take_word(pages.multiplexor, "the name of its multiplexor") ||
        !read_values(pages.values)) {
        return false;
    }
    while (now_.is(",")) {
        advance();
        if (!read_values(pages.values)) {
            return false;
        }
    }
    pages_[id].push_back(std::move(pages));
    return take(";");
}

/// SIG_TYPE_REF_ redefines a signal: the signals of the message are refused.
bool DbcParser::read_type_reference() {
    const int line = now_.line;
    advance();
    std::uint32_t id = 0;
    if (!take_whole(id, UINT32_MAX, "the identifier of a message")) {
        return false;
    }
    references_.push_back({.id = id, .signal = {}, .value = 0, .line = line});
    skip_statement();
    return is_sound_;
}

/// Reads the attribute VFrameFormat (CAN FD or classical frames) and skips the others.
bool DbcParser::read_attribute() {
    advance();
    const bool is_format = now_.kind == DbcToken::Kind::text && now_.text == "VFrameFormat";
    if (is_format) {
        advance();
        if (now_.is("BO_")) {
            advance();
            Remark remark{.id = 0, .signal = {}, .value = 0, .line = now_.line};
            if (!take_whole(remark.id, UINT32_MAX, "the identifier of a message") ||
                !take_whole(remark.value, 0xFFFF, "the number of a frame format")) {
                return false;
            }
            formats_.push_back(remark);
        }
    }
    skip_statement();
    return is_sound_;
}

std::uint32_t whole_id(const DbcMessage& message) noexcept {
    return message.id | (message.is_extended ? kExtendedFlag : 0);
}

void DbcParser::apply_type(DbcSignal& signal, const Remark& remark, const std::string& key) {
    if (remark.value == 0) {
        return;
    }
    const std::uint32_t bits = remark.value == 1 ? 32 : 64;
    if (remark.value > 2 || signal.length_bits != bits) {
        faults_.add(remark.line, key,
                    "type " + std::to_string(remark.value) + " of " +
                        std::to_string(signal.length_bits) + " bits",
                    "0 integer, 1 float of 32 bits or 2 double of 64");
        return;
    }
    signal.type = remark.value == 1 ? SignalType::float32 : SignalType::float64;
}

void DbcParser::apply_remarks() {
    std::map<std::uint32_t, DbcMessage*> by_id;
    for (DbcMessage& message : dbc_.messages) {
        if (!by_id.emplace(whole_id(message), &message).second) {
            faults_.add(message.line, "BO_ " + message.name, std::to_string(whole_id(message)),
                        "one message for each identifier");
        }
    }
    for (const Remark& remark : types_) {
        const std::string key = "SIG_VALTYPE_ " + std::to_string(remark.id);
        const auto message = by_id.find(remark.id);
        DbcSignal* found = nullptr;
        if (message != by_id.end()) {
            for (DbcSignal& signal : message->second->signals) {
                found = signal.name == remark.signal ? &signal : found;
            }
        }
        if (found == nullptr && !is_of_no_message(remark.id)) {
            faults_.add(remark.line, key, quoted(remark.signal), "a signal of that message");
        } else if (found != nullptr) {
            apply_type(*found, remark, key);
        }
    }
    for (const Remark& remark : references_) {
        const auto message = by_id.find(remark.id);
        if (message != by_id.end()) {
            for (DbcSignal& signal : message->second->signals) {
                signal.refused = "SIG_TYPE_REF_ in line " + std::to_string(remark.line);
            }
        }
    }
    for (const Remark& remark : formats_) {
        const auto message = by_id.find(remark.id);
        if (message != by_id.end()) {
            message->second->is_flexible |=
                remark.value == kFrameFormatFd || remark.value == kFrameFormatExtendedFd;
        }
    }
}

void DbcParser::check_names() {
    std::set<std::string_view> messages;
    for (DbcMessage& message : dbc_.messages) {
        if (!messages.insert(message.name).second) {
            faults_.add(message.line, "BO_", quoted(message.name), "one message of that name");
        }
        std::set<std::string_view> signals;
        for (const DbcSignal& signal : message.signals) {
            if (!signals.insert(signal.name).second) {
                faults_.add(signal.line, "BO_ " + message.name, quoted(signal.name),
                            "one signal of that name in a message");
            }
        }
        apply_pages(message, pages_[whole_id(message)]);
    }
}

}  // namespace

std::vector<ConfigFault> parse_dbc(std::string_view text, const std::string& file, Dbc& out) {
    if (text.size() > kDbcSizeBytesMax) {
        FaultList faults{file};
        faults.add(1, "", std::to_string(text.size()) + " bytes",
                   "at most " + std::to_string(kDbcSizeBytesMax) + " bytes");
        return faults.in_order();
    }
    return DbcParser{text, file}.run(out);
}

}  // namespace axg
