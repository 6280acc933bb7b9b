// SPDX-License-Identifier: Apache-2.0
// The host's side of the paper's kernels: memory, launches, clocks. create() reserves the memory.
#include "cuda/paper/paper_gpu.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <new>
#include <utility>

#include "core/base/assert.hpp"
#include "cuda/engine/engine_parts.hpp"
#include "cuda/paper/paper_kernels.hpp"

namespace axg::paper {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kSeriesMax = 1U << 14U;  // queries of one series
constexpr double kLateUs = 10e6;               // a query needs only microseconds

double us_since(Clock::time_point start) {
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

/// One row of all triangles for each of the nine coordinates.
std::vector<float> planes_of(const Body& body) {
    std::vector<float> planes;
    planes.reserve(9 * body.triangles.size());
    for (const Vec3f Triangle::*const vertex : {&Triangle::a, &Triangle::b, &Triangle::c}) {
        for (const float Vec3f::*const coordinate : {&Vec3f::x, &Vec3f::y, &Vec3f::z}) {
            for (const Triangle& triangle : body.triangles) {
                planes.push_back(triangle.*vertex.*coordinate);
            }
        }
    }
    return planes;
}

}  // namespace

struct Gpu::Parts {
    Device device;
    std::string fault;
    Scene scene;
    std::vector<DeviceBody> bodies;
    std::vector<void*> memory;
    cudaStream_t stream = nullptr;
    std::vector<cudaEvent_t> events;                  // between the groups of a queued series
    Counters* counters = nullptr;                     // [kSeriesMax]
    Counters* pinned = nullptr;                       // [kPairsOfLaunchMax]
    Told *told = nullptr, *told_on_device = nullptr;  // likewise pinned; the device writes it
    std::uint32_t sequence = 0;                       // of the last launch that signals the host
    bool overlaps = false;                            // Launch's
    GroupPair* list = nullptr;
    LeftPair* left = nullptr;
    std::vector<std::uint8_t*> carried;  // a pair of bodies

    bool is_good(cudaError_t error, const char* what) {
        if (error != cudaSuccess && fault.empty()) {
            fault = std::string(what) + ": " + cudaGetErrorString(error);
        }
        return error == cudaSuccess;
    }
    template <class T>
    bool take(T*& out, std::size_t count) {
        void* room = nullptr;
        if (!is_good(cudaMalloc(&room, std::max<std::size_t>(1, count) * sizeof(T)),
                     "device memory")) {
            return false;
        }
        memory.push_back(room);
        out = static_cast<T*>(room);
        return true;
    }
    template <class T>
    bool upload(const T*& out, const std::vector<T>& items) {
        T* room = nullptr;
        if (!take(room, items.size()) ||
            !is_good(
                cudaMemcpy(room, items.data(), items.size() * sizeof(T), cudaMemcpyHostToDevice),
                "copying the scene")) {
            return false;
        }
        out = room;
        return true;
    }

