// Compares generated views with the nodes that the tables made of the same bytes, for tests.
#pragma once

#include <string>
#include <type_traits>

#include "codec/reflect/decode.h"
#include "codec/tests/every_view.h"

namespace rubric::reflect {

/// Visits the fields of a view and the children of its node. They are matched by their order, so
/// that a field which only one of the two has is a difference and not skipped.
class ViewComparer {
 public:
  explicit ViewComparer(const Decoded& decoded) : decoded_(decoded) {}

  /// Compares all of `view` with the node. Returns the node of the structure that the tables chose
  /// in place of its bytes, or 0 if they left them opaque.
  template <class View>
  std::size_t structure(const View& view, std::size_t node) {
    const Children before = place_;
    place_ = {node + 1, decoded_[node].end, 0};
    same("kind", static_cast<int>(NodeKind::kStruct), static_cast<int>(decoded_[node].kind));
    extent("structure", view.bytes(), decoded_[node]);
    visit_fields(view, *this);
    same("end of the fields", place_.next, place_.end);
    const std::size_t chosen = place_.chosen;
    place_ = before;
    return chosen;
  }

  template <class T>
  void operator()(const char* name, const T& field) {
    if (place_.next >= place_.end) return differ(name, "only the view has it");
    const std::size_t node = place_.next;
    place_.next = decoded_[node].end;
    compare(name, field, node);
  }

  void same(const char* what, std::size_t view, std::size_t node) {
    same(what, static_cast<std::int64_t>(view), static_cast<std::int64_t>(node));
  }
  void same(const char* what, std::int64_t view, std::int64_t node) {
    if (view != node) differ(what, std::to_string(view) + ", not " + std::to_string(node));
  }
  void same(const char* what, int view, int node) {
    same(what, std::int64_t{view}, std::int64_t{node});
  }
  void differ(const std::string& what, const std::string& how) {
    if (difference_.empty()) difference_ = what + ": " + how;
  }

  /// Returns the first difference; empty if there is none.
  const std::string& difference() const { return difference_; }
  long numbers() const { return numbers_; }    ///< Compared, outside of arrays.
  long elements() const { return elements_; }  ///< Compared, of arrays of either kind.

 private:
  struct Children {
    std::size_t next = 0;
    std::size_t end = 0;
    std::size_t chosen = 0;
  };

  template <class T>
  static std::int64_t bits(const T& value) {
    if constexpr (std::is_same_v<T, float>) {
      return bits_of_float(value);
    } else if constexpr (requires { value.raw(); }) {
      return static_cast<std::int64_t>(value.raw());
    } else {
      return static_cast<std::int64_t>(value);
    }
  }
  void extent(const char* name, Bytes bytes, const Node& node) {
    same(name, bytes.size(), std::size_t{node.size});
    place(name, bytes, node);
  }
  void place(const char* name, Bytes bytes, const Node& node) {
    if (bytes.empty()) return;  // May point anywhere.
    same(name, std::int64_t{bytes.data() - decoded_.bytes.data()}, std::int64_t{node.offset});
  }

  template <class T>
  void compare(const char* name, const T& field, std::size_t node) {
    if constexpr (requires { T::kMinSizeBytes; }) {
      structure(field, node);
    } else {
      if (decoded_[node].kind != NodeKind::kNumber) return differ(name, "not a number");
      same(name, bits(field), decoded_[node].value);
      ++numbers_;
    }
  }
  void compare(const char* name, Bytes field, std::size_t node) {
    const Node& n = decoded_[node];
    if (n.kind == NodeKind::kBytes) return extent(name, field, n);
    if (n.kind != NodeKind::kStruct) return differ(name, "not bytes");
    // Chosen by the tables; bytes after it are stale.
    if (n.size > field.size()) differ(name, "larger than its room");
    place(name, field, n);
    place_.chosen = node;
  }
  template <class Number>
  void compare(const char* name, const NumberArrayView<Number>& field, std::size_t node) {
    const Node& n = decoded_[node];
    if (n.kind != NodeKind::kNumberArray) return differ(name, "not an array of numbers");
    extent(name, field.bytes(), n);
    same(name, field.size(), std::size_t{n.count});
    const std::uint8_t* at = decoded_.bytes.data() + n.offset;
    std::size_t i = 0;
    for (const auto value : field) {  // Elements by iterator and by index.
      const std::int64_t wanted = load_number(*n.field, at + i * n.field->width_bytes);
      same(name, bits(value), wanted);
      same(name, bits(field[i++]), wanted);
    }
    elements_ += static_cast<long>(i);
  }
  template <class View>
  void compare(const char* name, const StructArrayView<View>& field, std::size_t node) {
    const Node& n = decoded_[node];
    if (n.kind != NodeKind::kStructArray) return differ(name, "not an array of structures");
    extent(name, field.bytes(), n);
    same(name, field.size(), std::size_t{n.count});
    std::size_t element = node + 1;
    for (std::size_t i = 0; i < field.size() && element < n.end; ++i) {
      structure(field[i], element);
      element = decoded_[element].end;
      ++elements_;
    }
    same(name, element, std::size_t{n.end});
  }

  const Decoded& decoded_;
  Children place_;
  std::string difference_;
  long numbers_ = 0;
  long elements_ = 0;
};

}  // namespace rubric::reflect
