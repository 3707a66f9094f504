#include "tools/cli/input.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "codec/containers/link_record.h"
#include "codec/containers/reader.h"
#include "codec/containers/zep_packet.h"
#include "codec/generated/tinyos/am_header.h"
#include "codec/lines/air.h"
#include "codec/lines/broken.h"
#include "codec/lines/line.h"
#include "codec/lines/stop.h"
#include "codec/reflect/fault_text.h"
#include "codec/reflect/suggest.h"
#include "codec/text/text.h"
#include "tools/cli/choose_spec.h"
#include "tools/cli/fcs.h"
#include "tools/cli/input_file.h"
#include "tools/cli/progress.h"
#include "tools/cli/reading.h"
#include "tools/cli/specs.h"
#include "tools/cli/verdict.h"

namespace rubric::cli {
namespace {

constexpr std::size_t kChunkBytes = 256 * 1024;
constexpr std::size_t kDetectBytes = 4096;
constexpr std::size_t kDetectMost = 64 * 1024;
/// Bound of a bare message in a binary file, so that memory stays flat whatever is read.
constexpr std::size_t kBareMost = kDetectMost;

constexpr std::chrono::milliseconds kReconnectEvery{1000};
constexpr std::chrono::milliseconds kAirPatience{100};

/// Returns what a link type holds that is not read here; empty where nobody meets it with motes.
std::string_view foreign_link_name(std::uint16_t link_type) {
  switch (link_type) {
    case 105: return " (802.11)";
    case 127: return " (802.11 with radiotap header)";
    case 189:
    case 220: return " (USB)";
    case 249: return " (USBPcap)";
    case 187:
    case 201: return " (Bluetooth HCI)";
    case 251:
    case 256: return " (Bluetooth Low Energy)";
    default: return "";
  }
}

/// Returns the files. Without FILE at a terminal it is $MOTECOM, since nobody types frames.
std::vector<std::string> names_of(const InputOptions& options) {
  if (!options.files.empty()) return options.files;
  return {lines::asked_by_motecom() ? lines::default_address() : "-"};
}

std::uint64_t total_size(const std::vector<std::string>& files) {
  std::uint64_t total = 0;
  for (const std::string& file : files) {
    struct stat status {};
    const int got = file == "-" ? ::fstat(0, &status) : ::stat(file.c_str(), &status);
    if (got != 0 || !S_ISREG(status.st_mode)) return 0;
    total += static_cast<std::uint64_t>(status.st_size);
  }
  return total;
}

/// One run over all files.
class Run {
 public:
  Run(const InputOptions& options, const OnPacket& on_packet, const OnIdle& on_idle,
      const OtherText& other)
      : options_(options),
        on_packet_(on_packet),
        on_idle_(on_idle),
        other_(other),
        files_(names_of(options)),
        chunk_(std::make_unique_for_overwrite<std::uint8_t[]>(kChunkBytes)),
        progress_(total_size(files_), options.progress, options.prints) {}

  InputResult all() {
    for (std::size_t i = 0; i < files_.size() && !result_.stopped; ++i) {
      source_.file = files_[i];
      source_.file_index = i;
      source_.number = 0;
      try {
        const std::optional<lines::Address> address = lines::parse_address(files_[i]);
        if (!address) {
          one();
        } else if (address->kind == lines::Address::Kind::kAir) {
          air(*address);
        } else {
          line(*address);
        }
      } catch (const std::system_error& error) {
        complain(std::strerror(error.code().value()));
      } catch (const FileChanged& changed) {
        complain(changed.what());
      } catch (const std::invalid_argument& error) {
        complain(error.what());
      }
    }
    result_.damaged = damaged_ && !result_.failed;
    result_.failed = result_.failed || damaged_;
    return result_;
  }

 private:
  void remark(std::string_view what) {
    progress_.clear();
    const std::string_view name = source_.file == "-" ? "stdin" : source_.file;
    text::print(stderr, "rubric: {}: {}\n", name, what);
  }

  void complain(std::string_view what) {
    result_.failed = true;
    remark(what);
  }

