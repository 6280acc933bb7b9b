// SPDX-License-Identifier: Apache-2.0
// A pair of triangles in hexadecimal floats, as a failing test prints it: to be pasted into a test
// of its own.
#pragma once

#include <cstdio>
#include <string>

#include "hil_replay/lab/cases/pair.hpp"

namespace axg::test {

template <class T>
std::string in_hexadecimal(const lab::Pair<T>& p) {
    std::string out;
    for (int i = 0; i < 6; ++i) {
        const Vec3<T>& v = i < 3 ? p.a[i] : p.b[i - 3];
        char text[100];
        std::snprintf(text, sizeof text, "{%a, %a, %a}", double(v.x), double(v.y), double(v.z));
        out += i == 0 ? "{{" : i == 3 ? "}, {" : ", ";
        out += text;
    }
    return out + "}}";
}

}  // namespace axg::test
