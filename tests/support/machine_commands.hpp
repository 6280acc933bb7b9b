// SPDX-License-Identifier: Apache-2.0
// axguard check and axguard init, driven as a person would, in a folder of meshes.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh/stl.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "hil_replay/commands/commands.hpp"

namespace axg::test {

struct Outcome {
    int exit_code;
    std::string out, err;
};

inline Outcome axguard(std::vector<std::string> words) {
    CommandLine line({.name = "axguard", .purpose = "", .version = ""});
    add_check(line);
    add_init(line);
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int exit_code = line.parse(std::move(words));
    std::fflush(stdout);
    std::fflush(stderr);
    std::string out = testing::internal::GetCapturedStdout();
    return {exit_code, std::move(out), testing::internal::GetCapturedStderr()};
}

inline bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

inline std::string read(const std::string& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// A closed tetrahedron of one unit.
inline std::vector<Triangle> tetrahedron() {
    const Vec3f o{0, 0, 0};
    const Vec3f x{1, 0, 0};
    const Vec3f y{0, 1, 0};
    const Vec3f z{0, 0, 1};
    return {{o, y, x}, {o, x, z}, {o, z, y}, {x, y, z}};
}

class Commands : public testing::Test {
  protected:
    void SetUp() override { std::filesystem::create_directories(folder_ / "meshes"); }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    void write_mesh(const std::string& name,
                    std::vector<Triangle> triangles = tetrahedron()) const {
        const std::vector<std::byte> bytes = write_stl(triangles);
        std::ofstream file(path("meshes/" + name), std::ios::binary);
        file.write(reinterpret_cast<const char*>(bytes.data()),
                   static_cast<std::streamsize>(bytes.size()));
    }
    void write_meshes() const {
        for (const char* name : {"base.stl", "saddle.STL", "table.stl", "a_axis.stl", "c.stl",
                                 "headstock.stl", "cutter.stl", "lamp (left).stl"}) {
            write_mesh(name);
        }
    }

  private:
    std::filesystem::path folder_ =
        std::filesystem::path(testing::TempDir()) / ("axg_commands_" + std::to_string(getpid()));
};

}  // namespace axg::test
