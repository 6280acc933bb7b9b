// SPDX-License-Identifier: Apache-2.0
// Any bytes as a model and a certificate, or sound ones changed, with their sums made anew: they
// are judged, and neither leads out of an array. An input is the length of the model (u32), the
// model, and the certificate.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "hil_replay/certcheck/check_certificate.hpp"
#include "hil_replay/certcheck/sha256.hpp"
#include "tests/fuzz/targets.hpp"

namespace {

using axg::certcheck::Digest;
using Bytes = std::vector<std::uint8_t>;

/// Writes the sum of the model into REFS, where a name of five letters precedes it, and that of the
/// sections into DONE, as far as the bytes are a row of sections.
void make_sums(Bytes& bytes, const Digest* model) {
    Digest chain{};
    for (std::size_t at = 0; at + 12 <= bytes.size();) {
        std::uint64_t length = 0;
        std::memcpy(&length, bytes.data() + at + 4, 8);
        if (length > bytes.size() - at - 12) {
            return;
        }
        const auto body = std::span(bytes).subspan(at + 12, length);
        if (std::memcmp(bytes.data() + at, "DONE", 4) == 0) {
            std::copy_n(chain.begin(), std::min(body.size(), chain.size()), body.begin());
            return;
        }
        if (model != nullptr && std::memcmp(bytes.data() + at, "REFS", 4) == 0 && length >= 43) {
            std::ranges::copy(*model, body.begin() + 11);
        }
        axg::certcheck::Sha256 sum;
        sum.add(chain);
        sum.add(std::span(bytes).subspan(at, 12 + length));
        chain = sum.finish();
        at += 12 + length;
    }
}

}  // namespace

int axg::fuzz::certcheck(const std::uint8_t* data, std::size_t size) {
    std::uint32_t length = 0;
    if (size < 4) {
        return 0;
    }
    std::memcpy(&length, data, 4);
    length = static_cast<std::uint32_t>(std::min<std::size_t>(length, size - 4));
    Bytes model(data + 4, data + 4 + length);
    Bytes certificate(data + 4 + length, data + size);
    make_sums(model, nullptr);
    const Digest sum = axg::certcheck::sha256(model);
    make_sums(certificate, &sum);
    const auto outcome = axg::certcheck::check_certificate({"m", model}, {"c", certificate}, {});
    const bool is_known =
        outcome.exit_code == 0 || outcome.exit_code == 10 || outcome.exit_code == 12;
    if (!is_known || outcome.text.empty()) {
        std::abort();
    }
    return 0;
}
