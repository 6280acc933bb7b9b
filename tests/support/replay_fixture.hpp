// SPDX-License-Identifier: Apache-2.0
// The paper's machine with its surfaces, traces simulated for it in a temporary folder, and the
// program's commands run in a process of their own.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "firmware_if/setup/guard_engine.hpp"
#include "hil_replay/replay/replay_run.hpp"
#include "hil_replay/trace/candump_log.hpp"

namespace axg::test {

inline std::string source_file(const std::string& name) {
    return std::string(AXG_SOURCE_DIR) + "/" + name;
}
inline const std::string kPaperMachine = source_file("config/machines/paper-trunnion.yaml");
inline const std::string kDemoProgram = source_file("hil_replay/programs/paper-trunnion-demo.ngc");
inline const std::string kCleanProgram =
    source_file("hil_replay/programs/paper-trunnion-clean.ngc");

inline std::string content_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

/// A folder of its own, gone afterwards; the program is run in it.
class Workshop {
  public:
    Workshop() {
        std::string name = testing::TempDir() + "/axg_XXXXXX";
        folder_ = mkdtemp(name.data()) != nullptr ? name : std::string();
    }
    ~Workshop() { std::filesystem::remove_all(folder_); }
    Workshop(const Workshop&) = delete;
    Workshop& operator=(const Workshop&) = delete;

    [[nodiscard]] std::string file(const std::string& name) const { return folder_ + "/" + name; }

    [[nodiscard]] std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(file(name), std::ios::binary) << text;
        return file(name);
    }

    /// Exit code; what it said is in `out` and `err`.
    int run(const std::string& arguments) {
        const std::string word = arguments.substr(0, arguments.find(' '));
        const bool is_lab =
            word == "query" || word == "accuracy" || word == "bench" || word == "chart";
        return run_program(is_lab ? AXG_LAB_PROGRAM : AXG_PROGRAM, arguments);
    }

    int run_program(const std::string& program, const std::string& arguments) {
        const std::string line = "cd '" + folder_ + "' && '" + program + "' " + arguments + " >'" +
                                 file("out") + "' 2>'" + file("err") + "'";
        const int status = std::system(line.c_str());
        out = content_of(file("out"));
        err = content_of(file("err"));
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }

    std::string out, err;

  private:
    std::string folder_;
};

inline std::vector<CanFrame> read_trace(const std::string& path) {
    std::string error;
    const auto reader = open_trace(path, {}, error);
    std::vector<CanFrame> frames;
    CanFrame frame;
    while (reader != nullptr && reader->next(frame)) {
        frames.push_back(frame);
    }
    EXPECT_TRUE(reader != nullptr && reader->error().empty()) << error;
    return frames;
}

inline std::string log_of(const std::vector<CanFrame>& frames) {
    std::string text;
    for (const CanFrame& frame : frames) {
        append_candump(text, frame, "can0");
    }
    return text;
}

/// The paper's machine with its surfaces; a failed load shows in the test, and as no engine.
inline LoadedMachine load_paper_machine() {
    LoadedMachine loaded;
    EXPECT_TRUE(load(kPaperMachine, "", loaded, stderr));
    return loaded;
}

struct PaperMachine {
    LoadedMachine loaded = load_paper_machine();
    std::optional<CpuEngine> engine = make_engine(loaded);
    std::optional<ContainmentTest> containment_test = make_containment_test(loaded, *engine);
};

}  // namespace axg::test
