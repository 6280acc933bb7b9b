// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certcheck/sections.hpp"

#include <algorithm>

namespace axg::certcheck {

// More than all pairs of 32 bodies with 64 tools.
constexpr std::size_t kSectionsMax = 1U << 16;

Sections::Sections(const std::string& file, std::span<const std::uint8_t> bytes) : file_(file) {
    ByteReader all(file, bytes, 0);
    Digest sum{};
    std::string letters;
    while (letters != "DONE") {
        const auto head = all.take(12);
        letters.clear();
        for (const std::uint8_t byte : head.first(4)) {
            all.require(byte >= 'A' && byte <= 'Z', "four letters of a section expected");
            letters += static_cast<char>(byte);
        }
        std::uint64_t length = 0;
        std::memcpy(&length, head.data() + 4, 8);
        const std::string name = file + ": " + letters;
        const std::size_t offset = bytes.size() - all.left();
        const auto body = all.take(length);
        all.require(sections_.size() < kSectionsMax, "too many sections");
        sections_.push_back({letters, ByteReader(name, body, offset)});
        if (letters == "DONE") {
            all.require(length == sum.size(), "DONE has 32 bytes");
            if (!std::ranges::equal(body, sum)) {
                throw Refusal{10, name + ", byte " + std::to_string(offset) +
                                      ": the sum does not fit the sections before. A byte of the "
                                      "file was changed; write it again."};
            }
        }
        Sha256 chain;
        chain.add(sum);
        chain.add(head);
        chain.add(body);
        sum = chain.finish();
    }
    all.require(all.left() == 0, "bytes follow DONE");
}

ByteReader Sections::open(const std::string& letters) {
    // DONE is the last one and is opened last, so there is a next one.
    Section& section = sections_[next_];
    section.reader.require(section.letters == letters, ("expected " + letters).c_str());
    next_ += next_ + 1 < sections_.size() ? 1 : 0;
    return section.reader;
}

}  // namespace axg::certcheck
