// SPDX-License-Identifier: Apache-2.0
// The exact cases of the folder tritri beside the project's data: files taken apart, answers read.
// Format: README of that folder. A file that ends too early throws std::runtime_error.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/base/pose.hpp"
#include "core/mesh/mesh.hpp"

namespace axg::test {

inline const std::string kTritriFolder = std::string(AXG_SHARED_DATA) + "/tritri/";

struct TritriExpected {
    char answer = '?';  // 0 apart, 1 intersecting, R to be refused
    double distance_mm = 0;
};
using TritriAnswers = std::map<std::uint32_t, TritriExpected>;

inline TritriAnswers read_tritri_answers(const std::string& file) {
    TritriAnswers out;
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    while (std::getline(in, line)) {
        std::istringstream cells(line);
        std::string id, category, answer, distance;
        std::getline(cells, id, ',');
        std::getline(cells, category, ',');
        std::getline(cells, answer, ',');
        std::getline(cells, distance, ',');
        out[static_cast<std::uint32_t>(std::stoul(id))] = {
            answer.at(0), distance.empty() ? 0 : std::strtod(distance.c_str(), nullptr)};
    }
    return out;
}

/// A file taken apart from the front.
class Bytes {
  public:
    explicit Bytes(const std::string& file) {
        std::ifstream in(file, std::ios::binary);
        bytes_.assign(std::istreambuf_iterator<char>(in), {});
    }
    template <class T>
    T take() {
        T out{};
        if (at_ + sizeof(T) > bytes_.size()) {
            throw std::runtime_error("the file is too short");
        }
        std::memcpy(&out, &bytes_[at_], sizeof(T));
        at_ += sizeof(T);
        return out;
    }
    [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }

  private:
    std::vector<char> bytes_;
    std::size_t at_ = 0;
};

inline Pose take_pose(Bytes& bytes) {
    Pose pose;
    for (auto& row : pose.r) {
        for (double& x : row) {
            x = bytes.take<double>();
        }
    }
    for (double& x : pose.t) {
        x = bytes.take<double>();
    }
    return pose;
}

inline Triangle take_triangle(Bytes& bytes) {
    const auto vertex = [&bytes] {
        Vec3f v;
        v.x = bytes.take<float>();
        v.y = bytes.take<float>();
        v.z = bytes.take<float>();
        return v;
    };
    Triangle t;
    t.a = vertex();
    t.b = vertex();
    t.c = vertex();
    return t;
}

}  // namespace axg::test