    bool find_device(unsigned multiprocessors);
    bool place_scene();
    bool start_series(std::size_t queries);
    bool launch_paper(const Techniques& techniques, unsigned blocks, const PairPose& query,
                      Counters* counts);
    bool launch_certified(std::span<const PairPose> queries, Counters* counts, bool signals_host);
    bool finish_each(const Counters* from, std::span<Found> found);
    bool finish_told(std::span<Found> found);
    bool finish_queued(std::uint32_t together, std::span<Found> found, std::span<double> us);
    template <class Launch, class Finish>
    bool run_each(std::uint32_t together, std::span<Found> found, std::span<double> us,
                  const Launch& launch, const Finish& finish);
    template <class Launch>
    bool run_queued(std::uint32_t together, std::span<Found> found, std::span<double> us,
                    const Launch& launch);
    template <class Launch, class Finish>
    bool run(Timing timing, std::uint32_t together, std::span<Found> found, std::span<double> us,
             const Launch& launch, const Finish& finish);
};

bool Gpu::Parts::find_device(unsigned multiprocessors) {
    cudaDeviceProp properties{};
    if (!is_good(cudaSetDeviceFlags(cudaDeviceScheduleSpin | cudaDeviceMapHost),
                 "no CUDA device") ||
        !is_good(cudaSetDevice(0), "no CUDA device") ||
        !is_good(cudaGetDeviceProperties(&properties, 0), "device properties") ||
        !is_good(cudaDriverGetVersion(&device.driver), "driver version") ||
        !is_good(cudaRuntimeGetVersion(&device.runtime), "runtime version")) {
        return false;
    }
    device.name = properties.name;
    device.multiprocessors = static_cast<unsigned>(properties.multiProcessorCount);
    cuda::Partition partition;
    if (!cuda::make_partition(multiprocessors, partition, fault)) {
        return false;
    }
    device.multiprocessors_used = partition.multiprocessors;
    stream = partition.stream;
    overlaps = properties.major >= cuda::kOverlapsSince;
    return true;
}

bool Gpu::Parts::place_scene() {
    for (const Body& body : scene.bodies) {
        DeviceBody& to = bodies.emplace_back();
        to.triangle_count = static_cast<std::uint32_t>(body.triangles.size());
        to.box_count = static_cast<std::uint32_t>(body.boxes.size());
        to.tile_count = static_cast<std::uint32_t>(body.tiles.size());
        to.whole = body.whole;
        if (!upload(to.triangles, body.triangles) || !upload(to.boxes, body.boxes) ||
            !upload(to.tiles, body.tiles) || !upload(to.planes, planes_of(body))) {
            return false;
        }
    }
    std::size_t groups = 0, pairs = 0;
    for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
        const BodyPair& pair = scene.pairs[i];
        groups =
            std::max(groups, scene.bodies[pair.a].boxes.size() * scene.bodies[pair.b].boxes.size());
        pairs += scene.triangle_pairs(i);
        if (!take(carried.emplace_back(), scene.triangle_pairs(i))) {
            return false;
        }
    }
    // Each list has its greatest possible length: none overflows.
    void *host = nullptr, *mapped = nullptr, *seen = nullptr;
    if (!take(list, groups) || !take(left, pairs) || !take(counters, kSeriesMax) ||
        !is_good(cudaHostAlloc(&host, kPairsOfLaunchMax * sizeof(Counters), cudaHostAllocDefault),
                 "pinned memory") ||
        !is_good(cudaHostAlloc(&mapped, sizeof(Told), cudaHostAllocMapped), "pinned memory") ||
        !is_good(cudaHostGetDevicePointer(&seen, mapped, 0), "mapped memory")) {
        return false;
    }
    pinned = static_cast<Counters*>(host);
    told = new (mapped) Told{};
    told_on_device = static_cast<Told*>(seen);
    events.resize(kSeriesMax + 1);
    for (cudaEvent_t& event : events) {
        if (!is_good(cudaEventCreate(&event), "an event")) {
            return false;
        }
    }
    return true;
}

bool Gpu::Parts::start_series(std::size_t queries) {
    AXG_ASSERT(queries <= kSeriesMax);
    bool good = is_good(cudaMemsetAsync(counters, 0, queries * sizeof(Counters), stream),
                        "zeroing the counts");
    for (std::size_t i = 0; i < carried.size(); ++i) {
        good =
            good && is_good(cudaMemsetAsync(carried[i], kNoAxis, scene.triangle_pairs(i), stream),
                            "zeroing the axes");
    }
    return good && is_good(cudaStreamSynchronize(stream), "starting a series");
}

bool Gpu::Parts::launch_paper(const Techniques& techniques, unsigned blocks, const PairPose& query,
                              Counters* counts) {
    const BodyPair& pair = scene.pairs[query.pair];
    TestArguments test{};
    test.a = bodies[pair.a], test.b = bodies[pair.b];
    test.a_in_b = rounded(query.pose), test.b_in_a = rounded(inverse(query.pose));
    test.carried = carried[query.pair];
    test.counters = counts;
    unsigned groups = test.a.tile_count * test.b.tile_count;
    if (techniques.boxes) {
        if (!is_good(launch_open_boxes({test.a, test.b, test.a_in_b, list, counts}, stream),
                     "boxes")) {
            return false;
        }
        test.list = list;
        groups = test.a.box_count * test.b.box_count;
    }
    // The paper launches one block per pair of groups. With a list (the host does not read its
    // length) or with prefetched groups, each block loops over several pairs instead.
    const bool goes_round = techniques.boxes || techniques.prefetch;
    const unsigned grid = goes_round ? std::min(groups, blocks) : groups;
    return is_good(launch_test_pairs(techniques, test, grid, stream), "test");
}

