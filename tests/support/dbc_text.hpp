// SPDX-License-Identifier: Apache-2.0
// A board described by a DBC file, and a machine file that takes its axes from it.
#pragma once

#include <string>
#include <string_view>

#include "tests/support/machine_text.hpp"

namespace axg::test {

/// Line 1 is empty of meaning on purpose: line numbers in faults are counted, not guessed.
inline constexpr const char* kBoardDbc = R"(VERSION "1.0"

NS_ :
    CM_
    BA_
    SIG_VALTYPE_

BS_:

BU_: Board Guard

BO_ 385 Linear: 8 Board
 SG_ X : 0|32@1- (0.0001,0) [-300|300] "mm" Guard
 SG_ Count : 32|4@1+ (1,0) [0|14] "" Guard
 SG_ State : 40|8@1+ (1,0) [0|0] "" Guard
 SG_ Tool : 55|8@0+ (1,0) [0|0] "" Guard
 SG_ Homed : 56|1@1+ (1,0) [0|1] "" Guard,Board

BO_ 386 Tilt: 8 Board
 SG_ A : 7|32@0- (1,0) [0|0] "rad" Vector__XXX
 SG_ C : 39|32@0+ (8.38190317154E-8,0) [0|360] "" Vector__XXX

BO_ 400 Pages: 8 Board
 SG_ Page M : 0|8@1+ (1,0) [0|0] "" Guard
 SG_ P0 m0 : 8|32@1- (0.001,0) [0|0] "mm" Guard
 SG_ P1 m1 : 8|32@1- (0.001,0) [0|0] "deg" Guard
 SG_ Deep m2M : 8|8@1+ (1,0) [0|0] "mm" Guard

BO_ 2147483777 Extended: 8 Board
 SG_ E : 0|32@1- (0.001,0) [0|0] "mm" Guard

CM_ SG_ 385 X "Position; as the encoder
measures it";
VAL_ 385 State 0 "rest" 1 "moves" 2 "tool change" ;
SIG_VALTYPE_ 386 A : 1;
SG_MUL_VAL_ 400 P0 Page 0-0;
SG_MUL_VAL_ 400 P1 Page 1 - 1;
SG_MUL_VAL_ 400 Deep Page 2-2;
)";

/// The small machine, its frames from kBoardDbc.
inline std::string dbc_machine() {
    const std::string text = kSmallMachine;
    return text.substr(0, text.find("  format: classical")) + R"(  format: dbc
  file: board.dbc
  axes:
    X: Linear.X
    A: Tilt.A
    C: {signal: Tilt.C, unit: deg}
  status:
    tool: Linear.Tool
    moving: {signal: Linear.State, is: 1}
    tool_change: {signal: Linear.State, is: 2}
    homed: Linear.Homed
  counters: [Linear.Count]
)" + text.substr(text.find("capacities"));
}

/// All faults of a machine file whose DBC, EDS or DCF file has this text.
inline std::string faults_with_file(const std::string& text, const std::string& file,
                                    Machine& out) {
    const NamedFiles files = [&file](const std::string& name, std::size_t) {
        return name.starts_with("no") ? NamedFile{{}, "nothing", "a file"}
                                      : NamedFile{file, {}, {}};
    };
    std::string all;
    for (const ConfigFault& fault : parse_machine(text, "m", out, files)) {
        all += to_string(fault) + '\n';
    }
    return all;
}

inline std::string faults_with_file(const std::string& text, const std::string& file) {
    Machine machine;
    return faults_with_file(text, file, machine);
}

}  // namespace axg::test
