// Finds how a message is reached: through which carriers and other messages, and by which keys.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "codec/reflect/schema.h"

namespace rubric::explain {

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

/// Returns whether it is reached through fields of its type alone: part of a message.
bool is_part(const std::vector<Reach>& reaches);

}  // namespace rubric::explain
