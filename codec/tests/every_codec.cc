// All generated code in one unit, for every compiler used for firmware; never run.
#include "codec/generated/every_spec.h"

namespace rubric {
namespace {

// Accepts any number of any fields: instantiates the getters of views and the members of values.
struct Touch {
  template <class T>
  void operator()(const char*, const T& field) {
    use(field);
  }
  template <class T>
  void use(const T&) {
    ++count;
  }
  template <class Number>
  void use(const NumberArrayView<Number>& view) {
    typename Number::Value item[4];
    count += view.copy_to(item, 4);
    for (const auto value : view) use(value);
  }
  template <class View>
  void use(const StructArrayView<View>& view) {
    typename View::Value item[2];
    count += view.copy_to(item, 2);
    for (const View element : view) visit_fields(element, *this);
  }
  size_t count = 0;
};

struct TouchAll {
  template <class View>
  void operator()(const char*, ViewTag<View>) {
    const Result<View> view = View::parse(bytes);
    if (!view) return;
    visit_fields(*view, touch);
    typename View::Value value = view->to_value();
    visit_fields(value, touch);
    const Result<MutableBytes> written = write(value, out);
    touch.count += written ? written->size() : written.error().offset_bytes;
    touch.count += *view == *view && value == value;
  }
  Bytes bytes;
  MutableBytes out;
  Touch touch;
};

}  // namespace

/// The tables name every parse and write.
size_t touch_everything(Bytes bytes, MutableBytes out, const MessageCodec** tables) {
  TouchAll all{bytes, out, Touch()};
  for_each_spec([&](const char*, const auto& messages, auto for_each_view) {
    *tables++ = messages;
    for_each_view(all);
  });
  return all.touch.count;
}

}  // namespace rubric
