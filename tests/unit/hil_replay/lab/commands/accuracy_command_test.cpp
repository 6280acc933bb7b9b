// SPDX-License-Identifier: Apache-2.0
// axguard-lab accuracy and its reader: files made here, whole, cut at every byte, and lying about
// their counts; the table, and what is said of a wrong word.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "firmware_if/cli/exit_codes.hpp"
#include "hil_replay/lab/cases/tritri_file.hpp"
#include "hil_replay/lab/commands/axguard_lab.hpp"
#include "hil_replay/lab/methods/mesh_cases.hpp"

namespace axg::lab {
namespace {

namespace fs = std::filesystem;

template <class T>
void put(std::string& bytes, T value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class T>
void put_all(std::string& bytes, std::initializer_list<double> values) {
    for (const double value : values) {
        put(bytes, static_cast<T>(value));
    }
}

void put_pose(std::string& bytes, double up_mm) {
    put_all<double>(bytes, {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, up_mm});
}

/// The head of a file of pairs.
std::string pairs_head(std::uint32_t scalar_bytes, std::uint32_t posed, std::uint32_t count) {
    std::string bytes = "TTP1";
    put(bytes, scalar_bytes);
    put(bytes, posed);
    put(bytes, count);
    return bytes;
}

/// One pair crossing, one apart, one that holds a NaN.
template <class T>
std::string pairs_file(bool posed) {
    std::string bytes = pairs_head(sizeof(T), posed ? 1 : 0, 3);
    for (std::uint32_t i = 0; i < 3; ++i) {
        put(bytes, 70 + i);
        const double up = posed ? 0 : (i == 1 ? 9 : 0);
        put_all<T>(bytes, {0, 0, 0, 8, 0, 0, 0, 8, 0});
        put_all<T>(bytes, {2, 2, up - 3, 3, 2, up + 5, 2, 3, i == 2 ? std::nan("") : up + 4});
        if (posed) {
            put_pose(bytes, i == 1 ? 9 : 0);
        }
    }
    return bytes;
}

std::string meshes_file() {
    std::string bytes = "TTM1";
    put<std::uint32_t>(bytes, 2);
    for (std::uint32_t mesh = 0; mesh < 2; ++mesh) {
        put<std::uint32_t>(bytes, 2);
        std::string name = mesh == 0 ? "low" : "high";
        name.resize(32);
        bytes += name;
        for (const double side : {0, 20}) {
            put_all<float>(bytes, {side, 0, 0, side + 8, 0, 0, side, 8, 0});
        }
    }
    put<std::uint32_t>(bytes, 2);
    for (const double up : {2.5, 0.0}) {
        put<std::uint32_t>(bytes, up > 0 ? 300 : 301);
        put<std::uint32_t>(bytes, 0);
        put<std::uint32_t>(bytes, 1);
        put_pose(bytes, up);
    }
    return bytes;
}

std::string fault_of(const std::string& bytes) {
    TritriFile file;
    return parse_tritri(bytes, file);
}

TEST(TritriFile, HoldsWhatWasWritten) {
    for (const bool posed : {false, true}) {
        TritriFile f32, f64;
        ASSERT_EQ(parse_tritri(pairs_file<float>(posed), f32), "");
        ASSERT_EQ(parse_tritri(pairs_file<double>(posed), f64), "");
        EXPECT_EQ(f32.ids, (std::vector<std::uint32_t>{70, 71, 72}));
        EXPECT_EQ(f64.ids, f32.ids);
        EXPECT_EQ(f32.pairs.poses.size(), posed ? 3U : 0U);
        EXPECT_EQ(f32.pairs.f64[1].b[2], (Vec3d{2, 3, 13}));
        EXPECT_EQ(f64.pairs.f64[1].b[2], (Vec3d{2, 3, 13}));
        EXPECT_EQ(f64.pairs.f32[0].a[1], (Vec3f{8, 0, 0}));
        EXPECT_EQ(f32.pairs.fitness[2], Fitness::rejected);
    }
    TritriFile meshes;
    ASSERT_EQ(parse_tritri(meshes_file(), meshes), "");
    ASSERT_TRUE(meshes.holds_meshes());
    EXPECT_EQ(meshes.meshes[1].name, "high");
    EXPECT_EQ(meshes.meshes[1].triangles[1].b, (Vec3f{28, 0, 0}));
    EXPECT_EQ(meshes.mesh_cases[0].pose.t[2], 2.5);
    EXPECT_EQ(meshes.mesh_cases[0].b, 1U);
}

TEST(TritriFile, CutAtAnyByteIsRefusedWithAnOffset) {
    for (const std::string& whole :
         {pairs_file<float>(false), pairs_file<double>(true), meshes_file()}) {
        for (std::size_t length = 0; length < whole.size(); ++length) {
            const std::string fault = fault_of(whole.substr(0, length));
            ASSERT_NE(fault, "") << length;
            EXPECT_LE(std::stoul(fault), length);
            EXPECT_NE(fault.find(", expected "), std::string::npos) << fault;
        }
        EXPECT_NE(fault_of(whole + '\0'), "");
    }
}

TEST(TritriFile, CountsThatLieAreRefusedBeforeAnythingIsReserved) {
    EXPECT_EQ(fault_of(pairs_head(4, 0, 0xffffffffU)),
              "12: invalid file (found 4294967295 cases of 76 bytes and 0 bytes behind, expected "
              "326417514420 bytes to the end of the file).");
    EXPECT_EQ(fault_of(pairs_head(2, 0, 1)),
              "4: invalid file (found 2 bytes of a scalar, expected 4 (float) or 8 (double)).");
    EXPECT_EQ(fault_of(pairs_head(8, 2, 1)),
              "8: invalid file (found a pose flag of 2, expected 0 or 1).");
    EXPECT_EQ(fault_of("TTQ1"),
              "0: invalid file (found \"TTQ1\", expected 'TTP1' (pairs) or 'TTM1' (meshes)).");
    std::string many = "TTM1";
    put(many, 0xffffffffU);
    EXPECT_NE(fault_of(many), "");
    std::string large = meshes_file();
    put(large, 0U);
    const std::uint32_t absurd = 0xffffffffU;
    std::memcpy(&large[8], &absurd, sizeof absurd);  // triangles of the first mesh
    EXPECT_NE(fault_of(large), "");
    std::string lost = meshes_file();
    const std::size_t first_case = lost.size() - 2 * (12 + 12 * sizeof(double));
    const std::uint32_t two = 2;
    std::memcpy(&lost[first_case + 8], &two, sizeof two);  // b of the first case
    EXPECT_EQ(fault_of(lost), std::to_string(first_case + 8) +
                                  ": invalid file (found mesh 2, expected one of 0 to 1).");
}

struct Outcome {
    int exit_code;
    std::string out, err;
};

Outcome accuracy(const std::vector<std::string>& options) {
    std::vector<std::string> words{"accuracy"};
    words.insert(words.end(), options.begin(), options.end());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int exit_code = run_axguard_lab(words);
    std::fflush(stdout);
    std::string out = testing::internal::GetCapturedStdout();
    return {exit_code, std::move(out), testing::internal::GetCapturedStderr()};
}

class AccuracyCommand : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("axg_accuracy_" + std::to_string(getpid()));
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    [[nodiscard]] std::string path(const std::string& name) const { return folder_ / name; }
    void write(const std::string& name, const std::string& bytes) const {
        std::ofstream(path(name), std::ios::binary) << bytes;
    }
    [[nodiscard]] std::string read(const std::string& name) const {
        std::ifstream in(path(name), std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    [[nodiscard]] Outcome judge(const std::string& method) const {
        return accuracy({"--cases", path("c.bin"), "--method", method, "--output", path("r.csv")});
    }

  private:
    fs::path folder_;
};

TEST_F(AccuracyCommand, WritesOneLineACase) {
    for (const bool posed : {false, true}) {
        write("c.bin", posed ? pairs_file<float>(posed) : pairs_file<double>(posed));
        EXPECT_EQ(judge("sat17-f32").exit_code, kExitClean);
        EXPECT_EQ(read("r.csv"), "70,1\n71,0\n72,R\n");
        EXPECT_EQ(judge("sat17-f64").exit_code, kExitClean);
        EXPECT_EQ(read("r.csv"), "70,1\n71,0\n72,R\n");
        const Outcome certified = judge("certified-f32+f64");
        EXPECT_EQ(certified.exit_code, kExitClean) << certified.err;
        EXPECT_NE(certified.out.find("1 separated, 0 intersecting, 1 undecided, 1 rejected"),
                  std::string::npos);
        const std::string table = read("r.csv");
        ASSERT_EQ(table.rfind("70,2,0\n71,0,", 0), 0U) << table;
        EXPECT_NEAR(std::stod(table.substr(12)), 6, 1e-12);
        EXPECT_LE(std::stod(table.substr(12)), 6);
    }
}

TEST_F(AccuracyCommand, JudgesMeshesByTheirTriangles) {
    write("c.bin", meshes_file());
    EXPECT_EQ(judge("sat17-f64").exit_code, kExitClean);
    EXPECT_EQ(read("r.csv"), "300,0\n301,1\n");
    EXPECT_EQ(judge("certified-f32+f64").exit_code, kExitClean);
    const std::string table = read("r.csv");
    ASSERT_EQ(table.rfind("300,0,", 0), 0U) << table;
    EXPECT_NEAR(std::stod(table.substr(6)), 2.5, 1e-12);
    EXPECT_NE(table.find("\n301,2,0\n"), std::string::npos) << table;
}

TEST_F(AccuracyCommand, FaultsNameThePlaceAndWhatIsWanted) {
    write("c.bin", pairs_file<float>(false).substr(0, 100));
    const Outcome cut = judge("sat17-f32");
    EXPECT_EQ(cut.exit_code, kExitInput);
    EXPECT_EQ(cut.err.rfind(path("c.bin") + ":12: invalid file (found 3 cases", 0), 0U) << cut.err;
    EXPECT_FALSE(fs::exists(path("r.csv")));
    const Outcome unknown = judge("sat71-f32");
    EXPECT_EQ(unknown.exit_code, kExitUsage);
    EXPECT_NE(unknown.err.find("expected one of: certified-shared-f32, "), std::string::npos)
        << unknown.err;
    EXPECT_NE(unknown.err.find("Did you mean sat17-f32?"), std::string::npos) << unknown.err;
    EXPECT_EQ(accuracy({"--cases", path("c.bin")}).exit_code, kExitUsage);
    const Outcome missing =
        accuracy({"--cases", path("no.bin"), "--method", "sat17-f32", "--output", path("r.csv")});
    EXPECT_EQ(missing.exit_code, kExitInput);
    EXPECT_EQ(missing.err, path("no.bin") +
                               ": invalid file (found No such file or directory, expected a file "
                               "that can be opened). Check the name.\n");
}

TEST_F(AccuracyCommand, ListsEveryMethodWithItsSource) {
    const Outcome listed = accuracy({"--list"});
    EXPECT_EQ(listed.exit_code, kExitClean);
    for (const Method& method : methods()) {
        EXPECT_NE(listed.out.find(std::string(method.name) + ' '), std::string::npos);
        EXPECT_NE(listed.out.find(method.source), std::string::npos) << method.name;
    }
}

}  // namespace
}  // namespace axg::lab
