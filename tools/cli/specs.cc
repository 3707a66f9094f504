#include "tools/cli/specs.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <set>
#include <utility>

#include "codec/frame_generator/routes.h"
#include "codec/reflect/combined.h"
#include "codec/reflect/registry.h"
#include "codec/reflect/requirements.h"
#include "codec/reflect/suggest.h"
#include "codec/text/files.h"
#include "codec/text/text.h"
#include "spec/compiler/emit/emit.h"
#include "spec/compiler/emit/tables/built_tables.h"
#include "spec/compiler/load/load.h"
#include "tools/cli/command.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/verdict.h"

namespace rubric::cli {
namespace {

constexpr std::string_view kNone = "none";
constexpr std::string_view kLinkFrames = "ieee802154";
constexpr std::string_view kHeaders = "tinyos";  // With the frame of a serial line.

/// A spec that was read; it is kept until the program ends.
struct ReadSpec {
  rubricc::Model model;
  std::unique_ptr<rubricc::BuiltTables> tables;
  rubricc::BuiltSpec built;
};

std::map<std::string, reflect::CombinedProtocol>& combined_specs() {
  static std::map<std::string, reflect::CombinedProtocol> specs;
  return specs;
}

std::map<std::string, ReadSpec>& read_specs() {
  static std::map<std::string, ReadSpec> specs;
  return specs;
}

void add_requirements(rubricc::Model& model) {
  for (const reflect::Requirement& one : reflect::requirements()) {
    if (*one.id == '\0') continue;
    rubricc::Requirement known;
    known.id = one.id;
    known.level = one.level;
    known.clause = one.clause;
    known.sentence = one.sentence;
    known.source = one.source;
    model.requirements.push_back(std::move(known));
  }
}

void require_sound(rubricc::Model& model, rubricc::Diagnostics& diagnostics) {
  rubricc::check_model(model, diagnostics, rubricc::CheckFor::kRunTime);
  text::print_harmless(stderr, diagnostics.print_notes() + diagnostics.print());
  if (!diagnostics.empty()) exit_with(kExitInput);
}

bool names_file(std::string_view spec) { return spec.ends_with(".ksy"); }

/// Reads the specs of a file into the model. Ends the command if the file itself is not there.
void load_file(const std::string& file, rubricc::Model& model, rubricc::Diagnostics& diagnostics) {
  require_file(file);
  rubricc::load_specs({file}, model, diagnostics, shipped_specs());
}

/// Reads a shipped spec, or a file.
const reflect::Protocol& read_spec(const std::string& spec) {
  const auto [at, fresh] = read_specs().try_emplace(spec);
  ReadSpec& read = at->second;
  if (!fresh) return *read.built.protocol;
  rubricc::Diagnostics diagnostics;
  add_requirements(read.model);
  if (names_file(spec)) {
    load_file(spec, read.model, diagnostics);
    rubricc::add_am_frames(shipped_specs(), read.model, diagnostics);
  } else {
    rubricc::load_shipped_spec(spec, shipped_specs(), read.model, diagnostics);
  }
  require_sound(read.model, diagnostics);
  read.tables = std::make_unique<rubricc::BuiltTables>(read.model);
  read.built = read.tables->of(read.model.specs.back()->id);
  return *read.built.protocol;
}

/// Prints the id and the title of each protocol.
[[noreturn]] void list_specs() {
  for (const std::string& name : protocol_names()) {
    text::print(stdout, "{:<16}{}\n", name, protocol_of(name).title);
  }
  exit_with(kExitClean);
}

bool claims(const reflect::Protocol& protocol, std::uint8_t am_type) {
  for (int i = 0; i < protocol.carrier_count; ++i) {
    const reflect::Switch* choice = reflect::payload_choice(protocol, protocol.carriers[i].name);
    for (int j = 0; choice && j < choice->count; ++j) {
      if (choice->cases[j].key == am_type) return true;
    }
  }
  return false;
}

}  // namespace

std::vector<std::string> protocol_names() {
  std::vector<std::string> names;
  for (const reflect::Protocol* protocol : reflect::protocols()) names.emplace_back(protocol->id);
  for (const auto& [name, text] : shipped_specs()) {
    if (!reflect::find_spec(name)) names.push_back(name);
  }
  return names;
}

namespace {

const reflect::Protocol& single_protocol_of(const std::string& spec) {
  if (spec == "list") list_specs();
  if (const reflect::Protocol* built_in = reflect::find_protocol(spec)) return *built_in;
  const std::vector<std::string> names = protocol_names();
  const bool shipped = std::find(names.begin(), names.end(), spec) != names.end();
  if (shipped || names_file(spec)) return read_spec(spec);
  struct stat status {};
  if (::stat(spec.c_str(), &status) == 0) {
    const char* const what =
        S_ISDIR(status.st_mode) ? "a folder" : "a file whose name does not end with .ksy";
    throw UsageError("--spec", fmt::format("'{}' is {}; expected a .ksy file, or a protocol of "
                                           "--spec list",
                                           spec, what));
  }
  const std::string meant = reflect::did_you_mean(spec, names);
  throw UsageError("--spec",
                   fmt::format("unknown protocol '{}'{}", spec,
                               meant.empty() ? "; --spec list prints those that ship, and "
                                               "the name of a file ends with .ksy"
                                             : meant));
}

/// Returns what --spec has for this protocol.
std::string name_of(const reflect::Protocol& protocol) {
  for (const auto& [name, spec] : combined_specs()) {
    if (&spec.protocol() == &protocol) return name;
  }
  for (const auto& [name, spec] : read_specs()) {
    if (spec.built.protocol == &protocol) return name;
  }
  return protocol.id;
}

}  // namespace

const reflect::Protocol& protocol_of(const std::string& spec) {
  const auto known = combined_specs().find(spec);
  if (known != combined_specs().end()) return known->second.protocol();
  std::vector<reflect::ProtocolPart> parts;
  for (const std::string& name : specs_in(spec)) {
    const reflect::Protocol& one = single_protocol_of(name);
    const auto same = [&](const reflect::ProtocolPart& part) { return part.protocol == &one; };
    if (std::none_of(parts.begin(), parts.end(), same)) parts.push_back({&one, &routes_of(one)});
  }
  if (parts.size() == 1) return *parts.front().protocol;
  try {
    return combined_specs().try_emplace(spec, parts).first->second.protocol();
  } catch (const std::invalid_argument& error) {
    throw UsageError("--spec", error.what());
  }
}

void read_all_specs() {
  for (const std::string& name : protocol_names()) protocol_of(name);
}

std::vector<std::string> specs_in(const std::string& spec) {
  struct stat status {};
  if (::stat(spec.c_str(), &status) == 0) return {spec};
  std::vector<std::string> out;
  std::size_t begin = 0;
  for (std::size_t end = 0; end != spec.npos; begin = end + 1) {
    end = spec.find(',', begin);
    out.push_back(spec.substr(begin, end == spec.npos ? end : end - begin));
  }
  return out;
}

std::vector<std::string> files_in(const std::string& spec) {
  std::vector<std::string> out = specs_in(spec);
  std::erase_if(out, [](const std::string& name) { return !names_file(name); });
  return out;
}

std::string text_of_spec(const std::string& spec) {
  std::string out;
  for (const std::string& file : files_in(spec)) {
    read_spec(file);
    for (const auto& one : read_specs().at(file).model.specs) {
      std::string text;
      if (text::read_file(one->file, text) == 0) out += text;  // Shipped ones are no files.
    }
  }
  return out;
}

void use_requirements_of(const std::string& file) {
  static rubricc::Model kept;  // The rules point into it.
  rubricc::Diagnostics diagnostics;
  rubricc::load_requirements(file, kept, diagnostics, rubricc::Catalogue::kOther);
  text::print_harmless(stderr, diagnostics.print());
  if (!diagnostics.empty()) exit_with(kExitInput);
  std::vector<reflect::Requirement> rules = {reflect::requirements().front()};
  for (const rubricc::Requirement& one : kept.requirements) {
    rules.push_back({one.id.c_str(), one.level.c_str(), one.clause.c_str(), one.sentence.c_str(),
                     one.source.c_str(), one.roles, one.forbids, one.deployed.c_str()});
  }
  reflect::use_requirements(std::move(rules));
}

bool chosen_by_content(std::string_view name) { return name != kNone && name != kLinkFrames; }

std::string spec_with(const reflect::Protocol& chosen,
                      const std::function<bool(const reflect::Protocol&)>& works) {
  for (const std::string& name : protocol_names()) {
    const reflect::Protocol& other = protocol_of(name);
    if (&other == &chosen || !works(other)) continue;
    return fmt::format("; {} has it: --spec {}", name, name);
  }
  return {};
}

std::string spec_with_message(const reflect::Protocol& chosen, std::string_view name) {
  return spec_with(chosen, [&](const reflect::Protocol& other) {
    return reflect::find_type(other, std::string(name)) != nullptr;
  });
}

const reflect::RouteTable& routes_of(const reflect::Protocol& protocol) {
  for (const auto& [name, spec] : combined_specs()) {
    if (&spec.protocol() == &protocol) return spec.routes();
  }
  for (const auto& [name, spec] : read_specs()) {
    if (spec.built.protocol == &protocol) return *spec.built.routes;
  }
  return *generate::routes_of(protocol);
}

namespace {

/// Returns which of the file and what it imports have the ids of specs that ship: a dissector has
/// them instead.
std::set<std::string> copies_in(const std::string& file) {
  rubricc::Model model;
  rubricc::Diagnostics diagnostics;
  diagnostics.pardon_code();
  load_file(file, model, diagnostics);
  std::set<std::string> out;
  for (const auto& one : model.specs) {
    const bool ships = one->file.starts_with("<shipped>");
    if (!ships && shipped_specs().contains(one->id)) out.insert(one->id);
  }
  return out;
}

}  // namespace

std::string dissector_with(const std::string& spec) {
  // Wireshark has beacons and commands of its own.
  const auto dissected = [](const auto& name) { return name != kNone && name != kLinkFrames; };
  rubricc::Model model;
  rubricc::Diagnostics diagnostics;
  add_requirements(model);
  std::vector<std::string> names;
  for (const auto& [name, text] : shipped_specs()) {
    if (dissected(name)) names.push_back(name);
  }
  const bool shipped = std::find(names.begin(), names.end(), spec) != names.end();
  if (!shipped && !names_file(spec)) {
    throw UsageError("--spec",
                     fmt::format("expected a .ksy file or one of {}; given '{}'{}",
                                 fmt::join(names, ", "), spec, reflect::did_you_mean(spec, names)));
  }
  // What ships and imports one of the copies may not fit that: then the file is alone.
  const std::set<std::string> copies = shipped ? std::set<std::string>() : copies_in(spec);
  for (const std::string& name : names) {
    const bool headers = name == kHeaders && !copies.contains(name);
    if (!copies.empty() && !headers) continue;
    rubricc::load_shipped_spec(name, shipped_specs(), model, diagnostics);
  }
  if (!shipped) {
    load_file(spec, model, diagnostics);
    rubricc::add_am_frames(shipped_specs(), model, diagnostics);
  }
  require_sound(model, diagnostics);
  const auto chosen = std::find_if(model.specs.begin(), model.specs.end(),
                                   [&](const auto& one) { return one->id == spec; });
  const rubricc::Spec& usual = shipped ? **chosen : *model.specs.back();
  if (std::none_of(usual.types.begin(), usual.types.end(),
                   [](const auto& type) { return rubricc::leads_to_messages(*type); })) {
    text::print(
        stderr,
        "rubric: {}: no type has '-am-type' or '-carrier: serial', 'radio_i' or 'radio_t', so no "
        "packet leads to its messages\n",
        spec);
    exit_with(kExitInput);
  }
  return rubricc::emit_lua(model, usual.id).front().text;
}

OtherSpecs::OtherSpecs(const reflect::Protocol& chosen) : chosen_(chosen) {
  said_.fill(kNone == chosen.id);
  said_of_links_ = kNone == chosen.id;
}

void OtherSpecs::look_closer(const reflect::Frame& frame) {
  std::vector<Hint> hints;
  look_closer(frame, hints);
  for (const Hint& hint : hints) text::print_harmless(stderr, hint.text);
}

void OtherSpecs::look_closer(const reflect::Frame& frame, std::vector<Hint>& hints) {
  if (chosen_.carrier_count == 0) {
    said_.fill(true);
    said_of_links_ = true;
    hints.push_back({-1, fmt::format("rubric: {} has no type with '-am-type' or '-carrier', so no "
                                     "frame leads to its types; --as TYPE reads bare ones\n",
                                     chosen_.id)});
    return;
  }
  if (others_.empty()) {
    static std::mutex reading;  // Read specs are kept in one place.
    const std::lock_guard lock(reading);
    chosen_name_ = text::harmless(name_of(chosen_));
    const std::vector<std::string> chosen = specs_in(chosen_.id);
    for (const std::string& name : protocol_names()) {
      const bool is_chosen = std::find(chosen.begin(), chosen.end(), name) != chosen.end();
      if (name != kNone && !is_chosen) others_.emplace_back(protocol_of(name));
    }
  }
  Hint hint{frame.am.present ? frame.am.type : -1, {}};
  for (const reflect::FrameDecoder& other : others_) {
    const std::string_view name = other.protocol().id;
    if (frame.am.present && !claims(other.protocol(), frame.am.type)) continue;
    reflect::Frame tried;
    other.decode(*frame.packet, tried);
    if (tried.malformed() || tried.decoded.note_count() != 0) continue;
    if (!frame.am.present) {
      const char* message = tried.decoded.message() ? tried.decoded.message()->name : "frame";
      hint.text =
          fmt::format("rubric: a {} fits {}: --spec {},{}\n", message, name, chosen_name_, name);
      said_of_links_ = true;
      break;
    }
    if (claims(chosen_, frame.am.type)) {
      hint.text +=
          fmt::format("rubric: AM {} also fits {}: --spec {}\n", frame.am.type, name, name);
    } else {
      hint.text += fmt::format("rubric: AM {} fits {}: --spec {},{}\n", frame.am.type, name,
                               chosen_name_, name);
    }
    said_[frame.am.type] = true;
  }
  if (!hint.text.empty()) hints.push_back(std::move(hint));
}

}  // namespace rubric::cli
