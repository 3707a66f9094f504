// Packets into a file or stdout, in any of the containers.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "codec/containers/writer.h"
#include "tools/cli/output.h"

namespace rubric::record {

/// The containers' names, for options.
const std::vector<std::string>& container_names();

/// What a container can hold beside the packets' bytes.
struct Holds {
  bool times;
  bool directions;
  bool interfaces;
  bool comments;
};
Holds holds(std::string_view container);

/// Whether writing to `output` would overwrite a file that is read; none or "-" is stdin,
/// an `output` of "-" stdout.
bool overwrites(const std::string& output, const std::vector<std::string>& inputs);

/// Writes packets. What a container begins with is written even if no packet follows, but nothing
/// before the first packet or the end: until then a file that is there keeps what it holds.
class PacketOutput {
 public:
  /// `path`: a file, "-" is stdout. Throws std::system_error.
  PacketOutput(std::string_view container, const std::string& path);
  ~PacketOutput();
  PacketOutput(const PacketOutput&) = delete;
  PacketOutput& operator=(const PacketOutput&) = delete;

  /// Empty if the packet was taken, else why it was not. In a stream a packet that was cut can only
  /// be the last; it is refused by `cut_refused` when another follows.
  std::string write(const Packet& packet, std::string_view interface_name);
  /// Whether the packet cut before the one just written had to be left out.
  bool cut_refused() const { return cut_refused_; }

  /// Whether somebody still takes the output.
  bool open() const { return output_->open(); }
  /// Writes the end. Returns what failed, or empty; a closed pipe is no failure.
  std::string finish();

 private:
  void open_file(const std::string& path);
  bool make_writer(const Packet& first);

  std::string container_;
  std::string created_;  ///< The file's name as long as nothing was written to a new one.
  int fd_ = 1;
  std::unique_ptr<cli::Output> output_;
  std::unique_ptr<Writer> writer_;
  std::uint16_t link_type_ = 0;
  std::string bytes_;
  std::string cut_;
  bool cut_refused_ = false;
};

}  // namespace rubric::record
