#include "conformance/test/targets/serve.h"

#include <fmt/format.h>
#include <sys/types.h>

#include <algorithm>
#include <cstdlib>
#include <optional>

#include "conformance/generated/profiles.h"
#include "conformance/test/targets/rct_text.h"
#include "conformance/trace/events/lines.h"
#include "conformance/trace/value_text.h"

namespace rubric::targets {
namespace {

using machine::Event;
using runner::Unsupported;

Ticks time_of(std::string_view word) {
  const auto time = number_of(word, kTicksMax);
  if (!time) throw Unsupported(fmt::format("{} is not a time", word));
  return *time;
}

void expect_end(const Words& words) {
  if (!words.at_end()) throw Unsupported(fmt::format("{} is too much", words.rest()));
}

machine::Link line_of(std::string_view word) {
  const auto link = link_of(word);
  if (!link) throw Unsupported(fmt::format("{} is not a line", word));
  return *link;
}

// Returns whether it is the second of two words.
bool choice(std::string_view word, std::string_view no, std::string_view yes) {
  if (word != no && word != yes)
    throw Unsupported(fmt::format("{} is not {} or {}", word, no, yes));
  return word == yes;
}

// The parts of a command besides its time, and the bytes that its event refers to.
struct Told {
  Event event;
  std::vector<std::uint8_t> bytes;
  trace::Concrete message;
};

void read_frame(Words words, Told& out) {
  machine::Frame frame{.link = line_of(words.next())};
  const std::string_view hex = words.next();
  if (std::string wrong = frame_of(hex, frame, out.bytes); !wrong.empty()) {
    std::string packet;
    if (frame.link != machine::Link::kSerial || hex.empty() ||
        !trace::read_hex_bytes(hex, packet)) {
      throw Unsupported(wrong);
    }
    out.bytes.assign(packet.begin(), packet.end());  // No active message.
    frame.packet = Bytes(out.bytes.data(), out.bytes.size());
  }
  expect_end(words);
  out.event = machine::Heard{frame};
}

void read_call(std::string_view text, Told& out) {
  if (std::string wrong = read_plain(text, out.message); !wrong.empty()) throw Unsupported(wrong);
  const auto call = events::to_call(out.message);
  if (!call) throw Unsupported(fmt::format("{} is not a call", text));
  out.event = machine::Called{*call};
}

Event read_line_state(Words words) {
  const std::string_view link = words.next();
  const bool busy = choice(words.next(), "idle", "busy");
  expect_end(words);
  if (link == "app") return machine::AppBusy{busy};
  return machine::LinkBusy{line_of(link), busy};
}

Event read_last(std::string_view command, Words words) {
  const bool yes =
      command == "linkack" ? choice(words.next(), "0", "1") : choice(words.next(), "off", "reboot");
  expect_end(words);
  if (command == "linkack") return machine::SendDone{machine::Link::kRadio, yes};
  if (yes) return machine::Reboot{};
  return machine::PowerOff{};
}

void read_event(std::string_view command, Words words, Told& out) {
  if (command == "rx") return read_frame(words, out);
  if (command == "call") return read_call(words.rest(), out);
  out.event = command == "line" ? read_line_state(words) : read_last(command, words);
}

std::uint16_t number_behind(std::string_view word, std::string_view name) {
  const auto number = number_of(word.substr(name.size()), 0xFFFF);
  if (!number) throw Unsupported(fmt::format("{} is not a number", word));
  return static_cast<std::uint16_t>(*number);
}

machine::Config read_config(Words words) {
  machine::Config config;
  const std::string_view role = words.next();
  const auto known = role_of(role);
  if (!known) throw Unsupported(fmt::format("{} is not a role", role));
  config.role = *known;
  trace::Statement stated;
  while (!words.at_end()) {
    const std::string_view word = words.next();
    if (word.starts_with("id=")) {
      config.id = number_behind(word, "id=");
    } else if (word.starts_with("island=")) {
      config.island = number_behind(word, "island=");
    } else if (word.starts_with("seed=")) {
      const std::uint32_t seed = number_behind(word, "seed=");
      config.first_seq = static_cast<std::uint16_t>(1000 + 257 * seed);
    } else if (word.starts_with("profile=")) {
      const machine::NamedProfile* profile = machine::find_profile(word.substr(8));
      if (!profile) throw Unsupported(fmt::format("{} is not known", word));
      config.profile = profile->profile;
    } else if (std::string wrong = trace::add_stated(word, stated); !wrong.empty()) {
      throw Unsupported(wrong);
    }
  }
  events::state(config.profile, stated);
  return config;
}

bool is_event(std::string_view word) {
  return word == "rx" || word == "call" || word == "linkack" || word == "line" || word == "power";
}

}  // namespace

std::string Server::answer(std::string_view command) {
  Words words(command);
  const std::string_view word = words.next();
  try {
    // An answer quotes its command, so that has to be printable itself.
    if (std::string wrong = unprintable(command); !wrong.empty()) throw Unsupported(wrong);
    if (word == "hello") return hello(words.rest());
    if (word == "bye") {
      ended_ = true;
      return {};
    }
    if (word == "reset") return reset(words.rest());
    const bool event_word = is_event(word);
    if (!event_word && word != "until") {
      throw Unsupported(fmt::format("the command {} is not known", word));
    }
    if (!started_) throw Unsupported(fmt::format("{} before reset", word));
    return event_word ? event(word, words.rest()) : until(words.rest());
  } catch (const Unsupported& error) {
    return fmt::format("unsupported {}\n", error.what());
  }
}

std::string Server::hello(std::string_view words) {
  if (!words.starts_with("rct/") || !number_of(words.substr(4), 1'000'000)) {
    throw Unsupported("this is not a version");
  }
  std::string roles;
  for (const machine::Role role : identity_.roles) {
    roles += (roles.empty() ? "" : ",") + std::string(role_word(role));
  }
  std::string links;
  if (identity_.shown) links = " links=" + links_text(*identity_.shown);
  return fmt::format("hello rct/{} {} {} roles={} time={}{}\n", kRctVersion, identity_.name,
                     identity_.version, roles, identity_.real_time ? "real" : "virtual", links);
}

std::string Server::reset(std::string_view words) {
  const machine::Config config = read_config(Words(words));
  target_.reset(config);
  target_.hold_link_acks(true);
  outputs_sent_ = 0;
  started_ = true;
  return "ready\n";
}

std::string Server::event(std::string_view word, std::string_view rest) {
  Words words(rest);
  const Ticks time = time_of(words.next());
  Told told;
  read_event(word, words, told);
  target_.give(time, told.event);
  const std::optional<runner::Window> given = target_.given();
  return done(given ? given->to : time);
}

std::string Server::until(std::string_view rest) {
  Words words(rest);
  const Ticks time = time_of(words.next());
  expect_end(words);
  return done(target_.run_until(time));
}

std::string Server::done(Ticks time) {
  std::string out;
  for (const std::vector<Output>& all = target_.outputs(); outputs_sent_ < all.size();
       ++outputs_sent_) {
    out += output_line(all[outputs_sent_]) + '\n';
  }
  const auto next = target_.next();
  if (next) out += fmt::format("next {}\n", std::max(*next, time));
  if (!next && !identity_.real_time) out += "next -\n";
  return out + fmt::format("done {}\n", time);
}

int serve(runner::Target& target, const Identity& identity, std::FILE* in, std::FILE* out) {
  Server server(target, identity);
  char* line = nullptr;
  std::size_t room = 0;
  while (!server.ended()) {
    const ssize_t size = ::getline(&line, &room, in);
    if (size <= 0) break;
    std::string_view command(line, static_cast<std::size_t>(size));
    if (command.ends_with('\n')) command.remove_suffix(1);
    const std::string answer = server.answer(command);
    if (std::fwrite(answer.data(), 1, answer.size(), out) != answer.size()) break;
    if (std::fflush(out) != 0) break;
  }
  std::free(line);
  return server.ended() ? 0 : 1;
}

}  // namespace rubric::targets