  // Reads a line in use, until it ends or the user stops it.
  void line(const lines::Address& address) {
    lines::stop_on_signals();
    result_.live = true;
    const bool failed_before = result_.failed;  // Failures of other lines stay.
    lost_ = false;
    auto opened = std::exchange(open_lines_[address.name], {}).line;
    const bool is_open = opened != nullptr;  // Then nobody asks to open it again.
    if (!is_open) opened = std::make_shared<lines::Line>(address, options_.listen_only);
    lines::Line& line = *opened;
    source_.format = format_name(line.format());
    ReaderOptions reader_options{.direction = Direction::kOutbound, .interface_name = address.name};
    while (!lines::stop_requested() && !result_.stopped) {
      const std::unique_ptr<Reader> reader = make_reader(line.format(), reader_options);
      try {
        if (!is_open) line.open(std::chrono::steady_clock::now() + kReconnectEvery);
        if (std::exchange(lost_, false)) text::print(stderr, "rubric: {}: again\n", address.name);
        pump_line(line, *reader);
      } catch (const lines::Broken& broken) {
        if (!lost_) complain(broken.what());
        lost_ = true;
        if (!options_.reconnect) return;
        if (on_idle_) on_idle_();
        std::this_thread::sleep_for(kReconnectEvery);
      }
    }
    result_.failed = failed_before || lost_;
  }

  // Listens to a virtual air until the user stops it.
  void air(const lines::Address& address) {
    lines::stop_on_signals();
    result_.live = true;
    source_.format = "zep";
    const std::vector<Interface> interfaces = {{address.name, {}, 0, 1'000'000, 0}};
    const auto before = std::exchange(open_lines_[address.name], {}).air;
    const auto opened = before ? before : std::make_shared<lines::Air>(address.at);
    lines::Air& air = *opened;
    try {
      if (!before) air.open();
      if (address.at.port == 0) text::print(stderr, "rubric: zep:{}\n", air.port());
      while (!lines::stop_requested() && !result_.stopped) {
        const Bytes datagram = air.receive(std::chrono::steady_clock::now() + kAirPatience);
        Packet packet;
        if (!datagram.empty() && decode_zep_datagram(datagram, packet)) {
          packet.time_ns = lines::air_time_ns(packet.time_ns);
          give(packet, interfaces);
        }
        if (on_idle_) on_idle_();
      }
    } catch (const lines::Broken& broken) {
      complain(broken.what());
    }
  }

  void pump_line(lines::Line& line, Reader& reader) {
    std::int64_t now_ns = 0;
    std::optional<lines::Broken> unanswered;  // Reported when all that had come was delivered.
    auto deliver = [&](const Packet& packet) {
      Packet stamped = packet;
      stamped.time_ns = now_ns;
      give(stamped, reader.interfaces());
      try {
        if (!unanswered && !result_.stopped) line.answer(packet);
      } catch (const lines::Broken& broken) {
        unanswered = broken;
      }
    };
    try {
      while (!lines::stop_requested() && !result_.stopped) {
        const std::size_t size = line.read(MutableBytes(chunk_.get(), kChunkBytes));
        now_ns = std::chrono::system_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
        if (size) reader.feed(Bytes(chunk_.get(), size), deliver);
        if (on_idle_) on_idle_();
        if (size == 0 && unanswered) throw *unanswered;
      }
    } catch (const lines::Broken&) {
      reader.finish(deliver);  // With an unfinished frame.
      throw;
    }
  }

  void one() {
    if (options_.follow) {
      lines::stop_on_signals();
      result_.live = true;
    }
    passed_over_.clear();
    packets_of_.clear();
    doubted_.clear();
    InputFile file(files_[source_.file_index], options_.follow, on_idle_);
    packed_damage_ = false;
    read(file);
    say_packed_damage(file);
  }

