// Every generated builder, given every field of a value of its structure, by field names.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <type_traits>

#include "codec/runtime/bytes.h"
#include "fuzz/support/require.h"

namespace rubric::fuzz {

// The names of all fields; those come first that place or count others.
// It takes the list for an expression.
// clang-format off
#define RUBRIC_EACH_FIELD(F)                                                                    \
  F(kind) F(mac) F(network) F(am) F(dest) F(src) F(type) F(fcf) F(dsn) F(destpan) F(dispatch)   \
  F(length) F(group) F(pid) F(devid) F(reliable) F(ack) F(seq_num) F(nbytes) F(trans_id)        \
  F(app_id) F(msg_type) F(version) F(interval) F(id) F(count) F(counter) F(delay) F(period)     \
  F(net_id) F(island_addr) F(mote_addr) F(src_island_addr) F(src_mote_addr) F(dest_island_addr) \
  F(dest_mote_addr) F(src_net_id) F(dest_net_id) F(rows) F(cols) F(matrix_size) F(output_size)  \
  F(src_neurons_size) F(dest_neurons_size) F(src_neurons) F(dest_neurons) F(params) F(value)    \
  F(transducer) F(transducers) F(actuators) F(mote_type) F(mote_desc) F(sensors_bitmask)        \
  F(sampling_rate) F(clock) F(cur_time) F(anchor_id) F(rssi) F(my_rssi) F(temp) F(light)        \
  F(humid) F(pir) F(mic) F(magnetic) F(accx) F(accy) F(output) F(weights) F(values) F(readings) \
  F(payload) F(packet)
// clang-format on

namespace detail {

template <class Call>
void call(Call set) {
  if constexpr (std::is_void_v<decltype(set())>) {
    set();
  } else {
    [[maybe_unused]] const bool taken = set();
  }
}

}  // namespace detail

#define RUBRIC_SET_FIELD(field)                                                                 \
  if constexpr (requires { value.field; }) {                                                    \
    if constexpr (requires { builder.set_##field(value.field); }) {                             \
      detail::call([&] { return builder.set_##field(value.field); });                           \
    }                                                                                           \
    if constexpr (requires { builder.set_##field(&value.field[0], std::size(value.field)); }) { \
      const std::size_t n = std::size(value.field);                                             \
      detail::call([&] { return builder.set_##field(n ? &value.field[0] : nullptr, n); });      \
      for (std::size_t i = 0; i < n; ++i) builder.set_##field(i, value.field[i]);               \
    }                                                                                           \
    if constexpr (requires { builder.field().finish(); }) {                                     \
      auto inner = builder.field();                                                             \
      set_every_field(inner, value.field);                                                      \
    }                                                                                           \
  }

/// Passes each of `value`'s fields to the setter of its name, arrays whole and then one by one, and
/// structures also through their own builders. A refusal shows at the end.
template <class Builder, class Value>
void set_every_field(Builder& builder, const Value& value) {
  if constexpr (requires { value.updates[0].value; }) {  // An array of structures.
    const std::size_t n = value.updates.size();
    [[maybe_unused]] const bool taken = builder.set_output_size(static_cast<unsigned char>(n));
    for (std::size_t i = 0; i < n; ++i) {
      auto inner = builder.updates(i);
      set_every_field(inner, value.updates[i]);
    }
  }
  RUBRIC_EACH_FIELD(RUBRIC_SET_FIELD)
}

// Fields whose setters refuse 255 in any room: counts and flags.
#define RUBRIC_EACH_LIMITED_FIELD(F) \
  F(reliable) F(nbytes) F(output_size) F(src_neurons_size) F(dest_neurons_size)

#define RUBRIC_SET_TOO_MUCH(field)                                                              \
  if constexpr (requires { value.field; }) {                                                    \
    if constexpr (requires { builder.set_##field(&value.field[0], std::size(value.field)); }) { \
      using Item = std::remove_cvref_t<decltype(value.field[0])>;                               \
      static const Item many[256] = {};                                                         \
      if constexpr (std::is_arithmetic_v<Item>) {                                               \
        require(!builder.set_##field(many, 256), "too many are refused");                       \
      }                                                                                         \
    }                                                                                           \
    if constexpr (requires { builder.set_##field(Bytes()); }) {                                 \
      static const std::uint8_t large[2000] = {};                                               \
      require(!builder.set_##field(Bytes(large, 2000)), "too many bytes are refused");          \
      if constexpr (requires { builder.set_##field##_size(std::size_t{2000}); }) {              \
        require(!builder.set_##field##_size(std::size_t{2000}), "too large a size is refused"); \
      }                                                                                         \
    }                                                                                           \
  }

#define RUBRIC_SET_255(field)                                                       \
  if constexpr (requires {                                                          \
                  { builder.set_##field(std::uint8_t{255}) } -> std::same_as<bool>; \
                }) {                                                                \
    require(!builder.set_##field(std::uint8_t{255}), "255 is refused");             \
  }

/// Passes each setter that can refuse more than any structure of `value`'s kind holds: it refuses,
/// and changes nothing.
template <class Builder, class Value>
void set_too_much(Builder& builder, const Value& value) {
  (void)value;
  RUBRIC_EACH_FIELD(RUBRIC_SET_TOO_MUCH)
  RUBRIC_EACH_LIMITED_FIELD(RUBRIC_SET_255)
}

}  // namespace rubric::fuzz
