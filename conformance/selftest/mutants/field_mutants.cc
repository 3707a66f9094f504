// Mutants that change one field of a frame or notice.
#include <memory>
#include <set>

#include "codec/generated/rubicon/tables.h"
#include "codec/reflect/am_frames.h"
#include "codec/reflect/frame.h"
#include "conformance/selftest/mutants/fields.h"
#include "conformance/selftest/mutants/hunt.h"
#include "conformance/trace/concrete.h"
#include "conformance/trace/events/lines.h"

namespace rubric::mutants {
namespace {

std::size_t header_bytes(Link link) {
  return link == Link::kRadio ? reflect::kRadioIHeaderBytes : reflect::kAmHeaderBytes;
}

enum class Change : std::uint8_t { kPlusOne, kHighBit };

// Collects the places below node `i`, whose name is `path`; for arrays the first element.
void collect(const reflect::Decoded& decoded, std::size_t i, const std::string& path,
             std::size_t header, std::vector<FieldPlace>& out) {
  const reflect::Node& node = decoded[i];
  if (node.kind == reflect::NodeKind::kStruct || node.kind == reflect::NodeKind::kStructArray) {
    for (std::size_t k = i + 1; k < node.end; k = decoded[k].end) {
      const bool element = node.kind == reflect::NodeKind::kStructArray;
      const std::string name = element ? "" : decoded[k].field->name;
      collect(decoded, k, path.empty() || element ? path + name : path + "." + name, header, out);
      if (element) return;
    }
    return;
  }
  if (node.size == 0 || node.offset < header) return;
  FieldPlace place{path, node.offset - header, node.size, node.field->little_endian};
  if (node.kind == reflect::NodeKind::kNumberArray) place.size_bytes = node.size / node.count;
  if (node.kind == reflect::NodeKind::kBytes) place.size_bytes = 1;
  out.push_back(std::move(place));
}

// Returns the frame as a packet on its line, which decides how it decodes.
std::vector<std::uint8_t> packet_of(const Transmit& frame) {
  if (frame.link != Link::kRadio) {
    return reflect::serial_packet({.type = frame.type}, frame.bytes());
  }
  const std::uint16_t fcf = reflect::fcf_of(tinyos::FrameControl::kData);
  return reflect::radio_frame({.fcf = fcf}, frame.type, frame.bytes());
}

void add_one(Transmit& frame, const FieldPlace& place) {
  for (std::size_t i = 0; i < place.size_bytes; ++i) {
    const std::size_t at = place.little_endian ? i : place.size_bytes - 1 - i;
    if (++frame.payload[place.offset_bytes + at] != 0) return;  // Else it carries.
  }
}

void change(Transmit& frame, const FieldPlace& place, Change how) {
  const bool plus = how == Change::kPlusOne;
  const auto other = [&](std::uint16_t value) {
    return static_cast<std::uint16_t>(plus ? value + 1 : value ^ 0x8000);
  };
  if (place.path == "am.dest") {
    frame.dest = other(frame.dest);
  } else if (place.path == "am.src") {
    frame.src = other(frame.src);
  } else if (plus) {
    add_one(frame, place);
  } else {
    const std::size_t high = place.little_endian ? place.size_bytes - 1 : 0;
    frame.payload[place.offset_bytes + high] ^= 0x80;
  }
}

std::string link_text(Link link) {
  return link == Link::kRadio ? "radio" : link == Link::kSerial ? "serial" : "peis";
}

// Returns "J3-REPLY join_reply by radio".
std::string sent_kind(const Action& action, const Transmit& frame, const Anatomy& parts) {
  return std::string(trace::requirement_text(action.requirement)) + " " + parts.name + " by " +
         link_text(frame.link);
}

StepMaker changed_frame(const std::string& kind, const std::string& path, Change how) {
  return on_sent([=](Moment&, const Action& action, Transmit& frame) {
    const Anatomy parts = anatomy(frame);
    if (sent_kind(action, frame, parts) != kind) return Fate::kKeep;
    for (const FieldPlace& place : parts.places) {
      if (place.path == path) change(frame, place, how);
    }
    return Fate::kKeep;
  });
}

void change(trace::Leaf& leaf, Change how) {
  if (leaf.domain.kind == trace::Domain::Kind::kBytes) {
    if (leaf.bytes.empty()) return;
    char& first = leaf.bytes.front();
    first = static_cast<char>(first ^ (how == Change::kPlusOne ? 1 : 0x80));
  } else if (leaf.domain.kind == trace::Domain::Kind::kReal) {
    leaf.number ^= how == Change::kPlusOne ? 0x00400000 : 0x80000000;
  } else if (how == Change::kPlusOne) {
    leaf.number += leaf.number == leaf.domain.max ? -1 : 1;
  } else {
    leaf.number =
        leaf.number > leaf.domain.max / 2 ? leaf.number - leaf.domain.max / 2 : leaf.domain.max;
  }
}

// Keeps the bytes of a changed notice until it is read.
using Lasting = std::shared_ptr<std::vector<std::unique_ptr<trace::Concrete>>>;

StepMaker changed_notice(const std::string& kind, const std::string& path, Change how) {
  return [=]() -> Step {
    const Lasting lasting = std::make_shared<Lasting::element_type>();
    return [=](Moment& moment) {
      lasting->clear();
      moment.honest();
      const Actions honest = moment.actions;
      moment.rewrite([&](const Action& action) {
        if (kind_of(action, honest) != kind) return moment.keep(action);
        auto told = std::make_unique<trace::Concrete>(
            trace::concrete(events::from_notice(honest.notice_of(action))));
        for (trace::Leaf& leaf : told->leaves) {
          if (leaf.path == path) change(leaf, how);
        }
        const auto notice = events::to_notice(*told);
        lasting->push_back(std::move(told));
        moment.keep(action, notice.value());
      });
    };
  };
}

// Returns whether the node itself made the body after APPID; an application's body does not matter
// to the protocol.
bool is_own_body(const Transmit& frame) {
  return is_ack(frame) || is_synaptic(frame) ||
         (is_net(frame) && frame.payload[net::kBody] == net::kReport);
}

struct Field {
  std::string kind;
  std::string path;
  std::string acts_on;
  friend auto operator<=>(const Field&, const Field&) = default;
};

}  // namespace

Anatomy anatomy(const Transmit& frame) {
  static const reflect::FrameDecoder decoder(rubicon::tables::kProtocol);
  const std::vector<std::uint8_t> bytes = packet_of(frame);
  Packet packet;
  packet.framing = frame.link == Link::kRadio ? Framing::kRadio : Framing::kSf;
  packet.bytes = Bytes(bytes.data(), bytes.size());
  reflect::Frame decoded;
  decoder.decode(packet, decoded);
  Anatomy parts;
  for (std::size_t i = 0; i < decoded.decoded.path_count(); ++i) {
    const std::string name = decoded.decoded.path()[i]->name;
    if (name == "app_msg") continue;  // A net_msg always holds one.
    if (i < 2 || is_own_body(frame)) parts.name += (i == 0 ? "" : " ") + name;
  }
  parts.places.push_back({"am.dest", 0, 2, false});
  parts.places.push_back({"am.src", 0, 2, false});
  if (decoded.has_payload)
    collect(decoded.decoded, decoded.payload_node, "", header_bytes(frame.link), parts.places);
  return parts;
}

Mutants field_mutants(const Golden& golden) {
  std::set<Field> sent;
  std::set<Field> told;
  std::set<Field> yes_or_no;  // There is only one way to change it.
  watch(golden, [&](const State&, Ticks, const Event&, const State&, const Actions& actions) {
    for (const Action& action : actions.all()) {
      if (action.what == Action::What::kTransmit) {
        const Transmit& frame = actions.transmit_of(action);
        const Anatomy parts = anatomy(frame);
        const std::string kind = sent_kind(action, frame, parts);
        for (const FieldPlace& place : parts.places) {
          sent.insert({kind, place.path, kind_of(action, actions)});
        }
      } else if (action.what == Action::What::kNotify) {
        const auto concrete = trace::concrete(events::from_notice(actions.notice_of(action)));
        for (const auto& leaf : concrete.leaves) {
          const std::string kind = kind_of(action, actions);
          told.insert({kind, leaf.path, kind});
          if (leaf.domain.max == 1) yes_or_no.insert({kind, leaf.path, kind});
        }
      }
    }
  });
  Mutants out;
  for (const Change how : {Change::kPlusOne, Change::kHighBit}) {
    const char* const name = how == Change::kPlusOne ? "plus one: " : "high bit: ";
    for (const Field& field : sent) {
      out.push_back({name + field.kind + ": " + field.path,
                     "A field is something else.",
                     {},
                     changed_frame(field.kind, field.path, how),
                     field.acts_on});
    }
    for (const Field& field : told) {
      if (how == Change::kHighBit && yes_or_no.contains(field)) continue;
      out.push_back({name + field.kind + ": " + field.path,
                     "A field is something else.",
                     {},
                     changed_notice(field.kind, field.path, how),
                     field.acts_on});
    }
  }
  return out;
}

}  // namespace rubric::mutants