  void read(InputFile& file) {
    const bool bare = !options_.as_message.empty();
    InputFormat found = InputFormat::kUnknown;
    // A format that is named needs no look at the content, so that a line of a pipe is read at
    // once.
    std::size_t size = options_.format == "auto" || other_.is_it
                           ? look(file, found)
                           : file.read(chunk_.get(), kChunkBytes);
    const Bytes beginning(chunk_.get(), size);
    if (other_.is_it && other_.is_it(beginning)) return other_.take(source_, rest_of(file, size));
    if (options_.format == "auto") {
      if (size == 0 && !file.damage().empty()) return;
      if (size == 0) return remark("is empty");  // Nothing in it, nothing wrong with it.
      if (found == InputFormat::kUnknown && (!bare || is_hex_dump(beginning))) {
        return complain(unknown_format(beginning));
      }
      if (bare && is_capture(found)) {
        return complain(
            fmt::format("this is {}; --as takes a message alone (--input-format bare "
                        "reads the file as one)",
                        format_name(found)));
      }
      if (found == InputFormat::kJsonl && !bare) {
        return complain("this is JSON; 'rubric encode' reads it");
      }
    }
    const Reading reading = reading_of(options_, beginning);
    if (bare && !is_text(reading.format)) return whole(file, size);
    if (!reading.remark.empty()) remark(reading.remark);
    fcs_ = reading.fcs;
    std::unique_ptr<Reader> reader = make_reader(reading.format, reading.options);
    source_.format = format_name(reading.format);
    pump(file, *reader, size);
    if (is_capture(reading.format) && source_.number == 0 && !options_.follow) {
      remark("holds no packets");
    }
    say_what_is_left_out(*reader);
  }

  static std::string unknown_prefix_text(std::uint64_t line, const std::string& prefix) {
    return fmt::format(
        "line {} has hex text after '{}', which is not a known time stamp; known are: "
        "[12.3], (12.3), 12.3, 1764000000, 10:00:00 or 10:00:00 AM, after 2026-11-24, "
        "24.11.2026, 24/11/2026, Nov 24, Nov 24 2026 or no date, and then perhaps 'mote 2:'",
        line, prefix.substr(0, prefix.find_last_not_of(" \t") + 1));
  }

  static bool is_plain_text(std::string_view text) {
    return std::all_of(text.begin(), text.end(), [](char c) {
      return (c >= ' ' && c <= '~') || c == '\t' || c == '\r' || c == '\n';
    });
  }

  static std::string unknown_format(Bytes beginning) {
    if (beginning.size() > 1 && beginning[0] + beginning[1] == 0xFF + 0xFE) {
      return "this is UTF-16 text, as PowerShell writes; 'iconv -f UTF-16 -t UTF-8 FILE' makes "
             "UTF-8 of it";
    }
    if (is_hex_dump(beginning)) {
      return "this is a hex dump with offsets; 'text2pcap -l 195 FILE FILE.pcap' makes a capture "
             "of it (-l 230 for radio frames without FCS, -l 148 for packets from the dispatch "
             "byte on)";
    }
    const std::string_view text(reinterpret_cast<const char*>(beginning.data()), beginning.size());
    if (text.substr(0, text.find('\n')).find(": 15.4 ") != text.npos) {
      return "this is Cooja's list of radio messages as an analyzer shows it, without their bytes; "
             "its menu has 'No Analyzer', and one that writes pcap";
    }
    if (const PrefixedLine line = find_prefixed_line(beginning); line.number != 0) {
      return unknown_prefix_text(line.number, {line.prefix.begin(), line.prefix.end()});
    }
    if (is_plain_text(text)) {
      const bool parted = text.find_first_of(",:-") != text.npos;
      return fmt::format(
          "no line of this text is a packet in hex digits, from the dispatch byte on "
          "or from a flag 7E{}",
          parted ? "; if commas, colons or hyphens part its bytes: tr ',:-' ' ' < FILE" : "");
    }
    return "this is not a serial line, forwarder stream, pcap, pcapng or hex text; choose a format "
           "with "
           "--input-format, or try 'tshark -r FILE -w FILE.pcapng'";
  }

