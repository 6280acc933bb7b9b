// SPDX-License-Identifier: Apache-2.0
#include "config/text/yaml_tree.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <new>
#include <sstream>
#include <unordered_set>
#include <utility>

#include "config/text/fault_list.hpp"
#include "config/text/quote_text.hpp"
#include "config/text/yaml_text.hpp"

namespace axg {
namespace {

struct StopParsing {};  // thrown through the library's parser, caught in parse_yaml below

constexpr std::size_t kFaultsMax = 1000;
constexpr const char* kPlainTag = "?";
constexpr const char* kQuotedTag = "!";

/// Turns events into the tree. A frame is one open sequence or map.
class TreeBuilder final : public YAML::EventHandler {
  public:
    TreeBuilder(const YamlText& text, FaultList& faults) : text_(text), faults_(faults) {}

    YamlNode root;

    void OnDocumentStart(const YAML::Mark& mark) override {
        if (documents_++ > 0) {
            stop(mark, "a second document", "one document; remove the --- or ... before it");
        }
    }
    void OnDocumentEnd() override {}

    void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        YamlNode node = make(YamlNode::Kind::nothing, mark);
        check_properties(node, mark, kPlainTag, anchor);
        place(std::move(node), mark);
    }
    void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
        report(mark, "an alias (*)", "the value itself; anchors and aliases are not supported");
        place(make(YamlNode::Kind::refused, mark), mark);
    }
    void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  const std::string& value) override {
        YamlNode node = make(YamlNode::Kind::scalar, mark);
        node.text = value;
        node.is_quoted = tag != kPlainTag;
        check_properties(node, mark, tag, anchor);
        place(std::move(node), mark);
    }
    void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value) override {
        open(YamlNode::Kind::sequence, mark, tag, anchor);
    }
    void OnSequenceEnd() override { close(); }
    void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                    YAML::EmitterStyle::value) override {
        open(YamlNode::Kind::map, mark, tag, anchor);
    }
    void OnMapEnd() override { close(); }

  private:
    struct Frame {
        YamlNode node;
        bool has_key = false;
        std::string key;
        int key_line = 0;
        bool key_refused = false;
        std::unordered_set<std::string> seen;
    };

    YamlNode make(YamlNode::Kind kind, const YAML::Mark& mark) {
        if (++node_count_ > kYamlNodesMax) {
            stop(mark, "more than " + std::to_string(kYamlNodesMax) + " values",
                 "at most that many in one machine file");
        }
        YamlNode node;
        node.kind = kind;
        node.line = mark.line + 1;
        return node;
    }

    /// Reports tags and anchors, and marks their node as refused.
    void check_properties(YamlNode& node, const YAML::Mark& mark, const std::string& tag,
                          YAML::anchor_t anchor) {
        // The library reports "!" as the tag of every quoted text: only the source shows whether a
        // "!" was written.
        const bool tagged = (tag != kPlainTag && tag != kQuotedTag && !tag.empty()) ||
                            text_.at(mark.line, mark.column) == '!';
        if (tagged) {
            report(mark, "a tag " + quoted(tag), "a plain value; tags are not supported");
            node.kind = YamlNode::Kind::refused;
        }
        if (anchor != 0) {
            report(mark, "an anchor (&)", "a plain value; anchors and aliases are not supported");
            node.kind = YamlNode::Kind::refused;
        }
    }

    void open(YamlNode::Kind kind, const YAML::Mark& mark, const std::string& tag,
              YAML::anchor_t anchor) {
        if (frames_.size() >= static_cast<std::size_t>(kYamlDepthMax)) {
            stop(mark, "lists or maps nested deeper than " + std::to_string(kYamlDepthMax),
                 "at most " + std::to_string(kYamlDepthMax) + " levels");
        }
        Frame frame;
        frame.node = make(kind, mark);
        YamlNode verdict = frame.node;
        check_properties(verdict, mark, tag, anchor);
        frames_.push_back(std::move(frame));
        refused_.push_back(verdict.kind == YamlNode::Kind::refused);
    }

    void close() {
        Frame frame = std::move(frames_.back());
        frames_.pop_back();
        const bool refused = refused_.back();
        refused_.pop_back();
        if (refused) {
            frame.node.kind = YamlNode::Kind::refused;
        }
        const int line = frame.node.line;
        place_at(std::move(frame.node), line);
    }

    void place(YamlNode node, const YAML::Mark& mark) { place_at(std::move(node), mark.line + 1); }

    void place_at(YamlNode node, int line) {
        if (frames_.empty()) {
            root = std::move(node);
            return;
        }
        Frame& parent = frames_.back();
        if (parent.node.kind == YamlNode::Kind::sequence) {
            parent.node.entries.push_back({"", line, std::move(node)});
        } else if (!parent.has_key) {
            take_key(parent, node, line);
        } else {
            parent.has_key = false;
            if (!parent.key_refused) {
                parent.node.entries.push_back(
                    {std::move(parent.key), parent.key_line, std::move(node)});
            }
        }
    }

    void take_key(Frame& frame, const YamlNode& node, int line) {
        frame.has_key = true;
        frame.key = node.text;
        frame.key_line = line;
        frame.key_refused = true;
        if (node.kind == YamlNode::Kind::refused) {
            return;
        }
        if (node.kind != YamlNode::Kind::scalar || node.text.empty()) {
            faults_.add(line, map_path(), "a key that is not a word", "a key of the machine file");
        } else if (frame.key == "<<") {
            faults_.add(line, map_path(), "a merge key (<<)",
                        "the keys themselves; merge keys are not supported");
        } else if (!frame.seen.insert(frame.key).second) {
            faults_.add(line, path() + escaped(frame.key, 64), "the same key twice",
                        "each key once; remove one of the two");
        } else {
            frame.key_refused = false;
        }
    }

    /// The path of the open node, as keys and list positions, with a final dot.
    std::string path() const {
        std::string out;
        for (std::size_t i = 0; i + 1 < frames_.size(); ++i) {
            const Frame& frame = frames_[i];
            if (frame.node.kind == YamlNode::Kind::sequence) {
                if (!out.empty()) {
                    out.pop_back();
                }
                out += '[' + std::to_string(frame.node.entries.size()) + "].";
            } else {
                out += escaped(frame.key, 64) + '.';
            }
        }
        return out;
    }

    /// The map that is open here.
    std::string map_path() const {
        std::string out = path();
        if (!out.empty()) {
            out.pop_back();
        }
        return out;
    }

    void report(const YAML::Mark& mark, std::string got, std::string wanted) {
        faults_.add(mark.line + 1, key_here(), std::move(got), std::move(wanted));
        if (faults_.count() > kFaultsMax) {
            throw StopParsing{};  // a thousand faults are enough
        }
    }

    std::string key_here() const {
        std::string out = path();
        if (!frames_.empty() && frames_.back().node.kind == YamlNode::Kind::map &&
            frames_.back().has_key) {
            return out + escaped(frames_.back().key, 64);
        }
        return map_path();
    }

    [[noreturn]] void stop(const YAML::Mark& mark, std::string got, std::string wanted) {
        report(mark, std::move(got), std::move(wanted));
        throw StopParsing{};
    }

    const YamlText& text_;
    FaultList& faults_;
    std::vector<Frame> frames_;
    std::vector<bool> refused_;
    std::uint32_t node_count_ = 0;
    int documents_ = 0;
};

}  // namespace

