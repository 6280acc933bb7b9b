// SPDX-License-Identifier: Apache-2.0
// axguard-certcheck: an independent judge of certificates. It shares no code with what writes them.
#include <fstream>
#include <iostream>
#include <iterator>
#include <new>
#include <vector>

#include "hil_replay/certcheck/check_certificate.hpp"

namespace {

constexpr const char* kHelp =
    "Example:\n  axguard-certcheck vice-mill.model part.cert\n\n"
    "Check a certificate of a whole program, without axguard\n"
    "Usage: axguard-certcheck [OPTIONS] MODEL CERT\n\n"
    "Positionals:\n"
    "  MODEL TEXT REQUIRED         model of the machine (M.model)\n"
    "  CERT TEXT REQUIRED          certificate (P.cert)\n\n"
    "Options:\n"
    "  -h,--help                   print this help and exit\n"
    "  --version                   print the version and exit\n"
    "  --positions TEXT            look positions up in the tube: a CSV file whose head names "
    "every "
    "axis, mm and degrees\n";

bool read_file(const std::string& name, std::vector<std::uint8_t>& bytes) {
    std::ifstream file(name, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(file), {});
    return file.good() || file.eof();
}

int run(const std::vector<std::string>& words) {
    std::vector<std::string> names;
    std::string positions;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (words[i] == "-h" || words[i] == "--help") {
            std::cout << kHelp;
            return 0;
        }
        if (words[i] == "--version") {
            std::cout << "axguard-certcheck " AXG_VERSION "\n";
            return 0;
        }
        if (words[i] == "--positions" && i + 1 < words.size()) {
            positions = words[++i];
        } else if (words[i].starts_with("--positions=")) {
            positions = words[i].substr(12);
        } else if (words[i].starts_with("-")) {
            std::cerr << words[i] << ": no such option, or no value for it. See --help.\n";
            return 2;
        } else {
            names.push_back(words[i]);
        }
    }
    if (names.size() != 2) {
        std::cerr << "axguard-certcheck: expected MODEL and CERT. See --help.\n";
        return 2;
    }
    names.push_back(positions);
    std::vector<std::uint8_t> bytes[3];
    for (std::size_t i = 0; i < 3; ++i) {
        if (!names[i].empty() && !read_file(names[i], bytes[i])) {
            std::cerr << names[i] << ": cannot be read. Check the path.\n";
            return 12;
        }
    }
    const auto outcome = axg::certcheck::check_certificate(
        {names[0], bytes[0]}, {names[1], bytes[1]}, {names[2], bytes[2]});
    (outcome.exit_code == 0 ? std::cout : std::cerr) << outcome.text;
    return outcome.exit_code;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run({argv + (argc > 0 ? 1 : 0), argv + argc});
    } catch (const std::exception& error) {
        std::cerr << "axguard-certcheck: " << error.what() << ". Nothing is proven.\n";
        return 1;
    }
}
