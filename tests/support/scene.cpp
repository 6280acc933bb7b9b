// SPDX-License-Identifier: Apache-2.0
#include "tests/support/scene.hpp"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>

namespace axg::test {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kHeaderBytes = 80, kFacetBytes = 50;

void write_stl_file(const std::vector<Triangle>& triangles, const fs::path& file) {
    std::string bytes(kHeaderBytes, ' ');
    const auto count = static_cast<std::uint32_t>(triangles.size());
    bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
    for (const Triangle& t : triangles) {
        const float facet[12] = {0,     0,     0,     t.a.x, t.a.y, t.a.z,
                                 t.b.x, t.b.y, t.b.z, t.c.x, t.c.y, t.c.z};
        bytes.append(reinterpret_cast<const char*>(facet), sizeof facet);
        bytes.append(2, '\0');
    }
    std::ofstream stream(file, std::ios::binary);
    stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!stream.flush()) {
        throw std::runtime_error(file.string() + ": cannot write");
    }
}

std::vector<Triangle> read_stl_file(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    std::uint32_t count = 0;
    if (bytes.size() >= kHeaderBytes + 4) {
        std::memcpy(&count, bytes.data() + kHeaderBytes, sizeof count);
    }
    if (count == 0 || bytes.size() != kHeaderBytes + 4 + kFacetBytes * count) {
        throw std::runtime_error(file.string() + ": wanted a binary STL with triangles");
    }
    std::vector<Triangle> triangles(count);
    for (std::size_t i = 0; i < count; ++i) {
        float v[9];
        std::memcpy(v, bytes.data() + kHeaderBytes + 4 + kFacetBytes * i + 12, sizeof v);
        triangles[i] = {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}};
    }
    return triangles;
}

/// The rows of a table below its head, each cut at its commas.
std::vector<std::vector<std::string>> read_table(const fs::path& file, const std::string& head) {
    std::ifstream stream(file);
    std::string line;
    if (!std::getline(stream, line) || line.rfind(head, 0) != 0) {
        throw std::runtime_error(file.string() + ":1: got '" + line + "', wanted '" + head + "'");
    }
    std::vector<std::vector<std::string>> rows;
    while (std::getline(stream, line)) {
        std::vector<std::string> row{""};
        for (const char c : line) {
            if (c == ',') {
                row.emplace_back();
            } else if (c != '\r') {
                row.back() += c;
            }
        }
        rows.push_back(row);
    }
    return rows;
}

template <class Number>
Number number(const std::string& text, const fs::path& file, std::size_t row) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0') {
        throw std::runtime_error(file.string() + ":" + std::to_string(row + 2) + ": got '" + text +
                                 "', wanted a number");
    }
    return static_cast<Number>(value);
}

}  // namespace

void write_scene(const Scene& scene, const std::string& folder) {
    const fs::path root{folder};
    fs::create_directories(root);
    std::ofstream bodies(root / "bodies.csv");
    bodies << "name,stl,triangles\n";
    for (const Mesh& body : scene.bodies) {
        bodies << body.name << ',' << body.name << ".stl," << body.triangles.size() << '\n';
        write_stl_file(body.triangles, root / (body.name + ".stl"));
    }
    std::ofstream pairs(root / "pairs.csv");
    pairs << "pair,a,b\n";
    for (const ScenePair& pair : scene.pairs) {
        pairs << pair.name << ',' << scene.bodies[pair.a].name << ',' << scene.bodies[pair.b].name
              << '\n';
    }
    std::ofstream poses(root / "poses.csv");
    poses << "pose,body";
    for (int i = 0; i < 16; ++i) {
        poses << ",m" << i / 4 << i % 4;
    }
    poses << '\n';
    char text[32];
    for (std::uint32_t pose = 0; pose < scene.pose_count; ++pose) {
        for (std::uint32_t body = 0; body < scene.bodies.size(); ++body) {
            poses << pose << ',' << scene.bodies[body].name;
            const Pose& p = scene.at(pose, body);
            for (int row = 0; row < 3; ++row) {
                for (int column = 0; column < 4; ++column) {
                    const double m = column < 3 ? p.r[row][column] : p.t[row];
                    std::snprintf(text, sizeof text, "%.17g", m);
                    poses << ',' << text;
                }
            }
            poses << ",0,0,0,1\n";
        }
    }
    if (!bodies.flush() || !pairs.flush() || !poses.flush()) {
        throw std::runtime_error(folder + ": cannot write the tables");
    }
}

Scene read_scene(const std::string& folder) {
    const fs::path root{folder};
    Scene scene;
    std::map<std::string, std::uint32_t> index;
    for (const auto& row : read_table(root / "bodies.csv", "name,stl,triangles")) {
        index[row.at(0)] = static_cast<std::uint32_t>(scene.bodies.size());
        scene.bodies.push_back({row.at(0), read_stl_file(root / row.at(1))});
    }
    for (const auto& row : read_table(root / "pairs.csv", "pair,a,b")) {
        scene.pairs.push_back({row.at(0), index.at(row.at(1)), index.at(row.at(2))});
    }
    const fs::path file = root / "poses.csv";
    const auto rows = read_table(file, "pose,body,m00");
    scene.pose_count = static_cast<std::uint32_t>(rows.size() / scene.bodies.size());
    scene.placed.resize(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto pose = number<std::uint32_t>(rows[i].at(0), file, i);
        Pose& p = scene.placed.at(pose * scene.bodies.size() + index.at(rows[i].at(1)));
        for (std::size_t k = 0; k < 12; ++k) {
            const auto m = number<double>(rows[i].at(2 + k), file, i);
            (k % 4 < 3 ? p.r[k / 4][k % 4] : p.t[k / 4]) = m;
        }
    }
    return scene;
}

std::vector<QueryAnswer> read_answers(const std::string& file) {
    std::vector<QueryAnswer> answers;
    const auto rows = read_table(file, "pose,pair,hit,count,clearance_mm");
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto& row = rows[i];
        QueryAnswer answer;
        answer.pose = number<std::uint32_t>(row.at(0), file, i);
        answer.pair = row.at(1);
        answer.hit = row.at(2).empty() ? -1 : number<int>(row.at(2), file, i);
        answer.count = row.at(3).empty() ? -1 : number<long>(row.at(3), file, i);
        answer.clearance_mm = row.at(4).empty() ? -1 : number<double>(row.at(4), file, i);
        answers.push_back(answer);
    }
    return answers;
}

}  // namespace axg::test
