#include "conformance/test/targets/serve.h"

#include <gtest/gtest.h>

#include <memory>

#include "conformance/test/runner/subject_target.h"

namespace rubric::targets {
namespace {

TEST(Serve, WhatIsRefusedIsAnsweredInPrintableText) {
  runner::SubjectTarget target(std::make_unique<runner::Machine>());
  Server server(target, machine_identity());
  EXPECT_EQ(server.answer("\x1a"), "unsupported byte 0x1a at column 1 is not printable ASCII\n");
  EXPECT_EQ(server.answer("reset mote id=\xff"),
            "unsupported byte 0xff at column 15 is not printable ASCII\n");
  EXPECT_EQ(server.answer("dance"), "unsupported the command dance is not known\n");
  EXPECT_EQ(server.answer("reset mote id=2"), "ready\n");
}

}  // namespace
}  // namespace rubric::targets
