// SPDX-License-Identifier: Apache-2.0
// The command as people and scripts meet it: exit codes, messages, files, JSON. Runs the program
// itself.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "firmware_if/cli/exit_codes.hpp"
#include "hil_replay/certify/certificate_file.hpp"
#include "hil_replay/certify/section_file.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

class CertifyCommand : public testing::Test {
  protected:
    int run(const std::string& arguments) { return shop.run("certify " + arguments); }
    [[nodiscard]] bool exists(const std::string& name) const {
        return std::filesystem::exists(shop.file(name));
    }

    test::Workshop shop;
    const std::string machine = test::kPaperMachine + " ";
    const std::string programs = test::source_file("hil_replay/programs/");
    const std::string &out = shop.out, &err = shop.err;
};

TEST_F(CertifyCommand, WritesACertificateAndItsModel) {
    const std::string clean = programs + "paper-trunnion-clean.ngc";
    ASSERT_EQ(run(machine + clean + " --rapid-cap on -o p.cert --json=p.json"), kExitClean) << err;
    EXPECT_EQ(err, "");
    EXPECT_NE(out.find("certified: "), std::string::npos) << out;
    const auto read = read_certificate(test::content_of(shop.file("p.cert")));
    ASSERT_TRUE(read);
    EXPECT_FALSE(read->is_partial);
    ASSERT_EQ(read->sources.size(), 4U);
    EXPECT_EQ(read->sources[0].second,
              sha256_of(test::content_of(shop.file("paper-trunnion.model"))));
    EXPECT_EQ(read->sources[2].second, sha256_of(test::content_of(clean)));
    const std::string json = test::content_of(shop.file("p.json"));
    EXPECT_NE(json.find("\"certified\": true"), std::string::npos) << json;
    EXPECT_NE(json.find("\"open\": []"), std::string::npos) << json;
    const std::string again = "certify " + machine + clean + " --rapid-cap on -o q.cert";
    ASSERT_EQ(shop.run(again + " --model q --threads 1"), kExitClean) << err;
    EXPECT_EQ(test::content_of(shop.file("p.cert")), test::content_of(shop.file("q.cert")));
    EXPECT_EQ(test::content_of(shop.file("paper-trunnion.model")),
              test::content_of(shop.file("q")));
}

TEST_F(CertifyCommand, NamesTheLinesThatAreNotClearAndWritesNothing) {
    const std::string demo = programs + "paper-trunnion-demo.ngc";
    EXPECT_EQ(run(machine + demo + " -o p.cert"), kExitCollision);
    EXPECT_NE(out.find("NOT certified"), std::string::npos) << out;
    EXPECT_NE(out.find("demo.ngc:703: cutter (tool 1) and c: too near on the path itself"),
              std::string::npos)
        << out;
    EXPECT_NE(out.find("at X 0.000 Y"), std::string::npos) << out;
    EXPECT_FALSE(exists("p.cert"));
    EXPECT_FALSE(exists("paper-trunnion.model"));
    EXPECT_EQ(run(machine + demo + " -o p.cert --partial"), kExitCollision);
    EXPECT_NE(out.find("with holes, about which it claims nothing"), std::string::npos) << out;
    const auto read = read_certificate(test::content_of(shop.file("p.cert")));
    ASSERT_TRUE(read);
    EXPECT_TRUE(read->is_partial);
}

TEST_F(CertifyCommand, NamesTheSubroutineFilesThatItRead) {
    std::filesystem::create_directory(shop.file("subs"));
    (void)shop.write("main.ngc", "G21 G90 G94 F600\nO<pocket> CALL\nM2\n");
    const auto sum_with = [&](const std::string& move) {
        (void)shop.write("subs/pocket.ngc", "O<pocket> SUB\n" + move + "\nO<pocket> ENDSUB\nM2\n");
        EXPECT_EQ(run(machine + "main.ngc --sub subs -o p.cert"), kExitClean) << out << err;
        const auto read = read_certificate(test::content_of(shop.file("p.cert")));
        return read ? hex_of(read->sources[3].second) : std::string();
    };
    const std::string first = sum_with("G1 X1");
    EXPECT_NE(first, sum_with("G1 X2"));
    EXPECT_EQ(first, sum_with("G1 X1"));
}

// A lower feed rounds a corner along another path, which the certificate has not got.
TEST_F(CertifyCommand, CoversNoLowerOverrideWhereCornersAreRounded) {
    const std::string start = "G21 G90 G94 F600\n";
    const std::string exact = shop.write("exact.ngc", start + "G1 X1\nM2\n");
    const std::string rounded = shop.write("round.ngc", start + "G64 P1\nG1 X1\nG1 Y1\nM2\n");
    EXPECT_EQ(run(machine + exact + " -o p.cert"), kExitClean) << out << err;
    EXPECT_EQ(out.find("no lower one"), std::string::npos) << out;
    EXPECT_EQ(run(machine + rounded + " -o p.cert"), kExitClean) << out << err;
    EXPECT_NE(out.find("for an override of 100 % alone, no lower one"), std::string::npos) << out;
    EXPECT_EQ(run(machine + exact + " -o p.cert --blend-mm 1"), kExitClean) << out << err;
    EXPECT_NE(out.find("no lower one"), std::string::npos) << out;
}

TEST_F(CertifyCommand, CutsNoFeed) {
    const std::string fast = shop.write("fast.ngc", "G21 G90 G94 F20000\nG1 X1\nM2\n");
    EXPECT_EQ(run(machine + fast + " -o p.cert --rapid-cap on"), kExitInput);
    EXPECT_NE(err.find("fast.ngc:2: feed 20000"), std::string::npos) << err;
    EXPECT_FALSE(exists("p.cert"));
}

TEST_F(CertifyCommand, LosesNoFileToTheDefaultNameOfTheModel) {
    const std::string exact = shop.write("exact.ngc", "G21 G90 G94 F600\nG1 X1\nM2\n");
    const std::string as_model =
        shop.write("paper-trunnion.model", "G21 G90 G94 F600\nG1 X1\nM2\n");
    EXPECT_EQ(run(machine + exact + " -o paper-trunnion.model"), kExitUsage);
    EXPECT_EQ(run(machine + as_model + " -o p.cert"), kExitUsage);
    EXPECT_EQ(run(machine + exact + " -o p.cert --json=paper-trunnion.model"), kExitUsage);
    EXPECT_NE(err.find("Name another with --model"), std::string::npos) << err;
    EXPECT_EQ(test::content_of(as_model), "G21 G90 G94 F600\nG1 X1\nM2\n");
}

TEST_F(CertifyCommand, RefusesWhatItCannotRead) {
    const std::string unread = shop.write("part.ngc", "G21 G90\nG1 X1\n");
    EXPECT_EQ(run(machine + unread + " -o p.cert"), kExitInput);
    EXPECT_NE(err.find("nothing certified"), std::string::npos) << err;
    const std::string still = shop.write("still.ngc", "G21 G90\nM2\n");
    EXPECT_EQ(run(machine + still + " -o p.cert"), kExitInput);
    EXPECT_NE(err.find("there is nothing to certify"), std::string::npos) << err;
    EXPECT_EQ(run(machine + still), kExitUsage);
    EXPECT_FALSE(exists("p.cert"));
}

}  // namespace
}  // namespace axg
