// SPDX-License-Identifier: Apache-2.0
// What most sources read, compiled once a build where AXG_PRECOMPILED is on. A source includes what
// it uses all the same: a build without the option would not compile otherwise.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