  // Returns the whole text of a file of which `size` bytes are read.
  std::string rest_of(InputFile& file, std::size_t size) {
    std::string out;
    for (; size != 0; size = file.read(chunk_.get(), kChunkBytes)) {
      out.append(reinterpret_cast<const char*>(chunk_.get()), size);
    }
    return out;
  }

  // Says once for a file what in it is nothing for us.
  void say_what_is_left_out(const Reader& reader) {
    const Reader::Noise noise = reader.noise();
    if (noise.lines != 0) {
      std::string what = fmt::format("{} of its lines hold no packet; the first is line {}",
                                     noise.lines, noise.first);
      if (noise.prefixed != 0) what += "; " + unknown_prefix_text(noise.prefixed, noise.prefix);
      remark(what);
    }
    if (!noise.marker.empty()) {
      remark(fmt::format("'{}' before the bytes of its lines is passed over", noise.marker));
    }
    for (const auto& [link_type, count] : doubted_) {
      if (count != packets_of_[link_type]) continue;
      remark(
          fmt::format("none of its packets of link type {0} is sound as {1}; if they are of "
                      "another kind: --link-type {0}=radio-fcs reads them as 802.15.4, for one",
                      link_type, link_type == kLinkSerial ? "a serial frame" : "an AM packet"));
    }
    for (const auto& [link_type, count] : passed_over_) {
      if (is_zep_alone(link_type)) {
        remark(fmt::format("{} of {} packets are ZEP {}, which hold no radio frame", count,
                           source_.number,
                           link_type == kLinkZepAck ? "acks" : "hellos of RIOT's nodes"));
        continue;
      }
      if (is_network_link(link_type)) {
        remark(fmt::format("{} of {} packets are not ZEP packets (UDP port {})", count,
                           source_.number, kZepPort));
        continue;
      }
      const bool user = link_type >= kLinkUserFirst && link_type <= kLinkUserLast;
      const std::string hint =
          user ? fmt::format("; --link-type {}=radio-fcs reads it as 802.15.4, for one", link_type)
               : "";
      const std::string what =
          fmt::format("link type {}{} is not read: {} of {} packets are left out{}", link_type,
                      foreign_link_name(link_type), count, source_.number, hint);
      count == source_.number ? complain(what) : remark(what);
    }
  }

  // Counts packets of link types 147 and 148 where no option says what these hold, and those of
  // them that are not what they are taken for.
  void doubt(const Packet& packet) {
    if (!options_.links.empty() || packet.error.fault == Fault::kCut) return;
    if (packet.link_type != kLinkSerial && packet.link_type != kLinkSf) return;
    ++packets_of_[packet.link_type];
    const bool sound = packet.link_type == kLinkSerial
                           ? packet.error.fault == Fault::kNone
                           : static_cast<bool>(tinyos::AmHeaderView::parse(packet.bytes));
    if (!sound) ++doubted_[packet.link_type];
  }

  // Returns whether a packet is of a link type that is not read.
  static bool is_foreign(const Packet& packet) {
    return packet.error.fault == Fault::kUnsupported && packet.framing == Framing::kBare &&
           packet.link_type != 0;
  }

  // Reads until the content shows its format.
  std::size_t look(InputFile& file, InputFormat& format) {
    std::size_t size = 0;
    bool ended = false;
    while (!ended && size < kDetectMost) {
      const std::size_t got = file.read(chunk_.get() + size, kDetectMost - size);
      size += got;
      ended = got == 0;
      if (!ended && size < kDetectBytes && file.has_more_soon()) continue;
      format = detect(Bytes(chunk_.get(), size));
      if (format != InputFormat::kUnknown) break;
    }
    return size;
  }

  void pump(InputFile& file, Reader& reader, std::size_t size) {
    auto deliver = [&](const Packet& packet) {
      if (fcs_ == FcsKind::kCrc) return give(packet, reader.interfaces());
      Packet reread = packet;
      reread_fcs(fcs_, reread);
      give(reread, reader.interfaces());
    };
    packed_ = file.is_packed();
    while (true) {
      if (size) reader.feed(Bytes(chunk_.get(), size), deliver);
      progress_.advance(size);
      if (result_.stopped) return;
      if (!file.is_regular() && size < kChunkBytes && on_idle_) on_idle_();
      size = file.read(chunk_.get(), kChunkBytes);
      if (size == 0) break;
    }
    say_packed_damage(file);  // Before what it leads to: a frame that is cut.
    reader.finish(deliver);
  }

