// All generated code in one unit, for every compiler used for firmware; never run.
#include "codec/generated/oscilloscope/all.h"
#include "codec/generated/rubicon/all.h"
#include "codec/generated/tinyos/all.h"

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

size_t touch_everything(Bytes bytes, MutableBytes out) {
  TouchAll all{bytes, out, Touch()};
  tinyos::for_each_view(all);
  rubicon::for_each_view(all);
  oscilloscope::for_each_view(all);
  return all.touch.count;
}
// The tables name every parse and write.
const MessageCodec* all_of_tinyos() { return tinyos::kMessages; }
const MessageCodec* all_of_rubicon() { return rubicon::kMessages; }
const MessageCodec* all_of_oscilloscope() { return oscilloscope::kMessages; }

}  // namespace rubric
