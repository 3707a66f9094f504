// A tuple space within one process.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "tools/commands/space/space.h"

namespace rubric::space {

/// The tuples that the participants share; participants may be of several threads.
class MemoryBoard {
 public:
  struct Inbox {
    std::vector<std::string> filters;
    std::vector<Tuple> tuples;
  };

  std::shared_ptr<Inbox> join();
  void put(Tuple tuple, Space::Stay stay);
  void remove(const std::string& key);
  void subscribe(Inbox& inbox, const std::string& filter);
  std::vector<Tuple> take(Inbox& inbox);

 private:
  std::mutex mutex_;
  std::map<std::string, Tuple> tuples_;
  std::vector<std::weak_ptr<Inbox>> inboxes_;
};

class MemorySpace final : public Space {
 public:
  MemorySpace(std::shared_ptr<MemoryBoard> board, std::string creator)
      : board_(std::move(board)), creator_(std::move(creator)), inbox_(board_->join()) {}

  std::int64_t put(const std::string& key, const std::string& data, Stay stay) override;
  void announce(const std::string&, const std::string&) override {}
  void remove(const std::string& key) override { board_->remove(key); }
  void subscribe(const std::string& filter) override { board_->subscribe(*inbox_, filter); }
  std::vector<Tuple> take() override { return board_->take(*inbox_); }

 private:
  std::shared_ptr<MemoryBoard> board_;
  std::string creator_;
  std::shared_ptr<MemoryBoard::Inbox> inbox_;
};

}  // namespace rubric::space