  void say_packed_damage(const InputFile& file) {
    if (file.damage().empty() || std::exchange(packed_damage_, true)) return;
    damaged_ = true;
    remark(file.damage());
  }

  // Reads a binary file as one message.
  void whole(InputFile& file, std::size_t size) {
    std::vector<std::uint8_t> bytes(chunk_.get(), chunk_.get() + size);
    Packet packet;
    while (const std::size_t got = file.read(chunk_.get(), kChunkBytes)) {
      const std::size_t taken = std::min(got, kBareMost - bytes.size());
      bytes.insert(bytes.end(), chunk_.get(), chunk_.get() + taken);
      packet.dropped_bytes += got - taken;
    }
    packet.bytes = Bytes(bytes.data(), bytes.size());
    if (packet.dropped_bytes) packet.error = Error{Fault::kTooLong, kBareMost, ReqId::kNone};
    source_.format = "bare";
    give(packet, {});
  }

  void give(const Packet& packet, const std::vector<Interface>& interfaces) {
    if (result_.stopped) return;  // Drops the rest of the chunk.
    source_.interface_name = packet.interface_id < interfaces.size()
                                 ? std::string_view(interfaces[packet.interface_id].name)
                                 : std::string_view{};
    if (is_damage(packet)) {
      damaged_ = true;
      const bool follows = packed_damage_ && packet.error.fault == Fault::kCut;
      if (!follows) {
        remark(fmt::format("damaged at byte {}{}: {}", packet.offset_bytes,
                           packed_ ? " of what it unpacks to" : "",
                           reflect::fault_sentence(packet.error.fault)));
      }
    }
    ++source_.number;
    if (is_foreign(packet)) {
      ++passed_over_[packet.link_type];
      return;
    }
    doubt(packet);
    if (!on_packet_(packet, source_)) result_.stopped = true;
  }

