// SPDX-License-Identifier: Apache-2.0
// The host's side of offline batches: fills one while others run, and checks every answer: its
// batch, its place, its check word, and the sums of the trees' memory.
#include "cuda/offline/offline_engine.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <utility>

#include "core/base/assert.hpp"
#include "core/base/rounding_mode.hpp"
#include "cuda/offline/offline_kernels.hpp"
#include "cuda/offline/offline_parts.hpp"

namespace axg {
namespace {

using namespace cuda;
using Clock = std::chrono::steady_clock;
using Parts = OfflineEngine::Parts;

constexpr const char* kLeftOut = "a step of an offline batch did not do its work";

/// Adds the time until its end to a sum, s.
class Spent {
  public:
    explicit Spent(double& sum_s) noexcept : sum_s_(sum_s), start_(Clock::now()) {}
    Spent(const Spent&) = delete;
    Spent& operator=(const Spent&) = delete;
    ~Spent() { sum_s_ += std::chrono::duration<double>(Clock::now() - start_).count(); }

  private:
    double& sum_s_;
    Clock::time_point start_;
};

/// One call: queries with their poses, or posed ones.
struct Call {
    std::span<const Query> given;
    PosedQueries posed;

    [[nodiscard]] std::size_t size() const noexcept { return given.size() + posed.queries.size(); }
};

/// Writes the items of queries [first, first + most) until the slot is full. Returns their bytes.
std::size_t fill_given(Parts& parts, OfflineSlot& slot, std::span<const Query> queries,
                       std::size_t most) noexcept {
    auto* const items = reinterpret_cast<GivenItem*>(slot.items);
    for (std::size_t i = 0; i < most; ++i) {
        const Query& q = queries[slot.first + i];
        const bool is_other = q.kind != QueryKind::farther;
        if (is_other) {
            slot.others.push_back(static_cast<std::uint32_t>(i));  // within its reserved room
        }
        items[i] = {q.pose,
                    q.r_mm,
                    q.pose_error_mm,
                    is_other ? kNoIndex : q.mesh_a,  // the device refuses it at once
                    q.mesh_b,
                    q.is_float_only ? 1U : 0U,
                    parts.sequence};
    }
    slot.buffers.count = static_cast<std::uint32_t>(most);
    slot.buffers.given = reinterpret_cast<const GivenItem*>(slot.items_device);
    slot.buffers.posed = nullptr;
    slot.buffers.positions = nullptr;
    return most * sizeof(GivenItem);
}

/// The same with the rows of positions that they need. A row outside of the call's is given to the
/// device as it is: too high there too.
std::size_t fill_posed_items(Parts& parts, OfflineSlot& slot, const PosedQueries& posed,
                             std::size_t most) noexcept {
    const std::uint32_t axes = parts.chains.axes;
    const auto rows = static_cast<std::uint32_t>(posed.positions.size() / std::max(axes, 1U));
    const std::uint32_t first_row = std::min(posed.queries[slot.first].row, rows);
    auto* const items = reinterpret_cast<PosedItem*>(slot.items);
    std::size_t count = 0;
    std::uint32_t end_row = first_row;
    for (; count < most; ++count) {
        const PosedQuery& q = posed.queries[slot.first + count];
        const bool is_row = q.row >= first_row && q.row < rows;
        if (is_row && q.row - first_row >= parts.options.queries_max) {
            break;  // no query needs the rows between: another batch
        }
        end_row = is_row ? std::max(end_row, q.row + 1) : end_row;
        items[count] = {q.pair,
                        is_row ? q.row - first_row : kNoIndex,
                        q.r_mm,
                        q.pose_error_mm,
                        q.is_float_only ? 1U : 0U,
                        parts.sequence};
    }
    const std::size_t at = count * sizeof(PosedItem), row_bytes = axes * sizeof(double);
    if (end_row != first_row) {
        std::memcpy(slot.items + at, posed.positions.data() + std::size_t{first_row} * axes,
                    (end_row - first_row) * row_bytes);
    }
    OfflineBuffers& b = slot.buffers;
    b.count = static_cast<std::uint32_t>(count);
    b.rows = end_row - first_row;
    b.given = nullptr;
    b.posed = reinterpret_cast<const PosedItem*>(slot.items_device);
    b.positions = reinterpret_cast<const double*>(slot.items_device + at);
    return at + b.rows * row_bytes;
}

/// Bytes that the host reads of a batch: the sums of the trees, and the answers.
std::size_t answer_bytes(const OfflineBuffers& b) noexcept {
    return b.slices * sizeof(OfflineSum) + b.count * sizeof(OfflineAnswer);
}

bool launch(Parts& parts, OfflineSlot& slot) noexcept {
    const OfflineBuffers& b = slot.buffers;
    const auto mark = [&](unsigned place) {
        return parts.options.measures ? cudaEventRecord(slot.marks[place], slot.stream)
                                      : cudaSuccess;
    };
    const auto does = [&](OfflineStep step) { return (parts.left_out & step) == 0; };
    cudaError_t error = mark(0);
    const auto next = [&error](cudaError_t status) {
        error = error != cudaSuccess ? error : status;
    };
    if (does(kCopyItems)) {
        next(cudaMemcpyAsync(slot.items_device, slot.items, slot.item_bytes, cudaMemcpyHostToDevice,
                             slot.stream));
    }
    next(mark(1));
    if (does(kPrepare)) {
        next(launch_prepare_offline(b, slot.stream));
    }
    next(mark(2));
    if (does(kAnswer)) {
        next(launch_answer_offline(b, slot.stream));
    }
    next(mark(3));
    if (does(kCopyAnswers)) {
        next(cudaMemcpyAsync(slot.answers, slot.answers_device, answer_bytes(b),
                             cudaMemcpyDeviceToHost, slot.stream));
    }
    next(cudaEventRecord(slot.done, slot.stream));
    return error == cudaSuccess;
}

/// Waits for the end of a batch. False: an error, or it did not come in time.
bool wait_for(Parts& parts, OfflineSlot& slot) noexcept {
    const Spent spent(parts.work.wait_s);
    const Clock::time_point deadline =
        Clock::now() + std::chrono::microseconds(parts.options.deadline_us);
    for (;;) {
        const cudaError_t state = cudaEventQuery(slot.done);
        if (state != cudaErrorNotReady) {
            return state == cudaSuccess;
        }
        if (Clock::now() > deadline) {
            return false;
        }
    }
}

void add_times(Parts& parts, const OfflineSlot& slot) noexcept {
    if (!parts.options.measures) {
        return;
    }
    OfflineWork& work = parts.work;
    double* const sums[] = {&work.to_device_s, &work.pose_s, &work.answer_s, &work.to_host_s};
    for (unsigned i = 0; i < 4; ++i) {
        float ms = 0;
        if (cudaEventElapsedTime(&ms, slot.marks[i], i == 3 ? slot.done : slot.marks[i + 1]) ==
            cudaSuccess) {
            *sums[i] += 1e-3 * static_cast<double>(ms);
        }
    }
}

/// Why the sums of the trees' memory are not those of the upload; null: they are.
const char* fault_of_trees(const Parts& parts, const OfflineSlot& slot) noexcept {
    const auto* const sums = reinterpret_cast<const OfflineSum*>(slot.answers);
    for (std::uint32_t i = 0; i < slot.buffers.slices; ++i) {
        if (sums[i].sequence != slot.buffers.sequence || sums[i].slice != i) {
            return kLeftOut;
        }
        if (sums[i].sum != parts.wanted[i]) {
            return "the trees in the GPU's memory have changed";
        }
    }
    return nullptr;
}

/// Reads one answer. False: it is not of this batch and place, or not whole.
bool read_answer(const OfflineAnswer& from, std::uint32_t sequence, std::uint32_t place,
                 QueryResult& to) noexcept {
    if (from.sequence != sequence || from.check != check_of(from, place) || from.state == 0 ||
        from.state >= kOfflineStates) {
        return false;
    }
    to = QueryResult{};
    to.status = from.state == kOfflineRefused ? QueryStatus::bad_query
                : from.state == kOfflineAgain ? QueryStatus::not_run
                                              : QueryStatus::ok;
    to.proof = from.state == kOfflineFar ? Proof::far : Proof::not_proven;
    to.touching = from.state == kOfflineNear ? 1 : 0;
    if (from.state != kOfflineRefused) {
        to.node_pairs = from.node_pairs;
        to.triangle_pairs = from.triangle_pairs;
        to.rechecks = from.rechecks;
    }
    return true;
}

/// Checks and reads all answers of a batch; lists those that the CPU engine has to give.
bool read_answers(Parts& parts, const OfflineSlot& slot, std::span<QueryResult> results) noexcept {
    const Spent spent(parts.work.check_s);
    parts.again.clear();
    const auto* const answers = reinterpret_cast<const OfflineAnswer*>(
        slot.answers + slot.buffers.slices * sizeof(OfflineSum));
    for (std::uint32_t i = 0; i < slot.buffers.count; ++i) {
        if (!read_answer(answers[i], slot.buffers.sequence, i, results[slot.first + i])) {
            return false;
        }
        if (answers[i].state == kOfflineAgain) {
            parts.again.push_back(i);  // within its reserved room
        }
    }
    parts.again.insert(parts.again.end(), slot.others.begin(), slot.others.end());
    return true;
}

/// The CPU engine answers the listed queries.
void answer_again(Parts& parts, const OfflineSlot& slot, const Call& call,
                  std::span<QueryResult> results) noexcept {
    const Spent spent(parts.work.again_s);
    parts.work.again += parts.again.size();
    for (const std::uint32_t i : parts.again) {
        const std::size_t place = slot.first + i;
        Query query;
        if (!call.given.empty()) {
            query = call.given[place];
        } else {
            const PosedQuery& q = call.posed.queries[place];
            query.r_mm = q.r_mm;
            query.pose_error_mm = q.pose_error_mm;
            query.is_float_only = q.is_float_only;
            AXG_ASSERT(fill_posed(
                parts.chains.joints.data(), parts.chains.chains.data(), parts.pairs[q.pair],
                &call.posed.positions[std::size_t{q.row} * parts.chains.axes], query));
        }
        parts.cpu->run({&query, 1}, results.subspan(place, 1));
    }
}

bool start(Parts& parts, OfflineSlot& slot, const Call& call, std::size_t at) noexcept {
    {
        const Spent spent(parts.work.fill_s);
        slot.first = at;
        slot.others.clear();
        slot.buffers.sequence = ++parts.sequence;
        const std::size_t most = std::min<std::size_t>(parts.options.queries_max, call.size() - at);
        slot.item_bytes = call.given.empty() ? fill_posed_items(parts, slot, call.posed, most)
                                             : fill_given(parts, slot, call.given, most);
    }
    const Spent spent(parts.work.launch_s);
    if (launch(parts, slot)) {
        return true;
    }
    parts.give_up("the GPU refused an offline batch");
    return false;
}

bool finish(Parts& parts, OfflineSlot& slot, const Call& call,
            std::span<QueryResult> results) noexcept {
    if (!wait_for(parts, slot)) {
        parts.give_up("an offline batch ended in an error, or not in time");
        return false;
    }
    if (const char* const why = fault_of_trees(parts, slot); why != nullptr) {
        parts.give_up(why);
        return false;
    }
    if (!read_answers(parts, slot, results)) {
        parts.give_up(kLeftOut);
        return false;
    }
    add_times(parts, slot);
    answer_again(parts, slot, call, results);
    parts.work.queries += slot.buffers.count;
    ++parts.work.batches;
    return true;
}

/// Runs a call in batches: while one runs, the host fills the next and reads the last.
void run_call(Parts& parts, const Call& call, std::span<QueryResult> results) noexcept {
    AXG_ASSERT(call.size() == results.size());
    if (!rounds_to_nearest()) {
        std::fill(results.begin(), results.end(), QueryResult{.status = QueryStatus::bad_rounding});
        return;
    }
    std::size_t at = 0, started = 0, finished = 0;
    const std::size_t room = parts.slots.size();
    while (parts.fault == nullptr && (at < call.size() || finished < started)) {
        if (at < call.size() && started - finished < room) {
            OfflineSlot& slot = parts.slots[started % room];
            if (start(parts, slot, call, at)) {
                at += slot.buffers.count;
                ++started;
            }
        } else {
            finished += finish(parts, parts.slots[finished % room], call, results) ? 1 : 0;
        }
    }
    if (parts.fault != nullptr) {
        std::fill(results.begin(), results.end(), QueryResult{});
    }
}

}  // namespace

OfflineEngine::OfflineEngine(std::unique_ptr<Parts> parts) noexcept : parts_(std::move(parts)) {}
OfflineEngine::OfflineEngine(OfflineEngine&&) noexcept = default;
OfflineEngine::~OfflineEngine() = default;

OfflineEngine::Parts::~Parts() {
    if (fault != nullptr) {
        return;  // the device may hang: waiting for it here could block without end
    }
    for (const OfflineSlot& slot : slots) {
        if (slot.stream != nullptr) {
            static_cast<void>(cudaStreamSynchronize(slot.stream));
            static_cast<void>(cudaStreamDestroy(slot.stream));
        }
        for (const cudaEvent_t mark :
             {slot.done, slot.marks[0], slot.marks[1], slot.marks[2], slot.marks[3]}) {
            if (mark != nullptr) {
                static_cast<void>(cudaEventDestroy(mark));
            }
        }
    }
    static_cast<void>(cudaFree(device_memory));
    static_cast<void>(cudaFreeHost(pinned_memory));
}

void OfflineEngine::run(std::span<const Query> queries, std::span<QueryResult> results) noexcept {
    run_call(*parts_, {queries, {}}, results);
}

void OfflineEngine::run(const PosedQueries& posed, std::span<QueryResult> results) noexcept {
    run_call(*parts_, {{}, posed}, results);
}

double OfflineEngine::repeat(std::uint32_t times) noexcept {
    Parts& parts = *parts_;
    std::uint64_t queries = 0;
    bool is_good = parts.fault == nullptr;
    const Clock::time_point start = Clock::now();
    for (std::uint32_t i = 0; i < times; ++i) {
        for (OfflineSlot& slot : parts.slots) {
            if (slot.item_bytes != 0) {  // it has had a batch
                is_good = is_good && launch(parts, slot);
                queries += slot.buffers.count;
            }
        }
    }
    for (OfflineSlot& slot : parts.slots) {
        is_good = is_good && (slot.item_bytes == 0 || wait_for(parts, slot));
    }
    const std::chrono::duration<double> spent = Clock::now() - start;
    if (!is_good) {
        parts.give_up("a repeated offline batch failed");
        return 0;
    }
    return static_cast<double>(queries) / spent.count();
}

Engine OfflineEngine::engine() noexcept {
    Engine out;
    out.self = this;
    out.run = [](void* self, std::span<const Query> queries,
                 std::span<QueryResult> results) noexcept {
        static_cast<OfflineEngine*>(self)->run(queries, results);
    };
    out.prefers_batches = true;
    return out;
}

const char* OfflineEngine::fault() const noexcept {
    return parts_->fault;
}
const OfflineWork& OfflineEngine::work() const noexcept {
    return parts_->work;
}
const CudaDevice& OfflineEngine::device() const noexcept {
    return parts_->device;
}
const CudaMemoryPlan& OfflineEngine::memory() const noexcept {
    return parts_->memory_plan;
}

}  // namespace axg
