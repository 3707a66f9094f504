// Reads one .ksy file into the model, as written: names stay names, expressions stay trees.
#pragma once

#include <memory>
#include <string_view>

#include "spec/compiler/diagnostics.h"
#include "spec/compiler/load/yaml_input.h"

namespace rubricc {

/// Returns null only if the file holds nothing to read; otherwise what could be read, after errors.
std::unique_ptr<Spec> read_spec(const std::string& file, const std::string& text,
                                Diagnostics& diagnostics, int& budget);

/// The surroundings of an attribute.
enum class FieldPlace { kSeq, kInstance, kMask };

/// Reads an attribute of seq (id from its key `id`) or an instance (id from the mapping). Returns
/// null after an error that leaves nothing to go on with.
std::unique_ptr<Field> read_field(const YamlInput& input, const YAML::Node& node, FieldPlace where,
                                  const Spec& spec, const YamlEntry* instance);

/// Returns whether an instance is more than a number or a type at a constant position.
bool is_computed(const YAML::Node& instance);
Computed read_computed(const YamlInput& input, const YamlEntry& entry);

/// Reads `-unnamed` of a mask's bit.
MaskBit read_mask_bit(const YamlInput& input, const YAML::Node& node);

/// Reads an expression in a YAML scalar.
ExprPtr read_expr(const YamlInput& input, const YAML::Node& node, std::string_view what);

/// Returns the places of the values of `map`'s keys.
KeyPlaces places_of(const YamlInput& input, const YamlMap& map);
/// Returns the place of `key`, or `otherwise`.
const SourcePlace& place_of(const KeyPlaces& places, std::string_view key,
                            const SourcePlace& otherwise);

/// Checks an id: lower snake case, no word of C++, not too long; reports what it is not.
void check_id(Diagnostics& diagnostics, const SourcePlace& place, std::string_view id,
              std::string_view what);

/// Joins documentation: line ends become spaces, paragraphs go together.
std::string one_line(std::string_view text);

/// Returns null after an error. `place` is where the text begins.
ExprPtr parse_expr(std::string_view text, const SourcePlace& place, Diagnostics& diagnostics);

/// Returns the tree as text, bracketed only where needed: for diagnostics and the documentation.
std::string to_text(const Expr& expr);

}  // namespace rubricc
