// Writes packets into a file or stdout, in any of the containers.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "codec/containers/writer.h"
#include "tools/cli/output.h"

namespace rubric::encode {

/// Returns the containers' names, for options.
const std::vector<std::string>& container_names();

/// The facts that a container can hold besides the packets' bytes.
struct Holds {
  bool times;
  bool directions;
  bool interfaces;
  bool comments;
};
Holds holds(std::string_view container);

/// Writes packets into a file that takes its name in finish(), even if no packet came.
class PacketOutput {
 public:
  /// `path`: a file, "-" is stdout. Ends the command if it cannot be opened.
  PacketOutput(std::string_view container, const std::string& path);

  /// Writes a packet. Returns an empty text if it was taken, else why it was not. In a stream only
  /// the last packet can be cut; a cut one is refused by `cut_refused` when another follows.
  std::string write(const Packet& packet, std::string_view interface_name);
  /// Returns whether the cut packet before the last one had to be left out.
  bool cut_refused() const { return cut_refused_; }

  /// Returns how many packets without a time were given one (see Writer).
  std::uint64_t given_times() const { return writer_ ? writer_->given_times() : 0; }

  /// Returns whether the reader still takes the output.
  bool open() const { return output_.open(); }
  /// Writes the end. Returns false if something could not be written, as cli::Output does.
  bool finish();

 private:
  bool make_writer(const Packet& first);

  std::string container_;
  cli::Output output_;
  std::unique_ptr<Writer> writer_;
  std::uint16_t link_type_ = 0;
  std::string bytes_;
  std::string cut_;
  bool cut_refused_ = false;
};

}  // namespace rubric::encode
