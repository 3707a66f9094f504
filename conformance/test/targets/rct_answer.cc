#include "conformance/test/targets/rct_answer.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "codec/reflect/requirements.h"
#include "conformance/trace/events/lines.h"
#include "conformance/trace/schema.h"
#include "conformance/trace/value_text.h"

namespace rubric::targets {
namespace {

using runner::TargetBroken;
using trace::quoted;

constexpr std::size_t kLinesMax = 10'000;  // In an answer.
constexpr std::size_t kShownMax = 100;     // From a line, in an error.

// These two return what is wrong.
std::string read_roles(std::string_view list, std::vector<machine::Role>& out) {
  while (!list.empty()) {
    const std::size_t size = std::min(list.find(','), list.size());
    const auto role = role_of(list.substr(0, size));
    if (!role) {
      return quoted(list.substr(0, size)) +
             " is not a role: " + trace::alternatives(trace::role_names());
    }
    if (std::find(out.begin(), out.end(), *role) != out.end()) {
      return "it says the role " + std::string(list.substr(0, size)) + " twice";
    }
    out.push_back(*role);
    list.remove_prefix(std::min(size + 1, list.size()));
  }
  return {};
}
std::string read_time(std::string_view word, bool& real) {
  real = word == "real";
  return real || word == "virtual" ? std::string()
                                   : quoted(word) + " is not a time: virtual or real";
}
std::string read_links(std::string_view list, std::optional<runner::Reach>& out) {
  out = links_of(list);
  return out ? std::string() : quoted(list) + " are no links: of app, peis, radio and serial";
}

bool is_family(std::string_view text) {
  return std::ranges::any_of(reflect::requirements(), [&](const auto& one) {
    const std::string_view id = one.id;
    return id.size() > text.size() && id.starts_with(text) && id[text.size()] == '-';
  });
}

}  // namespace

std::string shown(std::string_view line) {
  std::string out;
  for (const char c : line.substr(0, kShownMax)) {
    const auto byte = static_cast<unsigned char>(c);
    out += byte < 0x20 || byte > 0x7E ? fmt::format("\\x{:02x}", byte) : std::string(1, c);
  }
  return line.size() > kShownMax ? quoted(out + "...") : quoted(out);
}

void AnswerReader::fail(const std::string& what) const {
  throw TargetBroken(
      fmt::format("line {} of the answer to `{}`: {}", lines_, asked_.command, what));
}

bool AnswerReader::take(std::string_view line) {
  if (++lines_ > kLinesMax) fail(fmt::format("an answer of more than {} lines", kLinesMax));
  if (std::string wrong = unprintable(line); !wrong.empty()) fail(wrong + " in " + shown(line));
  Words words(line);
  const std::string_view word = words.next();
  if (word == "note") {
    if (answer_.notes_bytes + line.size() + 1 > kNotesBytesMax) {
      ++answer_.notes_left_out;
    } else {
      answer_.notes_bytes += line.size() + 1;
      answer_.notes.emplace_back(words.rest());
    }
    return false;
  }
  if (word == "unsupported") {
    throw runner::Refused(
        fmt::format("`{}`: {}", asked_.command, words.at_end() ? "unsupported" : words.rest()));
  }
  if (word == asked_.closing) {
    closing_ = line;
    if (word == "done") done(words);
    return true;
  }
  const bool speaks = asked_.closing == "done";
  if (speaks && word == "tx") {
    tx(words);
  } else if (speaks && word == "up") {
    up(words);
  } else if (speaks && word == "next") {
    next(words);
  } else {
    fail(fmt::format("expected {}`{}`, given {}", speaks ? "tx, up, next, note or " : "",
                     asked_.closing, shown(line)));
  }
  return false;
}

Ticks AnswerReader::time(std::string_view word) const {
  const auto read = number_of(word, kTicksMax);
  if (!read) fail(fmt::format("{} is not a time in ticks", quoted(word)));
  return *read;
}

Ticks AnswerReader::output_time(Words& words) {
  const Ticks at = time(words.next());
  const Ticks least = answer_.outputs.empty() ? asked_.from : answer_.outputs.back().time;
  if (at < least) fail(fmt::format("its time is {}, and {} has passed", at, least));
  if (at > asked_.to && !asked_.real_time) {
    fail(fmt::format("its time is {}, to come after {}", at, asked_.to));
  }
  return at;
}

// Removes the rules at the end, `[J4-ACK]`, from the line; returns the first that is more than a
// family.
ReqId AnswerReader::requirement(std::string_view& line) const {
  const std::size_t open = line.ends_with(']') ? line.rfind(" [") : std::string_view::npos;
  if (open == std::string_view::npos) return ReqId::kNone;
  Words words(line.substr(open + 2, line.size() - open - 3));
  ReqId out = ReqId::kNone;
  do {
    const std::string_view word = words.next();
    const ReqId id = trace::requirement_id(word);
    if (id == ReqId::kNone && !is_family(word)) {
      fail(fmt::format("{} is not a rule of the catalogue", quoted(word)));
    }
    if (out == ReqId::kNone) out = id;
  } while (!words.at_end());
  line = line.substr(0, open);
  return out;
}

void AnswerReader::add(Output output) {
  if (asked_.passes_time && !asked_.real_time && !answer_.outputs.empty() &&
      answer_.outputs.back().time != output.time) {
    fail(
        fmt::format("its time is {}, but `until` ends at the first instant at which something is "
                    "written, {}",
                    output.time, answer_.outputs.back().time));
  }
  answer_.outputs.push_back(std::move(output));
}

void AnswerReader::tx(Words words) {
  Output output{.time = output_time(words), .is_frame = true};
  const std::string_view link = words.next();
  const auto which = link_of(link);
  if (!which) fail(fmt::format("{} is not a link: radio, serial or peis", quoted(link)));
  machine::Frame frame;
  std::vector<std::uint8_t> bytes;
  if (std::string wrong = frame_of(words.next(), frame, bytes); !wrong.empty()) fail(wrong);
  std::string_view rest = words.rest();
  std::string padded = " " + std::string(rest);
  rest = padded;
  output.requirement = requirement(rest);
  output.frame.link_ack = rest == " linkack";
  if (!output.frame.link_ack && rest.size() > 1) {
    fail(fmt::format("expected `linkack` or the end after the frame, given {}",
                     shown(rest.substr(1))));
  }
  if (output.frame.link_ack && *which != machine::Link::kRadio) {
    fail("only frames by radio ask for the radio's acknowledgement");
  }
  output.frame.link = *which;
  output.frame.type = frame.type;
  output.frame.dest = frame.dest;
  output.frame.src = frame.src;
  output.frame.size_bytes = static_cast<std::uint8_t>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), output.frame.payload.begin());
  add(std::move(output));
}

