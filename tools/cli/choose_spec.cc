#include "tools/cli/choose_spec.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "codec/containers/reader.h"
#include "codec/lines/address.h"
#include "codec/lines/line.h"
#include "codec/reflect/frame.h"
#include "codec/text/packed.h"
#include "codec/text/text.h"
#include "tools/cli/fcs.h"
#include "tools/cli/input_file.h"
#include "tools/cli/reading.h"
#include "tools/cli/specs.h"

namespace rubric::cli {
namespace {

constexpr const char* kUsual = "rubicon";
constexpr std::size_t kPacketsMost = 1000;

/// Packets with an active message from the beginning of a file.
struct Sample {
  std::vector<Packet> packets;
  std::vector<std::vector<std::uint8_t>> bytes;
};

/// What a spec makes of a sample.
struct Fit {
  std::size_t messages = 0;
  std::size_t wholly = 0;
  std::size_t partly = 0;
  std::size_t points() const { return 2 * wholly + partly; }
};

Bytes view(const std::vector<std::uint8_t>& bytes) { return {bytes.data(), bytes.size()}; }

std::vector<std::uint8_t> plain_beginning(const std::vector<std::uint8_t>& bytes) {
  const auto unpacker = text::make_unpacker(text::packing_of(view(bytes)));
  if (!unpacker) return bytes;
  std::vector<std::uint8_t> out(kBeginningMost);
  Bytes rest = view(bytes);
  std::size_t size = 0;
  try {
    while (size < out.size()) {
      const std::size_t got = unpacker->unpack(rest, {out.data() + size, out.size() - size});
      if (got == 0) break;
      size += got;
    }
  } catch (const text::PackedDamage&) {
    // Who reads the file says so.
  }
  out.resize(size);
  return out;
}

Sample sample_of(const InputOptions& options, Bytes beginning) {
  Sample sample;
  const Reading reading = reading_of(options, beginning);
  const std::unique_ptr<Reader> reader = make_reader(reading.format, reading.options);
  if (!reader) return sample;
  auto take = [&](Packet packet) {
    reread_fcs(reading.fcs, packet);
    const bool sound = packet.error.fault == Fault::kNone;
    if (!sound || packet.bytes.empty() || sample.packets.size() == kPacketsMost) return;
    sample.packets.push_back(packet);
    sample.bytes.emplace_back(packet.bytes.begin(), packet.bytes.end());
  };
  reader->feed(beginning, take);
  // Text needs no end of line; of other formats the rest is a cut frame.
  if (is_text(reading.format)) reader->finish(take);
  for (std::size_t i = 0; i < sample.packets.size(); ++i) {
    sample.packets[i].bytes = view(sample.bytes[i]);
    sample.packets[i].comment = {};
  }
  return sample;
}

Fit fit_of(const reflect::Protocol& protocol, const Sample& sample) {
  const reflect::FrameDecoder decoder(protocol);
  reflect::Frame frame;
  Fit fit;
  for (const Packet& packet : sample.packets) {
    decoder.decode(packet, frame);
    const reflect::Decoded& decoded = frame.decoded;
    fit.messages += frame.am.present;
    const bool fits = frame.am.present && !frame.has_error() && decoded.note_count() == 0;
    if (!fits) continue;
    ++(decoded.stale_count() == 0 ? fit.wholly : fit.partly);
  }
  return fit;
}

// Returns whether an error meets whoever opens or reads that file, however often.
bool is_of_the_file(const std::error_code& error) {
  constexpr std::errc kAll[] = {std::errc::no_such_file_or_directory,
                                std::errc::permission_denied,
                                std::errc::is_a_directory,
                                std::errc::not_a_directory,
                                std::errc::filename_too_long,
                                std::errc::too_many_symbolic_link_levels};
  return std::any_of(std::begin(kAll), std::end(kAll), [&](std::errc one) { return error == one; });
}

/// The protocol that fits best, and why.
struct Choice {
  const reflect::Protocol* usual;
  const reflect::Protocol* best;
  Fit usual_fit;
  Fit best_fit;

  std::string reason() const {
    return fmt::format("{}, which decodes {} of its first {} messages wholly, {} {}", best->id,
                       best_fit.wholly, usual_fit.messages, usual->id, usual_fit.wholly);
  }
};

std::string first_file(const InputOptions& options) {
  return options.files.empty() ? "-" : options.files.front();
}

// Throws std::system_error if the file cannot be read now, but perhaps later.
Choice best_choice(const InputOptions& options) {
  const reflect::Protocol& usual = protocol_of(kUsual);
  Choice choice{&usual, &usual, {}, {}};
  if (options.follow || !options.as_message.empty()) return choice;
  const std::string file = first_file(options);
  if (options.files.empty() && lines::asked_by_motecom()) return choice;
  std::vector<std::uint8_t> beginning;
  try {
    if (lines::parse_address(file)) return choice;
    beginning = plain_beginning(beginning_of(file));
  } catch (const std::invalid_argument&) {
    return choice;  // Who reads the file says what is wrong.
  } catch (const std::system_error& error) {
    if (is_of_the_file(error.code())) return choice;
    throw std::system_error(error.code(), file);  // The file may be read yet, by another spec.
  }
  const Sample sample = sample_of(options, view(beginning));
  choice.usual_fit = choice.best_fit = fit_of(usual, sample);
  if (2 * choice.usual_fit.wholly >= choice.usual_fit.messages) return choice;
  for (const std::string& name : protocol_names()) {
    if (!chosen_by_content(name)) continue;
    const reflect::Protocol& other = protocol_of(name);
    const Fit fit = fit_of(other, sample);
    if (fit.points() <= choice.best_fit.points()) continue;
    choice.best = &other;
    choice.best_fit = fit;
  }
  return choice;
}

void say(const InputOptions& options, const std::string& what) {
  const std::string file = first_file(options);
  text::print(stderr, "rubric: {}: {}\n", file == "-" ? "stdin" : file, what);
}

}  // namespace

const reflect::Protocol& choose_spec(const InputOptions& options) {
  const Choice choice = best_choice(options);
  if (choice.best != choice.usual) {
    say(options, fmt::format("read by the spec {} (--spec chooses another)", choice.reason()));
  }
  return *choice.best;
}

void say_if_another_spec_fits(const InputOptions& options) {
  try {
    const Choice choice = best_choice(options);
    if (choice.best == choice.usual) return;
    say(options,
        fmt::format("its messages fit {} less well than {}", choice.usual->id, choice.reason()));
  } catch (const std::system_error&) {
    return;  // Who reads the file says it.
  }
}

}  // namespace rubric::cli
