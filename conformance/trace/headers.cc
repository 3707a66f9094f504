#include "conformance/trace/headers.h"

#include <utility>

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

std::string contradiction(const Stated& wanted, const Stated& stated) {
  if (wanted.id != stated.id || wanted.value == stated.value) return {};
  return "the case is for " + statement_text({wanted}) + ", and " + statement_text({stated}) +
         " is stated";
}

// Returns what one node contradicts.
std::string contradiction(const Case& one, const NodeHeader& node, const Stated& stated) {
  if (const std::int64_t* const said = find(node.stated, stated.id)) {
    return contradiction({stated.id, *said}, stated);
  }
  if (stated.id != ParameterId::kChannels) return {};
  const std::int64_t created = std::max(channels_created(one, node.name, "create_out"),
                                        channels_created(one, node.name, "create_in"));
  return created > stated.value ? contradiction({stated.id, created}, stated) : std::string();
}

}  // namespace

std::string state(File& file, Case& one, const Statement& statement) {
  std::string wrong;
  for (const std::vector<Item>* items : {&file.head, &one.items}) {
    for (const Item& item : *items) {
      const auto* const header = std::get_if<Header>(&item);
      const auto* const wanted = header ? std::get_if<ForHeader>(&header->what) : nullptr;
      if (!wanted) continue;
      for (const Stated& each : statement) {
        const std::int64_t* const value = find(wanted->values, each.id);
        if (value && wrong.empty()) wrong = contradiction({each.id, *value}, each);
      }
    }
  }
  for (Item& item : states<NodeHeader>(one.items) ? one.items : file.head) {
    auto* const header = std::get_if<Header>(&item);
    auto* const node = header ? std::get_if<NodeHeader>(&header->what) : nullptr;
    if (!node || !node->iut) continue;
    for (const Stated& each : statement) {
      if (wrong.empty()) wrong = contradiction(one, *node, each);
    }
    node->stated = joined(std::move(node->stated), statement);
    if (node->role == Role::kBaseStation) {  // It has no channels.
      std::erase_if(node->stated, [](const Stated& s) { return s.id == ParameterId::kChannels; });
    }
  }
  return wrong;
}

}  // namespace rubric::trace
