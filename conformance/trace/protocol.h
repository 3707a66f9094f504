// What a protocol has besides its frames: who takes part, what an implementation states of itself,
// what an application calls and is told. An app.yaml says it (conformance/protocols/README.md).
//
// A process works with one protocol: RUBICON, or another that use() names before anything is parsed
// (decision 15).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "codec/reflect/schema.h"
#include "conformance/trace/parameters.h"

namespace rubric::trace {

enum class AppKind : std::uint8_t {
  kNumber,  ///< From 0 to `max`, perhaps with names.
  kReal,    ///< binary32.
  kBytes,
  kAddress,  ///< pid and devid.
  kChannel,  ///< Source and destination devid.
};

struct AppField {
  std::string name;
  AppKind kind = AppKind::kNumber;
  std::uint32_t max = 0;
  const reflect::EnumTable* names = nullptr;
  const reflect::MaskTable* mask = nullptr;
  bool derived = false;  ///< Says how much there is of another field.
};

enum class AppWhat : std::uint8_t {
  kCall,   ///< From the application to the node: `<` on app.
  kEvent,  ///< From the node to its application: `>` on app.
  kState,  ///< A link's or the application's: `<` on any of them.
  kRadio,  ///< The end of the node's own last transmission: `<` on a radio.
  kPower,  ///< `<` on power.
  kFrame,  ///< On the links of frames, either way.
};

/// A message of a line besides those of the wire spec.
struct AppMessage {
  std::string name;
  AppWhat what = AppWhat::kCall;
  std::vector<AppField> fields = {};
};

/// The name of the message for a frame that nothing decodes.
inline constexpr const char* kFrameName = "am";

enum class Role : std::uint8_t;

struct RoleInfo {
  std::string name;
  bool radio = false;  ///< The links that it has.
  bool serial = false;
  bool peis = false;
  bool has_id = true;  ///< Has a TinyOS id.
  bool has_island = false;
};

/// An enum of an app.yaml, with what its table points to.
struct AppEnum {
  std::map<std::uint32_t, std::string> names;
  std::vector<reflect::EnumEntry> entries;
  reflect::EnumTable table{};
};

struct Protocol {
  std::string name;
  const reflect::Protocol* wire = nullptr;
  bool has_machine = false;  ///< The reference machine plays it: RUBICON alone.
  std::vector<RoleInfo> roles;
  std::vector<std::string> profiles;  ///< The first is that of traces which name none.
  std::vector<Parameter> parameters;
  std::vector<AppMessage> messages;
  std::vector<std::string> broadcast;        ///< Messages for all, where no am= says otherwise.
  std::vector<std::string> whole_on_serial;  ///< Messages with zeros up to the greatest size there.
  std::vector<std::string> on_peis;          ///< Messages that travel over PEIS.
  std::map<std::string, std::unique_ptr<AppEnum>, std::less<>> enums;
};

/// Returns the protocol in use.
const Protocol& protocol();
/// Sets it; before anything is parsed, and before there are threads.
void use(Protocol other);

/// Finds the wire spec that an app.yaml names; throws std::invalid_argument where it cannot.
using FindWire = std::function<const reflect::Protocol&(const std::string& name)>;
/// Reads an app.yaml. Throws std::runtime_error with "file:line:column: mistake".
Protocol read_protocol(const std::string& text, const std::string& file, const FindWire& find_wire);

bool is_among(const std::vector<std::string>& names, std::string_view name);
/// Returns "mote, sink or base_station".
std::string alternatives(const std::vector<std::string>& words);
std::vector<std::string> role_names();
/// Returns what the protocol in use says of a role.
const RoleInfo& role_info(Role role);

/// Returns the app.yaml of RUBICON, by name. Generated when the program is built.
const std::map<std::string, std::string>& embedded_protocol();

}  // namespace rubric::trace
