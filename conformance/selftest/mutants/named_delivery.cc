// Mistakes in Connectionless: how applications' messages are wrapped, and which applications get
// them.
#include <utility>

#include "conformance/machine/transport.h"
#include "conformance/selftest/mutants/fields.h"
#include "conformance/selftest/mutants/mutant.h"

namespace rubric::mutants {
namespace {

using machine::Received;

void add_delivery(Mutants& out) {
  add(out, "no_trans_id", "A message of an application has TRANSID 0.",
      {"T1-WRAP"_rule, "N1-SEQ"_rule}, sent_field(is_send, net::kTransId, 0));
  add(out, "app_id_of_another", "A message of an application has APPID APPLICATION_MD.",
      {"T1-WRAP"_rule}, sent_field(is_send, net::kAppId, 8));
  add(out, "ids_swapped", "TRANSID and APPID are in the wrong order.", {"T1-WRAP"_rule},
      edit_sent(is_send, [](Moment&, Transmit& frame) {
        std::swap(frame.payload[net::kTransId], frame.payload[net::kAppId]);
      }));
  add(out, "delivered_with_ids", "What is delivered begins with TRANSID and APPID.",
      {"T1-DELIVER"_rule, "N5-DELIVER"_rule, "N6-DELIVER"_rule},
      edit_told<Received>([](Moment& moment, Received& received) {
        const Frame* const frame = moment.heard(am::kNet);
        const bool whole = frame != nullptr && is_net(*frame);
        if (whole) received.data = frame->payload.from(net::kTransId);
      }));
  add(out, "delivered_without_last_byte", "The last byte of a delivered message is lost.",
      {"T1-DELIVER"_rule, "N5-DELIVER"_rule}, edit_told<Received>([](Moment&, Received& received) {
        if (!received.data.empty()) {
          received.data = received.data.first(received.data.size() - 1);
        }
      }));
  add(out, "delivered_to_one_application", "Everything is delivered to MOCKUP.",
      {"T1-DELIVER"_rule},
      edit_told<Received>([](Moment&, Received& received) { received.app_id = 5; }));
  add(out, "delivered_from_the_sink", "Every message seems to come from the sink.",
      {"T1-DELIVER"_rule, "N5-DELIVER"_rule, "N6-DELIVER"_rule},
      edit_told<Received>([](Moment& moment, Received& received) {
        received.src = {own(moment).pid, 1};
      }));
  add(out, "delivered_twice", "Every message is delivered twice.",
      {"T1-DELIVER"_rule, "T2-DELIVER"_rule, "N5-DELIVER"_rule, "N2-IN-ORDER"_rule},
      on_told_of<Received>([](Moment&, Received&) { return Fate::kTwice; }));
  add(out, "unknown_app_delivered", "A message for an unknown APPID is delivered to MOCKUP.",
      {"T1-UNKNOWN"_rule}, edit_heard([](Moment&, Forged& forged) {
        const bool connless =
            is_net(forged.frame) && forged.bytes[net::kTransId] == component::kConnless;
        std::uint8_t& app_id = forged.bytes[net::kAppId];
        if (connless && !machine::is_known_app(app_id)) app_id = 5;
      }));
  add(out, "unknown_trans_delivered", "An unknown TRANSID is taken for CONNLESS.",
      {"T1-UNKNOWN"_rule}, edit_heard([](Moment&, Forged& forged) {
        if (is_net(forged.frame) && forged.bytes[net::kTransId] > 13) {
          forged.bytes[net::kTransId] = component::kConnless;
        }
      }));
  add(out, "unknown_kills", "After an unknown TRANSID or APPID a node hears no more.",
      {"T1-UNKNOWN"_rule}, remembering<bool>([](Moment& moment, bool& dead) {
        if (dead && moment.heard(am::kNet) != nullptr) return moment.nothing();
        moment.honest();
        for (const Action& action : moment.actions.all()) {
          dead = dead ||
                 (action.what == Action::What::kIgnored && action.requirement == "T1-UNKNOWN"_rule);
        }
      }));
}

}  // namespace

Mutants delivery_mutants() {
  Mutants out;
  add_delivery(out);
  return out;
}

}  // namespace rubric::mutants
