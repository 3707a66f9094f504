#include "conformance/adapters/cpp/frame.h"

#include "codec/generated/rubicon/net_msg.h"

namespace rubric::cpp_node {

Address address_of(rubicon::RAddrView view) {
  return {static_cast<std::uint16_t>(view.pid()), static_cast<std::uint16_t>(view.devid())};
}

rubicon::RAddr wire_of(Address address) {
  rubicon::RAddr wire;
  wire.pid = static_cast<rubicon::Pid>(address.island);
  wire.devid = static_cast<rubicon::Devid>(address.device);
  return wire;
}

std::optional<Message> read_message(Bytes payload) {
  const auto view = rubicon::NetMsgView::parse(payload);
  if (!view) return std::nullopt;
  const Bytes app = view->payload();
  Message message;
  message.dest = address_of(view->dest());
  message.src = address_of(view->src());
  message.reliable = view->reliable() == 1;
  message.number = view->seq_num();
  message.transport = rubicon::AppMsgLayout::TransIdAt::load(app.data());
  message.application = rubicon::AppMsgLayout::AppIdAt::load(app.data());
  message.body.assign(app.begin() + rubicon::AppMsgLayout::PayloadAt::kAt, app.end());
  return message;
}

Data write_message(const Message& message, bool whole) {
  Data app{static_cast<std::uint8_t>(message.transport),
           static_cast<std::uint8_t>(message.application)};
  app.insert(app.end(), message.body.begin(), message.body.end());
  rubicon::NetMsg value;
  value.dest = wire_of(message.dest);
  value.src = wire_of(message.src);
  value.reliable = message.reliable ? 1 : 0;
  value.seq_num = message.number;
  value.payload = Bytes(app.data(), app.size());
  Data bytes(rubicon::NetMsgView::kMaxSizeBytes);
  const auto written = write(value, MutableBytes(bytes.data(), bytes.size()));
  if (!whole) bytes.resize(written->size());
  return bytes;
}

}  // namespace rubric::cpp_node
