// Finds the nodes and links that apply to the lines of a case.
#pragma once

#include <optional>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

#include "conformance/trace/trace.h"

namespace rubric::trace {

/// The nodes and links that apply to a case, by name: a file may have as many as it has lines.
class Ends {
 public:
  Ends(const File& file, const Case& one) : scope_(scope_of(file, one)) {
    for (const NodeHeader& node : scope_.nodes) nodes_.emplace(node.name, &node);
    for (const LinkHeader& link : scope_.links) {
      const auto [at, fresh] = links_.emplace(link.name, On{&link, {}});
      if (fresh) at->second.nodes.insert(link.nodes.begin(), link.nodes.end());
    }
  }
  Ends(const Ends&) = delete;  // Its tables are of its own names.
  Ends& operator=(const Ends&) = delete;

  const NodeHeader* node(std::string_view name) const {
    const auto found = nodes_.find(name);
    return found == nodes_.end() ? nullptr : found->second;
  }
  /// Returns what Scope::link does.
  std::optional<LinkKind> link(std::string_view name) const {
    static const Scope unstated;
    const auto found = links_.find(name);
    return found == links_.end() ? unstated.link(name) : found->second.header->kind;
  }
  /// Returns whether a link has a node, which it has if it names none.
  bool is_on(std::string_view node, std::string_view link) const {
    const auto found = links_.find(link);
    return found == links_.end() || found->second.nodes.empty() ||
           found->second.nodes.contains(node);
  }

 private:
  struct On {
    const LinkHeader* header;
    std::unordered_set<std::string_view> nodes;
  };
  Scope scope_;
  std::unordered_map<std::string_view, const NodeHeader*> nodes_;
  std::unordered_map<std::string_view, On> links_;
};

}  // namespace rubric::trace
