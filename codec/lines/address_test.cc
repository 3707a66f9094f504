#include "codec/lines/address.h"

#include <gtest/gtest.h>

#include "codec/lines/broken.h"

namespace rubric::lines {
namespace {

std::vector<std::string> texts(const std::string& host, bool passive) {
  std::vector<std::string> out;
  for (const SocketAddress& address : resolve(host, 9002, passive)) {
    EXPECT_TRUE(address.is_loopback()) << address.text();
    out.push_back(address.text());
  }
  return out;
}

// RFC 6761. A resolver need not know these names, and most know nothing of the last ones.
TEST(Address, LocalhostIsLoopback) {
  for (const char* name :
       {"localhost", "LocalHost", "localhost.", "mote.localhost", "a.b.LOCALHOST."}) {
    EXPECT_EQ(texts(name, false), (std::vector<std::string>{"[::1]:9002", "127.0.0.1:9002"}));
    EXPECT_EQ(texts(name, true), (std::vector<std::string>{"127.0.0.1:9002", "[::1]:9002"}));
  }
}

TEST(Address, OtherNamesAreNotLocalhost) {
  for (const char* name : {"notlocalhost.invalid", "localhost.invalid", ".."}) {
    EXPECT_THROW(resolve(name, 9002, false), Broken) << name;
  }
}

// To listen at localhost and to connect to it is to meet.
TEST(Address, LocalhostMeets) {
  const Descriptor listener = listen_at("localhost", 0);
  const std::uint16_t port = address_here(listener.get()).port();
  EXPECT_TRUE(connect_tcp({"localhost", port}, {}).is_open());
  EXPECT_TRUE(connect_tcp({"127.0.0.1", port}, {}).is_open());
}

}  // namespace
}  // namespace rubric::lines
