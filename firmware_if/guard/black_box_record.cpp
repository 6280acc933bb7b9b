// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/guard/black_box_record.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string_view>
#include <utility>
#include <variant>

#include "firmware_if/protocol/wire.hpp"

namespace axg {
namespace {

constexpr std::size_t kHeadBytes = 16, kChecksumBytes = 4;
static_assert(kBlackBoxRecordBytesMin == kHeadBytes + kChecksumBytes);
constexpr std::size_t kWordsBytesMax = 96;

/// Writes little-endian fields one after the other. `out` has room for the longest record.
class Writer {
  public:
    explicit Writer(std::span<std::uint8_t> out) noexcept : out_(out) {}

    void integer(std::uint64_t value, unsigned bytes) noexcept {
        detail::put_little(out_.data() + at_, value, bytes);
        at_ += bytes;
    }
    template <class Enum>
    void tag(Enum value) noexcept {
        integer(static_cast<std::uint8_t>(value), 1);
    }
    void time(std::int64_t us) noexcept { integer(static_cast<std::uint64_t>(us), 8); }
    void bytes(std::span<const std::uint8_t> from) noexcept {
        std::copy(from.begin(), from.end(), out_.begin() + static_cast<std::ptrdiff_t>(at_));
        at_ += from.size();
    }
    [[nodiscard]] std::size_t size() const noexcept { return at_; }

  private:
    std::span<std::uint8_t> out_;
    std::size_t at_ = 0;
};

/// Reads the same fields. Beyond the end integers are 0 and is_sound() is false.
class Reader {
  public:
    explicit Reader(std::span<const std::uint8_t> from) noexcept : from_(from) {}

    std::uint64_t integer(unsigned bytes) noexcept {
        if (from_.size() < bytes) {
            is_sound_ = false;
            from_ = {};
            return 0;
        }
        const std::uint64_t value = detail::get_little(from_.data(), bytes);
        from_ = from_.subspan(bytes);
        return value;
    }
    /// A value of an enumeration whose last one this is.
    template <class Enum>
    Enum tag(Enum last) noexcept {
        const std::uint64_t value = integer(1);
        is_sound_ = is_sound_ && value <= static_cast<std::uint64_t>(last);
        return is_sound_ ? static_cast<Enum>(value) : Enum{};
    }
    bool boolean() noexcept {
        const std::uint64_t value = integer(1);
        is_sound_ = is_sound_ && value <= 1;
        return value == 1;
    }
    std::uint32_t word() noexcept { return static_cast<std::uint32_t>(integer(4)); }
    std::uint8_t byte() noexcept { return static_cast<std::uint8_t>(integer(1)); }
    std::int64_t time() noexcept { return static_cast<std::int64_t>(integer(8)); }
    void bytes(std::span<std::uint8_t> to) noexcept {
        if (from_.size() < to.size()) {
            is_sound_ = false;
            return;
        }
        std::copy_n(from_.begin(), to.size(), to.begin());
        from_ = from_.subspan(to.size());
    }
    /// Text that ends with a zero byte, and with the record.
    const char* text() noexcept {
        const bool is_text = !from_.empty() && from_.size() <= kWordsBytesMax + 1 &&
                             std::find(from_.begin(), from_.end(), 0) == from_.end() - 1;
        is_sound_ = is_sound_ && is_text;
        const char* const words = is_text ? reinterpret_cast<const char*>(from_.data()) : "";
        from_ = {};
        return words;
    }
    void expect(bool is_true) noexcept { is_sound_ = is_sound_ && is_true; }
    [[nodiscard]] bool is_sound() const noexcept { return is_sound_; }
    [[nodiscard]] bool is_finished() const noexcept { return is_sound_ && from_.empty(); }

