// How a message is reached: which carriers and which other messages lead to it, and by what.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "codec/reflect/schema.h"

namespace rubric::layout {

/// One way to a message.
struct Reach {
  /// "serial" or "radio" for the frames' own payload, else empty.
  std::string carrier;
  const reflect::Type* parent = nullptr;  ///< The structure that it stands in.
  const reflect::Field* field = nullptr;  ///< Where in it.
  std::string condition;                  ///< Under which it is looked for; empty for none.
  std::string key;                        ///< What chooses it; empty where nothing does.
  const reflect::Field* key_field = nullptr;  ///< The field that this is, if it is one.
  std::vector<std::int64_t> values;       ///< Of the key.
  bool otherwise = false;                 ///< Any value that chooses no other.
};

/// All ways to `message`, those of carriers first.
std::vector<Reach> reaches(const reflect::Protocol& protocol, const reflect::Type& message);

/// "AM 28 on serial", "body of app_msg if trans_id == connless, byte 2 being 35".
std::string reach_text(const Reach& reach);

/// All of them, one text for the ways that differ only in which of several types of the same shown
/// name the message stands in.
std::vector<std::string> reach_texts(const std::vector<Reach>& reaches);

/// The AM types under which carriers hold it, in ascending order.
std::vector<std::int64_t> am_types(const std::vector<Reach>& reaches);

/// Whether it is a carrier's structure rather than a message.
bool is_carrier(const reflect::Protocol& protocol, const reflect::Type& type);

/// Whether it is reached through fields that name it alone: part of a message.
bool is_part(const std::vector<Reach>& reaches);

}  // namespace rubric::layout