void AnswerReader::up(Words words) {
  Output output{.time = output_time(words)};
  std::string_view text = words.rest();
  output.requirement = requirement(text);
  trace::Concrete message;
  if (std::string wrong = read_plain(text, message); !wrong.empty()) {
    fail(fmt::format("{}: {}", shown(text), wrong));
  }
  if (trace::Schema::get().find(message.name)->app->what != trace::AppWhat::kEvent) {
    fail(fmt::format("{} is not an event or result for an application", shown(text)));
  }
  output.news = std::move(message.message);
  add(std::move(output));
}

void AnswerReader::next(Words words) {
  const std::string_view word = words.next();
  if (!words.at_end()) fail(fmt::format("{} is too much", shown(words.rest())));
  answer_.has_next = true;
  answer_.next.reset();
  if (word != "-") answer_.next = time(word);
}

void AnswerReader::done(Words words) {
  const Ticks at = time(words.next());
  if (!words.at_end()) fail(fmt::format("{} is too much", shown(words.rest())));
  answer_.done = at;
  const bool silent = answer_.outputs.empty();
  const Ticks least = silent ? asked_.from : answer_.outputs.back().time;
  if (at < least) fail(fmt::format("done at {}, when {} has passed", at, least));
  if (answer_.next && *answer_.next < at) {
    fail(fmt::format("next at {}, which is before {}", *answer_.next, at));
  }
  if (asked_.real_time) {
    if (asked_.passes_time && silent && at < asked_.to) {
      fail(fmt::format("done at {}, when nothing was written and {} has not come", at, asked_.to));
    }
    return;
  }
  const Ticks expected = asked_.passes_time && !silent ? least : asked_.to;
  if (at != expected) fail(fmt::format("done at {}, expected {}", at, expected));
}

Identity read_hello(const std::string& line) {
  const auto broken = [&](const std::string& why) {
    return TargetBroken(
        fmt::format("the answer to `hello rct/{}`, {}: {}", kRctVersion, shown(line), why));
  };
  Words words(line);
  words.next();
  const std::string_view version = words.next();
  const auto number =
      version.starts_with("rct/") ? number_of(version.substr(4), 1'000'000) : std::nullopt;
  if (!number) throw broken(quoted(version) + " is not a version, such as rct/1");
  if (*number != kRctVersion) {
    throw broken(fmt::format("it speaks version {} of the protocol, the runner no other than {}",
                             *number, kRctVersion));
  }
  Identity out{.name = std::string(words.next()), .version = std::string(words.next())};
  if (out.name.empty() || out.version.empty()) throw broken("it lacks its name or version");
  std::set<std::string_view> keys;
  const std::string known = "roles, time, links, " + trace::parameter_names();
  while (!words.at_end()) {
    const std::string_view word = words.next();
    const std::size_t size = word.find('=');
    if (size == 0 || size == std::string_view::npos) {
      throw broken(quoted(word) + " is not key=value, such as roles=mote; known are " + known);
    }
    const std::string_view key = word.substr(0, size);
    const std::string_view value = word.substr(size + 1);
    if (key != "roles" && key != "time" && key != "links") {
      if (!trace::find_parameter(key)) {
        throw broken(quoted(key) + " is nothing that `hello` says; known are " + known);
      }
      std::string wrong = trace::add_stated(word, out.stated);
      if (!wrong.empty()) throw broken(wrong);
      continue;
    }
    if (!keys.insert(key).second) throw broken(fmt::format("it says {}= twice", key));
    std::string wrong;
    if (key == "roles") wrong = read_roles(value, out.roles);
    if (key == "time") wrong = read_time(value, out.real_time);
    if (key == "links") wrong = read_links(value, out.shown);
    if (!wrong.empty()) throw broken(wrong);
  }
  const std::string wrong = events::contradiction(out.stated);
  if (!wrong.empty()) throw broken(wrong);
  if (out.roles.empty()) throw broken("it says no roles=");
  return out;
}

}  // namespace rubric::targets
