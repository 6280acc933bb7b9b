// SPDX-License-Identifier: Apache-2.0
// The board of `axguard drive --bus` with approaches in place of a program. Every approach goes for
// a pose in which the machine touches itself; where the axes truly were is judged by CGAL
// afterwards.
//   live_board MACHINE MESH_ROOT BUS SEED
// A line on stdin begins an approach; when the axes rest, a line of JSON on stdout says what came
// of it. Ends with stdin.
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include "config/machine/effective_text.hpp"
#include "firmware_if/system/live_socket.hpp"
#include "hil_replay/board/approach_driver.hpp"
#include "hil_replay/board/socket_clock.hpp"
#include "hil_replay/drive/bus_drive.hpp"
#include "tests/oracle/contact_scene.hpp"
#include "tests/support/json_value.hpp"

namespace axg::test {
namespace {

constexpr std::int64_t kWatchUs = 250, kLongestUs = 10'000'000;
constexpr double kWatchedMm = 8;
constexpr double kClearMm = 30;  // at the start: room for a permit of ten periods

struct Seen {
    std::int64_t time_us;
    Positions position;
};

/// A start that is clear of everything, and a pose beyond contact to make for.
struct Way {
    Positions start{}, target{};
};
Way draw_way(Random& random, ContactScene& scene) {
    Way way;
    Judgement judged;
    do {
        way.target = random_pose(random, scene.machine());
    } while (!scene.judge.judge(scene.of(way.target), 1).touches);
    do {
        way.start = random_pose(random, scene.machine());
        judged = scene.judge.judge(scene.of(way.start), kClearMm);
    } while (judged.touches || judged.clear_mm < kClearMm);
    return way;
}

/// Judges wherever the axes may be too near; in between no point can have moved that far.
Json judge(ContactScene& scene, const std::vector<Seen>& seen) {
    Judgement last;
    const Positions* at = nullptr;
    bool touches = false, too_near = false;
    for (const Seen& one : seen) {
        double moved_mm = 0;
        for (std::size_t i = 0; at != nullptr && i < scene.machine().axes.size(); ++i) {
            const bool is_rotary = scene.machine().axes[i].kind == AxisKind::rotary;
            moved_mm +=
                std::abs(one.position[i] - (*at)[i]) * (is_rotary ? scene.judge.reach_mm() : 1.0);
        }
        if (at != nullptr && moved_mm < last.clear_mm) {
            continue;
        }
        at = &one.position;
        last = scene.judge.judge(scene.of(one.position), kWatchedMm);
        touches = touches || last.touches;
        too_near = too_near || last.too_near;
    }
    return Json::object({{"touches", touches}, {"too_near", too_near}});
}

Json approach(Random& random, ContactScene& scene, SocketCan& wire) {
    const Machine& machine = scene.machine();
    const Way way = draw_way(random, scene);
    Approach wanted;
    wanted.target = way.target;
    for (double& share : wanted.speed_share) {
        share = random() % 2 == 0 ? 1 : between(random, 0.1, 1);
    }
    BusDriveOptions options{.board = promised_live_board(machine, random())};
    options.board.hashes = configuration_hashes(machine, scene.loaded.meshes);
    std::vector<Seen> seen;
    std::atomic<bool> is_ended{false};
    const std::int64_t ends_us = monotonic_us() + kLongestUs;
    BusDriveObservers observers{
        .each = [&](const MotionBoard&) { is_ended.store(monotonic_us() > ends_us); },
        .watch =
            [&seen](std::int64_t time_us, const MotionBoard& board) {
                Seen one{.time_us = time_us, .position = {}};
                for (std::size_t i = 0; i < board.axes().size(); ++i) {
                    one.position[i] = board.axes()[i].position;
                }
                seen.push_back(one);
            },
        .watch_us = kWatchUs};
    const BusDriveResult result =
        drive_on_bus(machine, wire, socket_clock(wire), scene.of(way.start),
                     make_approach(machine, wanted), options, is_ended, observers);
    const DriveResult& drive = result.drive;
    if (drive.encoded.status != EncodeStatus::ok || result.wire.other_board_id != 0) {
        return Json::object(
            {{"fault", "the positions do not fit the frames, or another board is there"}});
    }
    Json out = judge(scene, seen);
    out.set("state", to_text(drive.state));
    out.set("why", to_text(drive.board_stop.why));
    out.set("moved", drive.moving_since_us != INT64_MIN);
    out.set("samples", drive.samples);
    out.set("permits", drive.permits);
    out.set("judged", seen.size());
    out.set("late_us_max", result.wire.late_us_max);
    out.set("sends_failed", result.wire.frames_refused);
    return out;
}

int run(const std::string& file, const std::string& root, const std::string& bus,
        std::uint64_t seed) {
    LoadedMachine loaded;
    if (!load(file, root, loaded, stderr)) {
        return 3;
    }
    ContactScene scene(std::move(loaded));
    std::string fault;
    std::optional<SocketCan> wire = open_live_socket(scene.machine(), bus, 0, fault);
    if (!wire) {
        std::fprintf(stderr, "%s\n", fault.c_str());
        return 12;
    }
    Random random(seed);
    for (std::string line; std::getline(std::cin, line);) {
        std::cout << approach(random, scene, *wire).dump() << std::endl;
    }
    return 0;
}

}  // namespace
}  // namespace axg::test

int main(int count, char** words) {
    if (count != 5) {
        std::fprintf(stderr, "usage: live_board MACHINE MESH_ROOT BUS SEED\n");
        return 2;
    }
    return axg::test::run(words[1], words[2], words[3], std::strtoull(words[4], nullptr, 10));
}
