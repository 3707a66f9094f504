#include "codec/lines/stream_line.h"

#include "codec/lines/broken.h"

namespace rubric::lines {

using std::chrono::steady_clock;

bool StreamLine::open(SteadyTime deadline) {
  if (stream_.is_open()) {
    try {
      while (read_some(steady_clock::now())) {
      }
      return false;
    } catch (const Broken&) {  // It has gone since.
    }
  }
  stream_ = connect_(deadline);
  try {
    begin(deadline);
  } catch (const Broken&) {
    close();
    throw;
  }
  return true;
}

bool StreamLine::read_some(SteadyTime deadline) {
  std::uint8_t bytes[4096];
  const std::size_t count = stream_.read(MutableBytes(bytes, sizeof bytes), deadline);
  take(Bytes(bytes, count));
  return count > 0;
}

void StreamLine::broken(const std::string& why) {
  close();
  throw Broken(why);
}

}  // namespace rubric::lines