bool Gpu::Parts::launch_certified(std::span<const PairPose> queries, Counters* counts,
                                  bool signals_host) {
    ProveArguments prove{};
    prove.count = static_cast<std::uint32_t>(queries.size());
    for (std::uint32_t i = 0; i < prove.count; ++i) {
        const BodyPair& pair = scene.pairs[queries[i].pair];
        prove.a[i] = bodies[pair.a], prove.b[i] = bodies[pair.b];
        prove.pose[i] = certified_pose(queries[i].pose, scene.bodies[pair.a].reach_mm,
                                       scene.bodies[pair.b].reach_mm);
        prove.first_item[i] = prove.items;
        prove.items += prove_items(prove.a[i], prove.b[i]);
    }
    prove.left = left;
    prove.counters = counts;
    prove.told = signals_host ? told_on_device : nullptr;
    prove.sequence = signals_host ? ++sequence : 0;
    // In a queued series no kernel may begin early, because events between kernels measure time.
    return is_good(launch_prove_pairs(prove, stream), "certified, every pair") &&
           is_good(launch_prove_left(
                       prove, {stream, device.multiprocessors_used, signals_host && overlaps}),
                   "certified, what is left");
}

bool Gpu::Parts::finish_each(const Counters* from, std::span<Found> found) {
    if (!is_good(cudaMemcpyAsync(pinned, from, found.size() * sizeof(Counters),
                                 cudaMemcpyDeviceToHost, stream),
                 "copying the counts") ||
        !is_good(cudaStreamSynchronize(stream), "a question")) {
        return false;
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
        found[i] = {pinned[i].touching, pinned[i].tested, pinned[i].left};
    }
    return true;
}

/// Waits for the counts that the device itself writes to the host's memory.
bool Gpu::Parts::finish_told(std::span<Found> found) {
    const std::atomic_ref<std::uint32_t> written(told->sequence);
    const Clock::time_point start = Clock::now();
    while (written.load(std::memory_order_acquire) != sequence) {
        if (us_since(start) > kLateUs) {
            return is_good(cudaStreamSynchronize(stream), "a question") &&
                   is_good(cudaErrorTimeout, "a question");
        }
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
        found[i] = {told->counts[i].touching, told->counts[i].tested, told->counts[i].left};
    }
    return true;
}

bool Gpu::Parts::finish_queued(std::uint32_t together, std::span<Found> found,
                               std::span<double> us) {
    std::vector<Counters> counts(found.size());
    if (!is_good(cudaStreamSynchronize(stream), "a series") ||
        !is_good(cudaMemcpy(counts.data(), counters, counts.size() * sizeof(Counters),
                            cudaMemcpyDeviceToHost),
                 "copying the counts")) {
        return false;
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
        found[i] = {counts[i].touching, counts[i].tested, counts[i].left};
    }
    for (std::size_t i = 0; i < found.size(); i += together) {
        float ms = 0;
        if (!is_good(cudaEventElapsedTime(&ms, events[i], events[i + together]), "an event")) {
            return false;
        }
        us[i] = 1e3 * double(ms);
    }
    return true;
}

/// Launches every group of `together` queries in turn and waits for its counts.
/// @param finish  (counts, found): waits for the counts of a group and copies them
template <class Launch, class Finish>
bool Gpu::Parts::run_each(std::uint32_t together, std::span<Found> found, std::span<double> us,
                          const Launch& launch, const Finish& finish) {
    for (std::size_t i = 0; i < found.size(); i += together) {
        const Clock::time_point start = Clock::now();
        if (!launch(i, counters + i) || !finish(counters + i, found.subspan(i, together))) {
            return false;
        }
        us[i] = us_since(start);
    }
    return true;
}

/// Runs the whole series as one graph, so that the device never waits for the host.
template <class Launch>
bool Gpu::Parts::run_queued(std::uint32_t together, std::span<Found> found, std::span<double> us,
                            const Launch& launch) {
    const auto note = [this](std::size_t i) {
        return is_good(cudaEventRecordWithFlags(events[i], stream, cudaEventRecordExternal),
                       "an event");
    };
    if (!is_good(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal), "recording")) {
        return false;
    }
    bool good = note(0);
    for (std::size_t i = 0; good && i < found.size(); i += together) {
        good = launch(i, counters + i) && note(i + together);
    }
    cudaGraph_t graph = nullptr;
    cudaGraphExec_t exec = nullptr;
    good = is_good(cudaStreamEndCapture(stream, &graph), "recording") && good &&
           is_good(cudaGraphInstantiate(&exec, graph, 0), "the series' graph") &&
           is_good(cudaGraphLaunch(exec, stream), "the series' graph") &&
           finish_queued(together, found, us);
    if (exec != nullptr) {
        static_cast<void>(cudaGraphExecDestroy(exec));
    }
    if (graph != nullptr) {
        static_cast<void>(cudaGraphDestroy(graph));
    }
    return good;
}

