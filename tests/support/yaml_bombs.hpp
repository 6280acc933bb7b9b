// SPDX-License-Identifier: Apache-2.0
// Texts of a mebibyte that are meant to cost a YAML reader far more than their size.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "config/text/yaml_tree.hpp"

namespace axg::test {

struct YamlBomb {
    const char* name;
    std::function<std::string()> text;
};

/// `start`, then `again` as often as a mebibyte takes.
inline std::string repeated(const std::string& start, const std::string& again) {
    std::string text = start;
    while (text.size() + again.size() <= kYamlSizeBytesMax) {
        text += again;
    }
    return text;
}

inline std::vector<YamlBomb> yaml_bombs() {
    const auto bomb = [](const char* name, std::string start, std::string again) {
        return YamlBomb{name, [start, again] { return repeated(start, again); }};
    };
    std::vector<YamlBomb> all{
        bomb("open lists", "", "["),
        bomb("open maps", "", "{"),
        bomb("nested block lists", "", "- "),
        bomb("nested keys", "", "? "),
        bomb("nested empty keys", "", ": "),
        bomb("a list of one line", "[", "a,"),
        bomb("a list without values", "[", ","),
        bomb("lists in a list", "[", "[],"),
        bomb("maps in a list", "[", "{a: b},"),
        bomb("pairs in a list", "[", "a: b,"),
        bomb("one key again and again", "", "k: 1\n"),
        bomb("quoted keys", "{", "\"a\": b,"),
        bomb("anchors", "[", "&a b,"),
        bomb("aliases", "[&a b,", "*a,"),
        bomb("tags", "[", "!t a,"),
        bomb("documents", "", "---\n"),
        bomb("a comment", "", "#"),
        bomb("comments", "", "#\n"),
        bomb("blank lines in a text", "a: b", "\n"),
        bomb("words", "a: ", "x "),
        bomb("a quoted text without end", "a: \"", "x"),
        bomb("lines of a quoted text", "a: \"", "\n"),
        bomb("escapes", "a: \"", "\\n"),
        bomb("a block text", "a: |\n", " x\n"),
        bomb("a folded text", "a: >\n", " x\n\n"),
        bomb("a long key", "", "x"),
        bomb("colons", "", ":"),
        bomb("exclamation marks", "", "!"),
        bomb("ampersands", "", "&"),
        bomb("blanks", "", " "),
        bomb("tabs", "", "\t"),
    };
    all.push_back({"a million laughs", [] {
                       std::string text = "a0: &a0 [x,x,x,x,x,x,x,x,x]\n";
                       for (int i = 1; i < 12; ++i) {
                           std::string last = "*a";
                           last += std::to_string(i - 1);
                           text.append("a").append(std::to_string(i)).append(": &a");
                           text.append(std::to_string(i)).append(" [").append(last);
                           for (int j = 0; j < 8; ++j) {
                               text.append(",").append(last);
                           }
                           text += "]\n";
                       }
                       return text;
                   }});
    all.push_back({"a stair of keys", [] {
                       std::string text;
                       for (std::size_t i = 0; text.size() + i + 3 < kYamlSizeBytesMax; ++i) {
                           text.append(i, ' ').append("a:\n");
                       }
                       return text;
                   }});
    all.push_back({"keys without end", [] {
                       std::string text;
                       for (int i = 0; text.size() + 16 < kYamlSizeBytesMax; ++i) {
                           text.append("k").append(std::to_string(i)).append(": 1\n");
                       }
                       return text;
                   }});
    all.push_back({"bodies without end",
                   [] { return repeated("version: 1\nname: a\nbodies:\n", "- {name: a}\n"); }});
    all.push_back({"pairs without end", [] {
                       return repeated("version: 1\nname: a\nbodies: [{name: a}]\npairs:\n",
                                       "- {a: b, b: c}\n");
                   }});
    return all;
}

}  // namespace axg::test
