#include "tools/cli/input.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "codec/containers/reader.h"
#include "codec/reflect/fault_text.h"
#include "codec/reflect/registry.h"
#include "codec/reflect/suggest.h"
#include "tools/cli/progress.h"

namespace rubric::cli {
namespace {

constexpr std::size_t kChunkBytes = 256 * 1024;
constexpr std::size_t kDetectBytes = 4096;
constexpr std::size_t kDetectMost = 64 * 1024;
constexpr int kDetectPatienceMs = 200;
/// A bare message of a binary file: a bound, so that memory stays flat whatever is read.
constexpr std::size_t kBareMost = kDetectMost;

/// Hex text whose lines are 802.15.4 frames without FCS.
constexpr const char* kHexRadio = "hex-radio";

struct FormatName {
  const char* name;
  InputFormat format;
};
constexpr FormatName kFormats[] = {
    {"hdlc", InputFormat::kHdlc}, {"sf", InputFormat::kSf},   {"pcap", InputFormat::kPcap},
    {"pcapng", InputFormat::kPcapng}, {"hex", InputFormat::kHex}, {kHexRadio, InputFormat::kHex},
};

std::string_view format_name(InputFormat format) {
  for (const FormatName& known : kFormats) {
    if (known.format == format) return known.name;
  }
  return "unknown";
}

InputFormat find_format(std::string_view name) {
  for (const FormatName& known : kFormats) {
    if (name == known.name) return known.format;
  }
  return InputFormat::kUnknown;
}

/// A file that is being read, with what was read of it to find out its format.
class File {
 public:
  /// Throws std::system_error.
  explicit File(const std::string& name) : is_stdin_(name == "-") {
    fd_ = is_stdin_ ? 0 : ::open(name.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd_ < 0) throw std::system_error(errno, std::generic_category());
    struct stat status {};
    if (::fstat(fd_, &status) == 0) is_regular_ = S_ISREG(status.st_mode);
  }
  ~File() {
    if (!is_stdin_) ::close(fd_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  bool is_regular() const { return is_regular_; }

  /// Up to `size` bytes, 0 at the end. Throws std::system_error.
  std::size_t read(std::uint8_t* to, std::size_t size) {
    while (true) {
      const ssize_t got = ::read(fd_, to, size);
      if (got >= 0) return static_cast<std::size_t>(got);
      if (errno != EINTR) throw std::system_error(errno, std::generic_category());
    }
  }

  bool has_more_soon() const {
    pollfd wait{fd_, POLLIN, 0};
    return is_regular_ || ::poll(&wait, 1, kDetectPatienceMs) != 0;
  }

 private:
  int fd_;
  bool is_stdin_;
  bool is_regular_ = false;
};

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
  Run(const InputOptions& options, const OnPacket& on_packet, const OnIdle& on_idle)
      : options_(options),
        on_packet_(on_packet),
        on_idle_(on_idle),
        files_(options.files.empty() ? std::vector<std::string>{"-"} : options.files),
        chunk_(std::make_unique_for_overwrite<std::uint8_t[]>(kChunkBytes)),
        progress_(total_size(files_), options.progress) {}

  InputResult all() {
    for (std::size_t i = 0; i < files_.size() && !result_.stopped; ++i) {
      source_.file = files_[i];
      source_.file_index = i;
      source_.number = 0;
      try {
        one();
      } catch (const std::system_error& error) {
        complain(std::strerror(error.code().value()));
      }
    }
    return result_;
  }

 private:
  void complain(std::string_view what) {
    result_.failed = true;
    progress_.clear();
    const std::string_view name = source_.file == "-" ? "stdin" : source_.file;
    fmt::print(stderr, "rubric: {}: {}\n", name, what);
  }

  void one() {
    File file(files_[source_.file_index]);
    std::size_t size = 0;
    InputFormat format = find_format(options_.format);
    const bool bare = !options_.as_message.empty();
    if (options_.format == "auto") {
      size = look(file, format);
      if (size == 0) return;  // Nothing in it, nothing wrong with it.
      if (format == InputFormat::kUnknown && !bare) {
        return complain("this begins like no serial line, forwarder stream, pcap, pcapng or hex "
                        "text; name it with --input-format");
      }
      if (bare && (format == InputFormat::kPcap || format == InputFormat::kPcapng)) {
        return complain(fmt::format("this is {}; --as takes a message alone (--input-format bare "
                                    "reads the file as one)", format_name(format)));
      }
      if (format == InputFormat::kJsonl && !bare) {
        return complain("this is JSON; 'rubric encode' reads it");
      }
    }
    if (bare && format != InputFormat::kHex) return whole(file, size);
    ReaderOptions reader_options;
    if (options_.format == kHexRadio) reader_options.hex_framing = Framing::kRadio;
    if (bare) reader_options.hex_framing = Framing::kBare;
    std::unique_ptr<Reader> reader = make_reader(format, reader_options);
    source_.format = format_name(format);
    pump(file, *reader, size);
  }

  // Reads until the content tells its format.
  std::size_t look(File& file, InputFormat& format) {
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

  void pump(File& file, Reader& reader, std::size_t size) {
    auto deliver = [&](const Packet& packet) { give(packet, reader.interfaces()); };
    while (true) {
      if (size) reader.feed(Bytes(chunk_.get(), size), deliver);
      progress_.advance(size);
      if (result_.stopped) return;
      if (!file.is_regular() && size < kChunkBytes && on_idle_) on_idle_();
      size = file.read(chunk_.get(), kChunkBytes);
      if (size == 0) break;
    }
    reader.finish(deliver);
  }

  // A binary file as one message.
  void whole(File& file, std::size_t size) {
    std::vector<std::uint8_t> bytes(chunk_.get(), chunk_.get() + size);
    Packet packet;
    while (const std::size_t got = file.read(chunk_.get(), kChunkBytes)) {
      const std::size_t taken = std::min(got, kBareMost - bytes.size());
      bytes.insert(bytes.end(), chunk_.get(), chunk_.get() + taken);
      packet.dropped_bytes += got - taken;
    }
    packet.bytes = Bytes(bytes.data(), bytes.size());
    if (packet.dropped_bytes) {
      packet.error = Error{Fault::kTooLong, kBareMost, ReqId::kNone};
    }
    source_.format = "bare";
    give(packet, {});
  }

  void give(const Packet& packet, const std::vector<Interface>& interfaces) {
    if (result_.stopped) return;  // What is left of the chunk.
    source_.interface_name = packet.interface_id < interfaces.size()
                                 ? std::string_view(interfaces[packet.interface_id].name)
                                 : std::string_view{};
    if (is_damage(packet)) {
      complain(fmt::format("damaged at byte {}: {}", packet.offset_bytes,
                           reflect::fault_sentence(packet.error.fault)));
    }
    ++source_.number;
    if (!on_packet_(packet, source_)) result_.stopped = true;
  }

  const InputOptions& options_;
  const OnPacket& on_packet_;
  const OnIdle& on_idle_;
  const std::vector<std::string> files_;
  std::unique_ptr<std::uint8_t[]> chunk_;
  Progress progress_;
  Source source_;
  InputResult result_;
};

std::vector<std::string> protocol_names() {
  std::vector<std::string> names;
  for (const reflect::Protocol* protocol : reflect::protocols()) names.emplace_back(protocol->id);
  return names;
}

bool is_digits(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == text.npos;
}

}  // namespace

void add_input_options(CLI::App& app, InputOptions& options) {
  app.add_option("FILE", options.files, "Captures, in order; none or - is stdin");
  app.add_option("--input-format", options.format,
                 "What the input is: auto, hdlc (bytes of a serial line), sf (serial forwarder), "
                 "pcap, pcapng, hex (text, from the dispatch byte on), hex-radio (text, 802.15.4 "
                 "without FCS), bare (one message, with --as)")
      ->check(CLI::IsMember({"auto", "hdlc", "sf", "pcap", "pcapng", "hex", kHexRadio, "bare"}))
      ->capture_default_str();
  app.add_option("--spec", options.spec, "Protocol above the AM layer")->capture_default_str();
  app.add_option("--as", options.as_message,
                 "The input is this message alone: each line of hex text, or a binary file whole")
      ->check(given());
}

CLI::Validator given() {
  const auto check = [](const std::string& text) {
    return text.empty() ? std::string("is empty") : std::string();
  };
  return {check, ""};
}

CLI::Validator whole_number() {
  const auto check = [](const std::string& text) {
    if (is_digits(text)) return std::string();
    return fmt::format("expected a number of 0 or more, given '{}'", text);
  };
  return {check, ""};
}

CLI::Validator at_least_one() {
  const auto check = [](const std::string& text) {
    if (is_digits(text) && text.find_first_not_of('0') != text.npos) return std::string();
    return fmt::format("expected a number of 1 or more, given '{}'", text);
  };
  return {check, ""};
}

const reflect::Protocol& chosen_protocol(const InputOptions& options) {
  const reflect::Protocol* protocol = reflect::find_protocol(options.spec);
  if (protocol) return *protocol;
  throw CLI::ValidationError("--spec",
                             fmt::format("unknown protocol '{}'{}", options.spec,
                                         reflect::did_you_mean(options.spec, protocol_names())));
}

const reflect::Type* chosen_message(const InputOptions& options,
                                    const reflect::Protocol& protocol) {
  if (options.as_message.empty()) {
    if (options.format != "bare") return nullptr;
    throw CLI::ValidationError("--input-format", "bare needs --as MESSAGE");
  }
  if (options.format != "auto" && options.format != "hex" && options.format != "bare") {
    throw CLI::ValidationError("--as", "takes hex text or a binary file, not " + options.format);
  }
  const reflect::Type* type = reflect::find_type(protocol, options.as_message);
  if (type) return type;
  std::vector<std::string> names;
  for (int i = 0; i < protocol.type_count; ++i) names.emplace_back(protocol.types[i]->name);
  throw CLI::ValidationError("--as", fmt::format("unknown message '{}'{}", options.as_message,
                                                 reflect::did_you_mean(options.as_message, names)));
}

InputResult read_packets(const InputOptions& options, const OnPacket& on_packet,
                         const OnIdle& on_idle) {
  return Run(options, on_packet, on_idle).all();
}

bool is_damage(const Packet& packet) {
  const ReqId rule = packet.error.requirement;
  const bool of_file = rule == ReqId::kWirePcap || rule == ReqId::kWirePcapng;
  return of_file && packet.framing == Framing::kBare &&
         (packet.error.fault == Fault::kContainer || packet.error.fault == Fault::kCut);
}

}  // namespace rubric::cli