bool parse_yaml(const std::string& text, FaultList& faults, YamlNode& root) {
    const YamlText lines{text};
    if (!lines.check(faults)) {
        return false;
    }
    TreeBuilder builder{lines, faults};
    try {
        std::istringstream stream{text};
        YAML::Parser parser{stream};
        if (!parser.HandleNextDocument(builder)) {
            faults.add(1, "", "an empty file",
                       "a machine file; see docs/reference/machine-file.md");
            return false;
        }
        // A second document ends in a fault; a third cannot be reached.
        (void)parser.HandleNextDocument(builder);
    } catch (const StopParsing&) {
        return false;
    } catch (const YAML::Exception& error) {
        faults.add(error.mark.is_null() ? 1 : error.mark.line + 1, "",
                   "invalid YAML (" + escaped(error.msg) + ')',
                   "YAML; check for a truncated file, and for a missing bracket, quote or indent "
                   "here or above");
        return false;
    } catch (const std::bad_alloc&) {
        throw;  // no fault of the file
    } catch (const std::exception& error) {
        faults.add(1, "", "text that the YAML parser rejects (" + escaped(error.what()) + ')',
                   "a machine file; see docs/reference/machine-file.md");
        return false;
    }
    root = std::move(builder.root);
    return true;
}

}  // namespace axg