  private:
    std::span<const std::uint8_t> from_;
    bool is_sound_ = true;
};

constexpr unsigned kExtended = 1, kRemote = 2, kError = 4, kFd = 8, kBitRateSwitch = 16,
                   kErrorState = 32, kSentByHost = 64;

void write(Writer& out, const CanFrame& frame) noexcept {
    const unsigned bits = (frame.extended ? kExtended : 0U) | (frame.remote ? kRemote : 0U) |
                          (frame.error ? kError : 0U) | (frame.fd ? kFd : 0U) |
                          (frame.bit_rate_switch ? kBitRateSwitch : 0U) |
                          (frame.error_state ? kErrorState : 0U) |
                          (frame.sent_by_host ? kSentByHost : 0U);
    const std::size_t length = std::min<std::size_t>(frame.length_bytes, frame.data.size());
    out.time(frame.time_us);
    out.integer(frame.id, 4);
    out.integer(bits, 1);
    out.integer(frame.raw_dlc, 1);
    out.integer(length, 1);
    out.bytes(std::span(frame.data).first(length));
}

CanFrame read_frame(Reader& in) noexcept {
    CanFrame frame;
    frame.time_us = in.time();
    frame.id = in.word();
    const std::uint8_t bits = in.byte();
    in.expect(bits < 2 * kSentByHost);
    frame.extended = (bits & kExtended) != 0;
    frame.remote = (bits & kRemote) != 0;
    frame.error = (bits & kError) != 0;
    frame.fd = (bits & kFd) != 0;
    frame.bit_rate_switch = (bits & kBitRateSwitch) != 0;
    frame.error_state = (bits & kErrorState) != 0;
    frame.sent_by_host = (bits & kSentByHost) != 0;
    frame.raw_dlc = in.byte();
    const std::uint8_t length = in.byte();
    in.expect(frame.raw_dlc <= 15 && length <= (frame.fd ? 64 : 8));
    frame.length_bytes = length <= 64 ? length : std::uint8_t{0};
    in.bytes(std::span(frame.data).first(frame.length_bytes));
    return frame;
}

void write(Writer& out, const CanArrival& arrival) noexcept {
    out.integer(arrival.is_own ? 1 : 0, 1);
    out.time(arrival.hardware_ns);
    write(out, arrival.frame);
}
void read(Reader& in, CanArrival& arrival) noexcept {
    arrival.is_own = in.boolean();
    arrival.hardware_ns = in.time();
    arrival.frame = read_frame(in);
}

void write(Writer& out, const SentFrame& sent) noexcept {
    out.tag(sent.status);
    write(out, sent.frame);
}
void read(Reader& in, SentFrame& sent) noexcept {
    sent.status = in.tag(SendStatus::gone);
    sent.frame = read_frame(in);
}

void write(Writer& out, const ReadStatus& status) noexcept {
    out.tag(status);
}
void read(Reader& in, ReadStatus& status) noexcept {
    status = in.tag(ReadStatus::gone);
}

void write(Writer& out, const LiveQuery& query) noexcept {
    const ReceiverEvent& event = query.event;
    const AxisSnapshot& snapshot = event.snapshot;
    out.tag(query.kind);
    out.integer(query.number, 4);
    out.integer(query.epoch, 4);
    out.integer(query.period, 4);
    out.integer(query.is_armed ? 1 : 0, 1);
    if (query.kind != LiveQuery::Kind::snapshot) {
        return;
    }
    out.tag(event.state);
    out.integer(event.sync_counter, 1);
    out.integer(event.samples_lost, 4);
    out.time(snapshot.latched_us);
    out.time(snapshot.arrived_us);
    out.integer(snapshot.sample, 8);
    out.integer(snapshot.tool, 2);
    out.integer(snapshot.mode, 1);
    out.integer(snapshot.flags, 1);
    const std::uint32_t axes = std::min(snapshot.axis_count, kAxesMax);
    out.integer(axes, 1);
    for (std::uint32_t i = 0; i < axes; ++i) {
        out.integer(std::bit_cast<std::uint64_t>(snapshot.position[i]), 8);
    }
    out.tag(query.caps.status);
    out.bytes(std::span(query.caps.acked).first(axes));
    out.bytes(std::span(query.caps.since).first(axes));
}
void read(Reader& in, LiveQuery& query) noexcept {
    ReceiverEvent& event = query.event;
    AxisSnapshot& snapshot = event.snapshot;
    query.kind = in.tag(LiveQuery::Kind::look_ahead);
    query.number = in.word();
    query.epoch = in.word();
    query.period = in.word();
    query.is_armed = in.boolean();
    if (query.kind != LiveQuery::Kind::snapshot) {
        return;
    }
    event.kind = ReceiverEvent::Kind::snapshot;
    event.state = in.tag(ReceiverState::valid);
    event.sync_counter = in.byte();
    event.samples_lost = in.word();
    snapshot.latched_us = in.time();
    snapshot.arrived_us = in.time();
    snapshot.sample = in.integer(8);
    snapshot.tool = static_cast<std::uint16_t>(in.integer(2));
    snapshot.mode = in.byte();
    snapshot.flags = in.byte();
    const std::uint8_t axes = in.byte();
    in.expect(axes <= kAxesMax);
    snapshot.axis_count = std::min<std::uint32_t>(axes, kAxesMax);
    for (std::uint32_t i = 0; i < snapshot.axis_count; ++i) {
        snapshot.position[i] = std::bit_cast<double>(in.integer(8));
    }
    query.caps.status = in.tag(AckStatus::known);
    in.bytes(std::span(query.caps.acked).first(snapshot.axis_count));
    in.bytes(std::span(query.caps.since).first(snapshot.axis_count));
}

/// Motion that a result permits; each value has its own word on the bus.
enum class Permitted : std::uint8_t { nothing = 0, motion = 1, jog = 2 };

Permitted permitted_by(const CycleResult& result) noexcept {
    return !result.has_permit ? Permitted::nothing
           : result.is_jog    ? Permitted::jog
                              : Permitted::motion;
}

void write(Writer& out, const LiveResult& live_result) noexcept {
    out.tag(live_result.kind);
    out.integer(live_result.is_passed ? 1 : 0, 1);
    out.integer(live_result.number, 4);
    out.integer(live_result.epoch, 4);
    out.integer(live_result.period, 4);
    out.integer(live_result.taken, 4);
    out.tag(permitted_by(live_result.result));
    out.integer(live_result.result.is_stop ? 1 : 0, 1);
    out.tag(live_result.result.reason);
    out.integer(live_result.result.pair, 4);
    out.integer(live_result.result.not_proven, 4);
    out.integer(live_result.result.known_answer_signature, 2);
    out.integer(live_result.result.samples, 1);
    out.integer(live_result.result.has_cap ? 1 : 0, 1);
    out.integer(live_result.result.is_held ? 1 : 0, 1);
    out.integer(live_result.result.cap_order.cap, 1);
    out.integer(live_result.result.cap_order.mask, 1);
    out.tag(live_result.result.cap_fact.kind);
    out.integer(live_result.result.cap_fact.axis, 4);
    out.integer(live_result.sync_counter, 1);
    out.time(live_result.latched_us);
    out.time(live_result.arrived_us);
    out.time(live_result.done_us);
}
void read(Reader& in, LiveResult& live_result) noexcept {
    live_result.kind = in.tag(LiveQuery::Kind::look_ahead);
    live_result.is_passed = in.boolean();
    live_result.number = in.word();
    live_result.epoch = in.word();
    live_result.period = in.word();
    live_result.taken = in.word();
    const Permitted permitted = in.tag(Permitted::jog);
    live_result.result.has_permit = permitted != Permitted::nothing;
    live_result.result.is_jog = permitted == Permitted::jog;
    live_result.result.is_stop = in.boolean();
    live_result.result.reason = in.tag(kStopReasonLast);
    live_result.result.pair = in.word();
    live_result.result.not_proven = in.word();
    live_result.result.known_answer_signature = static_cast<std::uint16_t>(in.integer(2));
    live_result.result.samples = in.byte();
    live_result.result.has_cap = in.boolean();
    live_result.result.is_held = in.boolean();
    live_result.result.cap_order.cap = in.byte();
    live_result.result.cap_order.mask = in.byte();
    live_result.result.cap_fact.kind = in.tag(CapBreak::unknown_permit);
    live_result.result.cap_fact.axis = in.word();
    live_result.sync_counter = in.byte();
    live_result.latched_us = in.time();
    live_result.arrived_us = in.time();
    live_result.done_us = in.time();
}

void write(Writer& out, const LiveNote& note) noexcept {
    out.tag(note.kind);
    out.tag(note.phase);
    out.tag(note.cause);
    out.tag(note.reason);
    out.integer(note.pair, 4);
    out.tag(note.fault);
    out.integer(note.frame_id, 4);
    out.integer(note.axis, 4);
    out.integer(note.count, 4);
    out.integer(note.ours, 4);
    out.integer(note.theirs, 4);
    const std::string_view words = std::string_view(note.words).substr(0, kWordsBytesMax);
    out.bytes({reinterpret_cast<const std::uint8_t*>(words.data()), words.size()});
    out.integer(0, 1);
}
void read(Reader& in, LiveNote& note) noexcept {
    note.kind = in.tag(LiveNote::Kind::person);
    note.phase = in.tag(GuardPhase::armed);
    note.cause = in.tag(kGuardFaultLast);
    note.reason = in.tag(kStopReasonLast);
    note.pair = in.word();
    note.fault = in.tag(static_cast<ReceiverFault>(kReceiverFaults - 1));
    note.frame_id = in.word();
    note.axis = in.word();
    note.count = in.word();
    note.ours = in.word();
    note.theirs = in.word();
    note.words = in.text();
}

void write(Writer& out, const LostRecords& lost) noexcept {
    out.integer(lost.count, 4);
}
void read(Reader& in, LostRecords& lost) noexcept {
    lost.count = in.word();
}

void write(Writer&, const BlackBoxEnd&) noexcept {}
void read(Reader&, BlackBoxEnd&) noexcept {}

void write(Writer&, const EmptyTurn&) noexcept {}
void read(Reader&, EmptyTurn&) noexcept {}

void write(Writer& out, const LiveCall& call) noexcept {
    out.tag(call.kind);
    out.tag(call.fault);
}
void read(Reader& in, LiveCall& call) noexcept {
    call.kind = in.tag(LiveCall::Kind::report);
    call.fault = in.tag(kGuardFaultLast);
}

/// Content number `kind`, of whatever type that is.
template <std::size_t kAt = 0>
void read_content(Reader& in, std::size_t kind, BlackBoxContent& out) noexcept {
    if constexpr (kAt < std::variant_size_v<BlackBoxContent>) {
        if (kind == kAt) {
            read(in, out.emplace<kAt>());
        } else {
            read_content<kAt + 1>(in, kind, out);
        }
    }
}

bool has_checksum(std::span<const std::uint8_t> bytes) noexcept {
    const std::size_t end = bytes.size() - kChecksumBytes;
    return crc32(bytes.first(end)) == detail::get_little(bytes.data() + end, kChecksumBytes);
}

/// std::visit may throw where a variant holds nothing.
template <std::size_t... kind>
void write_content(Writer& writer, const decltype(BlackBoxEntry::content)& content,
                   std::index_sequence<kind...>) {
    (
        [&] {
            if (const auto* held = std::get_if<kind>(&content)) {
                write(writer, *held);
            }
        }(),
        ...);
}

}  // namespace

const char* to_text(BlackBoxStatus status) noexcept {
    switch (status) {
        case BlackBoxStatus::ok:
            return "ok";
        case BlackBoxStatus::cut_short:
            return "truncated";
        case BlackBoxStatus::bad_magic:
            return "not a black box";
        case BlackBoxStatus::bad_version:
            return "a black box of another version";
        case BlackBoxStatus::bad_length:
            return "an invalid record length";
        case BlackBoxStatus::bad_checksum:
            return "a wrong checksum";
        case BlackBoxStatus::bad_content:
            return "an invalid value";
    }
    return "?";
}

namespace {

void write(Writer& out, const CyclePlan& plan) noexcept {
    out.integer(plan.stages, 1);
    out.tag(plan.form);
    out.integer(plan.depth_max, 1);
    out.integer(0, 1);
    for (std::uint32_t stage = 0; stage < kStagesMax; ++stage) {
        out.integer(plan.queries[stage], 4);
        for (const WorkListName& one : kWorkLists) {
            out.integer(plan.lists[stage].*one.list, 4);
        }
    }
}

/// False: an invalid plan. The limits bound the memory that a prover reserves for its queries.
bool read(Reader& in, CyclePlan& plan) noexcept {
    constexpr std::uint32_t kQueriesMax = 1U << 20U;
    plan.stages = in.byte();
    plan.form = in.tag(TreeForm::leaves);
    plan.depth_max = in.byte();
    in.expect(plan.stages >= 1 && plan.stages <= kStagesMax && plan.depth_max <= kStageDepthMax &&
              in.byte() == 0);
    for (std::uint32_t stage = 0; stage < kStagesMax; ++stage) {
        plan.queries[stage] = in.word();
        in.expect(plan.queries[stage] <= kQueriesMax);
        for (const WorkListName& one : kWorkLists) {
            plan.lists[stage].*one.list = in.word();
        }
    }
    return in.is_sound();
}

}  // namespace

void encode_black_box_header(const BlackBoxHeader& header,
                             std::span<std::uint8_t, kBlackBoxHeaderBytes> out) noexcept {
    std::fill(out.begin(), out.end(), std::uint8_t{0});
    Writer writer(out);
    writer.bytes(kBlackBoxMagic);
    writer.integer(kBlackBoxVersion, 1);
    writer.integer(header.is_stoppable ? 1 : 0, 1);
    writer.integer(header.accepts_local ? 1 : 0, 1);
    writer.integer(0, 1);
    writer.time(header.time_us);
    writer.time(header.unix_us);
    writer.bytes({reinterpret_cast<const std::uint8_t*>(header.configuration.data()),
                  header.configuration.size()});
    write(writer, header.plan);
    writer.integer(crc32(out.first(writer.size())), kChecksumBytes);
}

BlackBoxStatus decode_black_box_header(std::span<const std::uint8_t> bytes,
                                       BlackBoxHeader& out) noexcept {
    if (bytes.size() < kBlackBoxMagic.size() ||
        !std::equal(kBlackBoxMagic.begin(), kBlackBoxMagic.end(), bytes.begin())) {
        return BlackBoxStatus::bad_magic;
    }
    if (bytes.size() < kBlackBoxHeaderBytes) {
        return BlackBoxStatus::cut_short;
    }
    Reader reader(bytes.subspan(kBlackBoxMagic.size()));
    if (reader.byte() != kBlackBoxVersion) {
        return BlackBoxStatus::bad_version;
    }
    if (!has_checksum(bytes.first(kBlackBoxHeaderBytes))) {
        return BlackBoxStatus::bad_checksum;
    }
    out.is_stoppable = reader.boolean();
    out.accepts_local = reader.boolean();
    reader.expect(reader.byte() == 0);
    out.time_us = reader.time();
    out.unix_us = reader.time();
    std::array<std::uint8_t, 64> text{};
    reader.bytes(text);
    std::copy(text.begin(), text.end(), out.configuration.begin());
    return read(reader, out.plan) ? BlackBoxStatus::ok : BlackBoxStatus::bad_content;
}

std::size_t encode_black_box_record(const BlackBoxEntry& entry, std::uint32_t sequence,
                                    std::span<std::uint8_t, kBlackBoxRecordBytesMax> out) noexcept {
    Writer writer(out);
    writer.integer(0, 2);  // the length is written at the end
    writer.integer(entry.content.index() + 1, 1);
    writer.integer(0, 1);
    writer.integer(sequence, 4);
    writer.time(entry.time_us);
    write_content(writer, entry.content,
                  std::make_index_sequence<std::variant_size_v<decltype(entry.content)>>());
    detail::put_little(out.data(), writer.size() + kChecksumBytes, 2);
    writer.integer(crc32(out.first(writer.size())), kChecksumBytes);
    return writer.size();
}

BlackBoxStatus decode_black_box_record(std::span<const std::uint8_t> bytes,
                                       BlackBoxRecord& out) noexcept {
    if (bytes.size() < kBlackBoxRecordBytesMin) {
        return BlackBoxStatus::cut_short;
    }
    Reader head(bytes.first(kHeadBytes));
    const std::size_t size = head.integer(2);
    const std::size_t kind = head.byte();
    const std::uint8_t zero = head.byte();
    if (size < kBlackBoxRecordBytesMin || size > kBlackBoxRecordBytesMax) {
        return BlackBoxStatus::bad_length;
    }
    if (size > bytes.size()) {
        return BlackBoxStatus::cut_short;
    }
    if (!has_checksum(bytes.first(size))) {
        return BlackBoxStatus::bad_checksum;
    }
    out.sequence = head.word();
    out.entry.time_us = head.time();
    out.size_bytes = size;
    if (kind == 0 || kind > std::variant_size_v<BlackBoxContent> || zero != 0) {
        return BlackBoxStatus::bad_content;
    }
    Reader reader(bytes.subspan(kHeadBytes, size - kBlackBoxRecordBytesMin));
    read_content(reader, kind - 1, out.entry.content);
    if (auto* note = std::get_if<LiveNote>(&out.entry.content)) {
        note->time_us = out.entry.time_us;
    }
    return reader.is_finished() ? BlackBoxStatus::ok : BlackBoxStatus::bad_content;
}

}  // namespace axg
