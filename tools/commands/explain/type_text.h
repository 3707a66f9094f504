// Describes the tables in words: types, sizes, bounds, expressions, and how a message is reached.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "codec/reflect/schema.h"

namespace rubric::explain {

/// Returns the field of `type` (or of a structure in it) that the load reads, as a path; "byte 2"
/// if there is no number. `field` becomes that field, or null.
std::string path_of(const reflect::ExprStep& load, const reflect::Type& type,
                    const reflect::Field** field);

/// Returns an expression over the fields of `type`: "trans_id == connless and app_id == mockup".
std::string expr_text(const reflect::Expr& expr, const reflect::Type& type);

/// Returns a field's type: "u16", "f32le[matrix_size]", "r_addr", "bytes[nbytes]", "u16[...]".
std::string type_text(const reflect::Field& field, const reflect::Type& owner);

/// Returns the bytes of a field: "2", "4 * output_size", "rest".
std::string size_text(const reflect::Field& field, const reflect::Type& owner);

/// Returns the bytes of a type: "14", "14 to 114", "from 2".
std::string size_text(const reflect::Type& type);

/// Returns a field's allowed values: "2 to 102", "= 63", "expected 35".
std::string valid_text(const reflect::Field& field);

/// Returns "degC = raw * 0.01 - 40"; empty if a field has no unit.
std::string unit_text(const reflect::Field& field);

/// Returns a number with the enumerator's name, if it has one: "3 (connless)".
std::string key_text(std::int64_t key, const reflect::EnumTable* enumeration);

/// Returns the names of the bits that are set: "light, temp", "bit13" for one without a name;
/// "none".
std::string bits_text(const reflect::MaskTable& mask, std::int64_t value);

/// Returns the first sentence of a doc.
std::string first_sentence(const char* doc);

/// Returns a message's layout: its fields with offsets, sizes, types, bounds, units and rules, the
/// values of its enums and masks, its own rule, and its routes.
std::string explain_type(const reflect::Protocol& protocol, const reflect::Type& type);

/// Returns "Used by rubicon: net_msg.nbytes, ...": the fields that `has` finds, a line for each
/// protocol that has one.
std::string used_by(const std::vector<const reflect::Protocol*>& protocols,
                    const std::function<bool(const reflect::Field&)>& has);

std::string explain_enum(const reflect::Protocol& protocol, const reflect::EnumTable& table);
std::string explain_mask(const reflect::Protocol& protocol, const reflect::MaskTable& table);

/// One route to a message.
struct Reach {
  /// "serial" or "radio" for the frames' own payload, else empty.
  std::string carrier;
  const reflect::Type* parent = nullptr;      ///< The structure around it.
  const reflect::Field* field = nullptr;      ///< Its field there.
  std::string condition;                      ///< Condition for trying it; empty for none.
  std::string key;                            ///< The key that chooses it; empty if there is none.
  const reflect::Field* key_field = nullptr;  ///< The field that this is, if it is one.
  std::vector<std::int64_t> values;           ///< For the key.
  bool otherwise = false;                     ///< Any value that chooses no other.
};

/// Returns all routes to `message`, those of carriers first.
std::vector<Reach> reaches(const reflect::Protocol& protocol, const reflect::Type& message);

/// Returns "AM 28 on serial", "body of app_msg if trans_id == connless, byte 2 being 35".
std::string reach_text(const Reach& reach);

/// Returns texts for all of them, one for the routes that differ only in which of several types of
/// the same shown name is around the message.
std::vector<std::string> reach_texts(const std::vector<Reach>& reaches);

/// Returns the AM types under which carriers hold it, in ascending order.
std::vector<std::int64_t> am_types(const std::vector<Reach>& reaches);

/// Returns whether it is a carrier's structure rather than a message.
bool is_carrier(const reflect::Protocol& protocol, const reflect::Type& type);

}  // namespace rubric::explain
