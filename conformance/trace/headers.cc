#include "conformance/trace/headers.h"

#include <algorithm>
#include <utility>

#include "conformance/trace/protocol.h"

namespace rubric::trace {
namespace {

// Returns how many channels of a direction the case has a node create, those included that are
// refused or enlarged.
std::int64_t channels_created(const Case& one, std::string_view node, std::string_view call) {
  const std::vector<const Line*> lines = one.lines();
  return std::count_if(lines.begin(), lines.end(), [&](const Line* line) {
    return line->op == Op::kGiven && line->node == node && line->message.name == call;
  });
}

// Returns how many motes join in the case, those included that a sink refuses.
std::int64_t motes_joined(const Case& one) {
  std::vector<const Value*> sources;
  for (const Line* const line : one.lines()) {
    const bool sent = line->op == Op::kGiven || line->op == Op::kEmits;
    const Value* const source = line->message.find("src");
    if (!sent || line->message.name != "ack_join" || !source) continue;
    const bool known = std::any_of(sources.begin(), sources.end(),
                                   [&](const Value* other) { return *other == *source; });
    if (!known) sources.push_back(source);
  }
  return static_cast<std::int64_t>(sources.size());
}

Contradiction contradiction(const StatedRange& wanted, const Stated& stated) {
  if (wanted.id != stated.id) return {};
  if (wanted.least <= stated.value && stated.value <= wanted.most) return {};
  const std::string text = statement_text({stated});
  return {"the case is for " + range_text(wanted) + ", and " + text + " is stated", text};
}

// Returns a number of ticks which the case does not outlast.
std::int64_t longest(const Case& one, const Statement& statement) {
  constexpr std::int64_t kUnstated = 1500;  // The most of any parameter that is not stated.
  const std::int64_t most = parameter(ParameterId::kGoneAfter).max;
  std::int64_t out = 0;
  for (const Line* const line : one.lines()) {
    std::int64_t ticks = std::clamp<std::int64_t>(line->time.to, 0, most);
    for (const Term& term : line->time.to_terms) {
      const std::int64_t* const value = find(statement, term.parameter);
      const std::int64_t factor = std::clamp<std::int64_t>(term.factor, 0, most);
      ticks = std::min(most, ticks + factor * (value ? std::min(*value, most) : kUnstated));
    }
    out = std::min(most, out + ticks);
  }
  return out;
}

// Returns what one node contradicts.
Contradiction contradiction(const Case& one, const NodeHeader& node, const Stated& stated,
                            const Statement& statement) {
  if (const std::int64_t* const said = find(node.stated, stated.id)) {
    return contradiction({stated.id, *said, *said}, stated);
  }
  if (!protocol().has_machine) return {};
  std::int64_t needed = 0;
  if (stated.id == ParameterId::kChannels) {
    needed = std::max(channels_created(one, node.name, "create_out"),
                      channels_created(one, node.name, "create_in"));
  } else if (stated.id == ParameterId::kMembers && node.role == Role::kSink) {
    needed = motes_joined(one);
  } else if (stated.id == ParameterId::kGoneAfter && node.role != Role::kMote) {
    needed = longest(one, statement);  // Its motes stay, however silent they are.
  }
  const std::int64_t most = parameter(stated.id).max;
  return contradiction({stated.id, std::min(needed, most), most}, stated);  // Or to be refused.
}

}  // namespace

Contradiction state(File& file, Case& one, const Statement& statement) {
  Contradiction wrong;
  for (const std::vector<Item>* items : {&file.head, &one.items}) {
    for (const Item& item : *items) {
      const auto* const header = item.as<Header>();
      const auto* const wanted = header ? std::get_if<ForHeader>(&header->what) : nullptr;
      if (!wanted) continue;
      for (const StatedRange& range : wanted->values) {
        for (const Stated& each : statement) {
          if (wrong.text.empty()) wrong = contradiction(range, each);
        }
      }
    }
  }
  for (Item& item : states<NodeHeader>(one.items) ? one.items : file.head) {
    auto* const header = item.as<Header>();
    auto* const node = header ? std::get_if<NodeHeader>(&header->what) : nullptr;
    if (!node || !node->iut) continue;
    for (const Stated& each : statement) {
      if (wrong.text.empty()) wrong = contradiction(one, *node, each, statement);
    }
    node->stated = joined(std::move(node->stated), statement);
    if (protocol().has_machine && node->role == Role::kBaseStation) {  // It has no channels.
      std::erase_if(node->stated, [](const Stated& s) { return s.id == ParameterId::kChannels; });
    }
  }
  return wrong;
}

}  // namespace rubric::trace