/// @param launch  (i, counts): launches the queries from i on that are timed as one
template <class Launch, class Finish>
bool Gpu::Parts::run(Timing timing, std::uint32_t together, std::span<Found> found,
                     std::span<double> us, const Launch& launch, const Finish& finish) {
    AXG_ASSERT(found.size() == us.size() && found.size() % together == 0);
    std::fill(us.begin(), us.end(), 0.0);
    return start_series(found.size()) &&
           (timing == Timing::each ? run_each(together, found, us, launch, finish)
                                   : run_queued(together, found, us, launch));
}

Gpu::Gpu(std::unique_ptr<Parts> parts) noexcept : parts_(std::move(parts)) {}
Gpu::Gpu(Gpu&&) noexcept = default;

Gpu::~Gpu() {
    if (parts_ == nullptr) {
        return;
    }
    for (void* const room : parts_->memory) {
        static_cast<void>(cudaFree(room));
    }
    for (const cudaEvent_t event : parts_->events) {
        if (event != nullptr) {
            static_cast<void>(cudaEventDestroy(event));
        }
    }
    static_cast<void>(cudaFreeHost(parts_->pinned));
    static_cast<void>(cudaFreeHost(parts_->told));
    if (parts_->stream != nullptr) {
        static_cast<void>(cudaStreamDestroy(parts_->stream));
    }
}

std::optional<Gpu> Gpu::create(const Scene& scene, unsigned multiprocessors, std::string& fault) {
    Gpu gpu(std::make_unique<Parts>());
    Parts& parts = *gpu.parts_;
    parts.scene = scene;
    if (scene.pairs.empty() || scene.pairs.size() > kPairsOfLaunchMax) {
        fault = "got " + std::to_string(scene.pairs.size()) + " pairs of bodies, wanted 1 to " +
                std::to_string(kPairsOfLaunchMax);
        return std::nullopt;
    }
    if (!parts.find_device(multiprocessors) || !parts.place_scene()) {
        fault = parts.fault;
        return std::nullopt;
    }
    return gpu;
}

bool Gpu::run_paper(const Techniques& techniques, Timing timing, std::uint32_t together,
                    std::span<const PairPose> queries, std::span<Found> found,
                    std::span<double> us) {
    AXG_ASSERT(together >= 1 && together <= kPairsOfLaunchMax);
    const unsigned blocks = blocks_of_test(techniques) * parts_->device.multiprocessors_used;
    if (blocks == 0) {
        parts_->fault = "this choice of techniques is not compiled";
        return false;
    }
    const auto launch = [&](std::size_t i, Counters* counts) {
        for (std::uint32_t k = 0; k < together; ++k) {
            if (!parts_->launch_paper(techniques, blocks, queries[i + k], counts + k)) {
                return false;
            }
        }
        return true;
    };
    return parts_->run(timing, together, found, us, launch,
                       [&](const Counters* counts, std::span<Found> of) {
                           return parts_->finish_each(counts, of);
                       });
}

bool Gpu::run_certified(Timing timing, std::uint32_t together, std::span<const PairPose> queries,
                        std::span<Found> found, std::span<double> us) {
    AXG_ASSERT(together >= 1 && together <= kPairsOfLaunchMax);
    const auto launch = [&](std::size_t i, Counters* counts) {
        return parts_->launch_certified(queries.subspan(i, together), counts,
                                        timing == Timing::each);
    };
    const bool good =
        parts_->run(timing, together, found, us, launch,
                    [&](const Counters*, std::span<Found> of) { return parts_->finish_told(of); });
    for (std::size_t i = 0; i < found.size(); ++i) {
        found[i].tested = static_cast<std::uint32_t>(parts_->scene.triangle_pairs(queries[i].pair));
    }
    return good;
}

const Device& Gpu::device() const noexcept {
    return parts_->device;
}
const std::string& Gpu::fault() const noexcept {
    return parts_->fault;
}

std::vector<KernelFacts> Gpu::kernels() const {
    return {facts_of_open(), facts_of_test(kNoTechnique), facts_of_test(kAllTechniques),
            facts_of_prove(), facts_of_left()};
}

KernelFacts facts_of(const void* kernel, std::string name) {
    cudaFuncAttributes found{};
    if (cudaFuncGetAttributes(&found, kernel) != cudaSuccess) {
        return {std::move(name) + " (does not load)"};
    }
    return {std::move(name), found.numRegs, found.sharedSizeBytes, found.localSizeBytes};
}

}  // namespace axg::paper