  const InputOptions& options_;
  const OnPacket& on_packet_;
  const OnIdle& on_idle_;
  const OtherText& other_;
  const std::vector<std::string> files_;
  std::map<std::string, OpenLine> open_lines_ = options_.open_lines;
  std::unique_ptr<std::uint8_t[]> chunk_;
  Progress progress_;
  Source source_;
  InputResult result_;
  FcsKind fcs_ = FcsKind::kCrc;
  bool damaged_ = false;        // A file has damaged places.
  bool packed_ = false;         // The present file is compressed;
  bool packed_damage_ = false;  // that its compressed bytes are damaged was said.
  // Packets of the present file, by link type: not ours; of types 147 and 148; not sound as those.
  std::map<std::uint16_t, std::uint64_t> passed_over_, packets_of_, doubted_;
  bool lost_ = false;  // The line is gone, and that was said.
};

}  // namespace

void add_input_options(Command& app, InputOptions& options) {
  app.add_option("FILE", options.files,
                 "Captures, in order, compressed by gzip or zstd or not; none or - is stdin");
  add_capture_options(app, options, true);
  options.spec = kAutoSpec;
  add_spec_option(app, options);
  app.add_option(
      "--as", options.as_message,
      "Read the input as this message alone: each line of hex text, or a binary file whole");
}

void add_spec_option(Command& app, InputOptions& options) {
  const std::string by_content =
      options.spec == kAutoSpec ? "; auto is rubicon, unless another decodes more of what is read"
                                : "";
  app.add_option("--spec", options.spec,
                 "Use this protocol above the AM layer: a name (list prints them; none shows bare "
                 "messages), a .ksy file, or several, as a,b: where two have an AM type, the "
                 "first of them has it" +
                     by_content)
      .joined_by(',');
}

void add_live_options(Command& app, InputOptions& options) {
  const auto check = [](const std::string& text) {
    try {
      lines::parse_address(text);
      return std::string();
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
  };
  app.get_option("FILE").check(check).description(
      "Captures, in order; none or - is stdin. Or lines in use: serial@DEVICE:BAUD (or a platform, "
      "as serial@/dev/ttyUSB0:telosb), network@HOST:PORT, sf@HOST:PORT; zep:PORT, radio frames "
      "over "
      "UDP");
  app.add_flag("--follow", options.follow, "Wait for more at the end of a file");
  app.add_flag("--listen-only", options.listen_only,
               "Confirm no frames of a serial line, so that nothing is written to it");
  app.add_flag("--reconnect", options.reconnect, "Open a line again when it comes back");
}

bool goes_on(const InputOptions& options) {
  if (options.follow) return true;
  const std::vector<std::string> names = names_of(options);
  return std::any_of(names.begin(), names.end(), [](const std::string& name) {
    struct stat status {};
    const int got = name == "-" ? ::fstat(0, &status) : ::stat(name.c_str(), &status);
    return got == 0 ? !S_ISREG(status.st_mode) : lines::parse_address(name).has_value();
  });
}

void open_sources(InputOptions& options) {
  for (const std::string& name : names_of(options)) {
    try {
      const auto address = lines::parse_address(name);
      if (!address && name != "-") require_file(name);
      if (!address && std::filesystem::is_directory(name)) unreadable(name + ": Is a directory");
      if (!address || options.reconnect) continue;
      auto& [line, air] = options.open_lines[name];
      if (address->kind == lines::Address::Kind::kAir) {
        (air = std::make_shared<lines::Air>(address->at))->open();
      } else {
        line = std::make_shared<lines::Line>(*address, options.listen_only);
        line->open(std::chrono::steady_clock::now() + kReconnectEvery);
      }
    } catch (const lines::Broken& broken) {
      unreadable(name + ": " + broken.what());
    }
  }
}

std::vector<std::string> all_inputs(const InputOptions& options) {
  std::vector<std::string> out = options.files;
  if (out.empty()) out.emplace_back("-");
  const std::vector<std::string> specs = files_in(options.spec);
  out.insert(out.end(), specs.begin(), specs.end());
  return out;
}

const reflect::Protocol& chosen_protocol(const InputOptions& options) {
  return options.spec == kAutoSpec ? choose_spec(options) : protocol_of(options.spec);
}

const reflect::Type* chosen_message(const InputOptions& options,
                                    const reflect::Protocol& protocol) {
  if (options.as_message.empty()) {
    if (options.format != "bare") return nullptr;
    throw UsageError("--input-format", "bare needs --as MESSAGE");
  }
  const std::string& format = options.format;
  if (format != "auto" && format != "hex" && format != "bare") {
    throw UsageError("--as", "takes hex text or a binary file, not " + options.format);
  }
  const reflect::Type* type = reflect::find_type(protocol, options.as_message);
  if (type && type->param_count != 0) {
    throw UsageError("--as",
                     options.as_message + " has parameters, which the type around it gives");
  }
  if (type) return type;
  std::vector<std::string> names;
  for (int i = 0; i < protocol.type_count; ++i) names.emplace_back(protocol.types[i]->name);
  throw UsageError("--as", fmt::format("unknown message '{}'{}{}", options.as_message,
                                       reflect::did_you_mean(options.as_message, names),
                                       spec_with_message(protocol, options.as_message)));
}

InputResult read_packets(const InputOptions& options, const OnPacket& on_packet,
                         const OnIdle& on_idle, const OtherText& other) {
  return Run(options, on_packet, on_idle, other).all();
}

bool is_damage(const Packet& packet) {
  const ReqId rule = packet.error.requirement;
  const bool of_file = rule == "WIRE-PCAP"_rule || rule == "WIRE-PCAPNG"_rule;
  return of_file && packet.framing == Framing::kBare &&
         (packet.error.fault == Fault::kContainer || packet.error.fault == Fault::kCut);
}

}  // namespace rubric::cli
