// The protocols that --spec names: built in, shipped as text, or a .ksy file of the user's.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "codec/reflect/frame.h"
#include "codec/reflect/schema.h"

namespace rubric::cli {

/// Returns the texts of all wire specs that the program has, by id.
const std::map<std::string, std::string_view, std::less<>>& shipped_specs();

/// Returns the ids of the protocols that --spec takes by name, the built-in ones first.
std::vector<std::string> protocol_names();

/// Reads all of them now: processes that are forked after it have them.
void read_all_specs();

/// Returns the protocol that --spec names; of several, with commas between them, one that has the
/// messages of all (reflect::CombinedProtocol). A name that ends in .ksy is a file, which is read
/// now with its imports: its mistakes are printed as rubricc does, and end the subcommand. Throws
/// UsageError with the nearest name if there is none. `list` prints the names, and ends it.
const reflect::Protocol& protocol_of(const std::string& spec);

/// Returns the names that a --spec has between commas; the name of a file may have some, too.
std::vector<std::string> specs_in(const std::string& spec);

/// Returns those of them that are files.
std::vector<std::string> files_in(const std::string& spec);

/// Returns the texts of the files that a --spec reads, imported ones too; empty of a name.
std::string text_of_spec(const std::string& spec);

/// Sets the rules of this file in the place of RUBICON's. Its mistakes are printed as rubricc does,
/// and end the subcommand.
void use_requirements_of(const std::string& file);

/// Returns whether a protocol may be chosen by what a capture holds: none and ieee802154 fit too
/// much.
bool chosen_by_content(std::string_view name);

/// Returns a hint at the first other protocol for which `works` holds: "; ctp has it: --spec ctp".
/// Empty if there is none.
std::string spec_with(const reflect::Protocol& chosen,
                      const std::function<bool(const reflect::Protocol&)>& works);

/// Does the same for a protocol with a message of this name.
std::string spec_with_message(const reflect::Protocol& chosen, std::string_view name);

/// Returns the routes to the messages of a protocol that protocol_of() returned.
const reflect::RouteTable& routes_of(const reflect::Protocol& protocol);

/// Returns the dissector of the shipped specs and that of this .ksy file, if it is one. Frames are
/// read by `spec`. Throws UsageError for another name.
std::string dissector_with(const std::string& spec);

/// Says once for each AM type, and once for beacons and commands, which other spec fits a message
/// that the chosen one does not fit wholly.
class OtherSpecs {
 public:
  struct Hint {
    int about = 0;     ///< An AM type, or -1: frames without an active message.
    std::string text;  ///< Whole lines.
  };

  explicit OtherSpecs(const reflect::Protocol& chosen);

  /// Prints hints on stderr.
  void look(const reflect::Frame& frame) {
    if (may_fit_others(frame)) look_closer(frame);
  }
  /// Adds a hint, if there is one. Several threads may do so, each by its own OtherSpecs.
  void look(const reflect::Frame& frame, std::vector<Hint>& hints) {
    if (may_fit_others(frame)) look_closer(frame, hints);
  }

 private:
  bool may_fit_others(const reflect::Frame& frame) const {
    const bool fits = !frame.malformed() && frame.decoded.note_count() == 0;
    if (fits) return false;
    const bool link = frame.packet->framing == Framing::kRadio;
    return frame.am.present ? !said_[frame.am.type] : link && !said_of_links_;
  }
  void look_closer(const reflect::Frame& frame);
  void look_closer(const reflect::Frame& frame, std::vector<Hint>& hints);

  const reflect::Protocol& chosen_;
  std::string chosen_name_;                    // As --spec has it.
  std::vector<reflect::FrameDecoder> others_;  // Made when a first message does not fit.
  std::array<bool, 256> said_{};
  bool said_of_links_ = false;  // Of frames without an active message.
};

}  // namespace rubric::cli
