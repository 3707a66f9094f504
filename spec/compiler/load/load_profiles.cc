// Loads the profiles: constants, switches and accepted differences.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "spec/compiler/load/load.h"
#include "spec/compiler/load/read_spec.h"
#include "spec/compiler/model.h"

namespace rubricc {
namespace {

constexpr std::int64_t kU8 = 0xFF;
constexpr std::int64_t kU16 = 0xFFFF;
constexpr std::int64_t kDayTicks = 24 * 60 * 60 * 1024;
constexpr std::array kFields{
    ProfileField{"ticks_per_second", 1, kU16, false},
    ProfileField{"join_period_ticks", 1, kU16, false},
    ProfileField{"join_requests_max", 1, kU8, false},
    ProfileField{"join_fail_signalled", 0, 1, true},
    ProfileField{"ack_join_max", 1, kU8, false},
    ProfileField{"listed_ignored", 0, 1, true},
    ProfileField{"short_acks", 0, 1, true},
    ProfileField{"members_max", 1, 20, false},
    ProfileField{"sink_id", 1, kU8, false},
    ProfileField{"ack_timeout_ticks", 0, kU16, false},
    ProfileField{"channels_max", 1, 8, false},
    ProfileField{"synaptic_period_ticks", 1, kU16, false},
    ProfileField{"synaptic_phase_ticks", 0, kU8, false},
    ProfileField{"response_ticks", 1, kU16, false},
    ProfileField{"early_ticks", 0, kU8, false},
    ProfileField{"gone_after_ticks", 0, kDayTicks, false},
};
constexpr std::array<std::string_view, 4> kProfileKeys{"doc", "constants", "switches", "accepted"};

std::vector<std::string_view> names_of(bool switches) {
  std::vector<std::string_view> out;
  for (const ProfileField& field : kFields) {
    if (field.is_switch == switches) out.push_back(field.name);
  }
  return out;
}

class Reader {
 public:
  Reader(const YamlInput& input, const Model& model, Profile& out)
      : input_(input), model_(model), out_(out) {}

  void read(const YAML::Node& root) {
    const YamlMap map(input_, root, "a profile", kProfileKeys);
    if (!map.is_map()) return;
    for (const std::string_view key : kProfileKeys) {
      if (!map.has(key)) {
        input_.error(root, fmt::format("a profile without {}", key),
                     "doc, constants, switches and accepted were expected");
      }
    }
    out_.doc = one_line(map.text("doc").value_or(""));
    if (map.has("doc") && out_.doc.empty()) input_.error(map.find("doc")->value, "doc is empty");
    out_.values.assign(kFields.size(), 0);
    if (const YamlEntry* entry = map.find("constants")) read_values(entry->value, false);
    if (const YamlEntry* entry = map.find("switches")) read_values(entry->value, true);
    if (const YamlEntry* entry = map.find("accepted")) read_accepted(entry->value);
  }

 private:
  void read_values(const YAML::Node& node, bool switches) {
    const auto names = names_of(switches);
    const YamlMap map(input_, node, switches ? "switches" : "constants", names);
    if (!map.is_map()) return;
    for (std::size_t i = 0; i < kFields.size(); ++i) {
      const ProfileField& field = kFields[i];
      if (field.is_switch != switches) continue;
      if (!map.has(field.name)) {
        input_.error(node, fmt::format("{} is missing", quote(field.name)),
                     "every profile says what each of them is");
      } else if (switches) {
        out_.values[i] = map.boolean(field.name).value_or(false) ? 1 : 0;
      } else {
        out_.values[i] = constant(map, field);
      }
    }
  }

  std::int64_t constant(const YamlMap& map, const ProfileField& field) const {
    const std::int64_t value = map.integer(field.name).value_or(field.min);
    if (value >= field.min && value <= field.max) return value;
    input_.error(map.find(field.name)->value,
                 fmt::format("{} is {} in a profile", rubricc::quote(field.name), value),
                 fmt::format("it can be {} to {}", field.min, field.max));
    return field.min;
  }

  void read_accepted(const YAML::Node& node) {
    const YamlMap map(input_, node, "accepted", {});
    for (const YamlEntry& entry : map.entries()) {
      const auto rule = std::find_if(model_.requirements.begin(), model_.requirements.end(),
                                     [&](const Requirement& one) { return one.id == entry.key; });
      const std::string text = one_line(map.text(entry.key).value_or("-"));
      if (text.empty()) {
        input_.error(entry.value, "it is not said what is accepted", "a sentence was expected");
      }
      if (rule != model_.requirements.end()) {
        out_.accepted.push_back({entry.key, text});
        continue;
      }
      std::vector<std::string> ids;
      for (const Requirement& one : model_.requirements) ids.push_back(one.id);
      input_.error(entry.key_node, fmt::format("unknown requirement {}", rubricc::quote(entry.key)),
                   suggestion(entry.key, ids));
    }
  }

  const YamlInput& input_;
  const Model& model_;
  Profile& out_;
};

}  // namespace

std::span<const ProfileField> profile_fields() { return kFields; }

void load_profile(const std::string& file, Model& model, Diagnostics& diagnostics) {
  const auto text = text_of_file(file, diagnostics);
  if (text) load_profile_text(file, *text, model, diagnostics);
}

void load_profile_text(const std::string& file, const std::string& text, Model& model,
                       Diagnostics& diagnostics) {
  diagnostics.add_source(file, text);
  Profile out{.name = std::filesystem::path(file).stem().string(), .file = file};
  check_id(diagnostics, {file, 1, 1}, out.name, "profile");
  const auto root = parse_yaml(file, text, diagnostics);
  if (!root) return;
  int budget = kNodeBudget;
  const YamlInput input{file, diagnostics, budget};
  Reader(input, model, out).read(*root);
  model.profiles.push_back(std::move(out));
}

void load_profiles(const std::string& folder, Model& model, Diagnostics& diagnostics) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path().generic_string());
  }
  std::sort(files.begin(), files.end());
  for (const std::string& file : files) load_profile(file, model, diagnostics);
}

}  // namespace rubricc
