#include "conformance/test/targets/rct_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "conformance/trace/events/lines.h"
#include "conformance/trace/parse.h"
#include "conformance/trace/schema.h"
#include "conformance/trace/value_text.h"

namespace rubric::targets {
namespace {

using machine::Link;
using machine::Role;
using trace::Value;

constexpr std::string_view kLinkWords[] = {"radio", "serial", "peis"};

struct LinkShown {
  std::string_view word;
  bool runner::Reach::*shown;
};
constexpr LinkShown kLinksShown[] = {{"app", &runner::Reach::app},
                                     {"peis", &runner::Reach::peis},
                                     {"radio", &runner::Reach::radio},
                                     {"serial", &runner::Reach::serial}};

template <class T, std::size_t N>
std::optional<T> find_word(const std::string_view (&words)[N], std::string_view word) {
  const auto* const found = std::find(std::begin(words), std::end(words), word);
  if (found == std::end(words)) return std::nullopt;
  return static_cast<T>(found - std::begin(words));
}

bool is_pattern(const Value& value) {
  return value.negated || value.is(Value::Kind::kAny) || value.is(Value::Kind::kRange) ||
         value.is(Value::Kind::kVariable) ||
         std::any_of(value.items.begin(), value.items.end(), is_pattern);
}

}  // namespace

std::string_view Words::next() {
  const std::size_t size = std::min(rest_.find(' '), rest_.size());
  const std::string_view word = rest_.substr(0, size);
  rest_.remove_prefix(std::min(size + 1, rest_.size()));
  return word;
}

std::optional<std::uint32_t> number_of(std::string_view text, std::uint32_t max) {
  std::uint32_t out = 0;
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, out);
  if (text.empty() || error != std::errc() || at != end || out > max) return std::nullopt;
  return out;
}

std::string_view link_word(Link link) { return kLinkWords[static_cast<std::size_t>(link)]; }
std::optional<Link> link_of(std::string_view word) { return find_word<Link>(kLinkWords, word); }
std::string_view role_word(Role role) { return trace::role_text(static_cast<trace::Role>(role)); }
std::optional<Role> role_of(std::string_view word) {
  const std::optional<trace::Role> role = trace::find_role(word);
  return role ? std::optional(static_cast<Role>(*role)) : std::nullopt;
}

std::string links_text(const runner::Reach& links) {
  std::string out;
  for (const LinkShown& one : kLinksShown) {
    if (links.*one.shown) out += (out.empty() ? "" : ",") + std::string(one.word);
  }
  return out;
}

std::optional<runner::Reach> links_of(std::string_view text) {
  runner::Reach out{false, false, false, false};
  while (true) {
    const std::size_t size = std::min(text.find(','), text.size());
    const auto* const found =
        std::find_if(std::begin(kLinksShown), std::end(kLinksShown),
                     [&](const LinkShown& one) { return one.word == text.substr(0, size); });
    if (found == std::end(kLinksShown)) return std::nullopt;
    out.*found->shown = true;
    if (size == text.size()) return out;
    text.remove_prefix(size + 1);
  }
}

std::string unprintable(std::string_view line) {
  for (std::size_t i = 0; i < line.size(); ++i) {
    const auto byte = static_cast<unsigned char>(line[i]);
    if (byte < 0x20 || byte > 0x7E) {
      return fmt::format("byte 0x{:02x} at column {} is not printable ASCII", byte, i + 1);
    }
  }
  return {};
}

std::string hex_of(const machine::Frame& frame) {
  const std::vector<std::uint8_t> packet = events::packet_of(frame);
  std::string out;
  trace::put_hex({reinterpret_cast<const char*>(packet.data()), packet.size()}, out);
  return out;
}

std::string frame_of(std::string_view hex, machine::Frame& frame,
                     std::vector<std::uint8_t>& bytes) {
  std::string packet;
  if (hex.empty() || !trace::read_hex_bytes(hex, packet)) {
    return fmt::format("{} is not an even number of hex digits", trace::quoted(hex));
  }
  trace::AmFrame am;
  if (!trace::parse_packet(packet, am)) {
    return fmt::format("{} is not a packet: 00, destination, source, length, group, type, payload",
                       trace::quoted(hex));
  }
  if (am.payload.size() > machine::kAmPayloadMax) {
    return fmt::format("a payload of {} bytes, of {} at most", am.payload.size(),
                       machine::kAmPayloadMax);
  }
  bytes = std::move(am.payload);
  frame.dest = am.dest;
  frame.src = am.src;
  frame.type = am.type;
  frame.payload = Bytes(bytes.data(), bytes.size());
  return {};
}

std::string plain(const trace::Message& message) {
  const trace::Concrete from = trace::concrete(message);
  std::string out = from.name + '(';
  const char* between = "";
  for (std::size_t i = 0; i < from.leaves.size();) {
    const auto part = std::find_if(from.parts.begin(), from.parts.end(),
                                   [&](const trace::Part& one) { return one.first == i; });
    const bool pair = part != from.parts.end();
    out += fmt::format("{}{}=", between, pair ? part->path : from.leaves[i].path);
    between = " ";
    const auto number = [&](std::size_t index) { return Value::of(from.leaves[index].number); };
    if (!pair) {
      out += trace::value_text(from.leaves[i].value());
      ++i;
      continue;
    }
    out += trace::value_text(part->kind == trace::Slot::Kind::kAddress
                                 ? Value::address(number(i), number(i + 1))
                                 : Value::channel(number(i), number(i + 1)));
    i = part->end;
  }
  return out + ')';
}

std::string read_plain(std::string_view text, trace::Concrete& out) {
  trace::Message message;
  if (std::string wrong = trace::parse_message(text, message); !wrong.empty()) return wrong;
  const bool pattern = message.open || message.form == trace::Message::Form::kAny ||
                       std::any_of(message.fields.begin(), message.fields.end(),
                                   [](const auto& field) { return is_pattern(field.value); });
  if (pattern) return "expected a plain value, not a pattern";
  try {
    out = trace::concrete(message);
    if (message.fields.size() > trace::Schema::get().find(message.name)->app->fields.size()) {
      return "a field is given twice";
    }
  } catch (const trace::TraceError& error) {
    return error.what();
  }
  return {};
}

std::string output_line(const Output& output) {
  std::string out;
  if (output.is_frame) {
    out = fmt::format("tx {} {} {}", output.time, link_word(output.frame.link),
                      hex_of(output.frame.frame()));
    if (output.frame.link_ack) out += " linkack";
  } else {
    out = fmt::format("up {} {}", output.time, plain(output.news));
  }
  if (output.requirement != ReqId::kNone) {
    out += fmt::format(" [{}]", trace::requirement_text(output.requirement));
  }
  return out;
}

}  // namespace rubric::targets
