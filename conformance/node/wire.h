// Converts between the codec's enumerators and the numbers of frames.
#pragma once

#include "codec/generated/rubicon/enums.h"
#include "codec/generated/rubicon/net_msg.h"

namespace rubric {
namespace node {

constexpr uint8_t number(rubicon::AmType type) { return static_cast<uint8_t>(type); }
constexpr uint8_t number(rubicon::Component component) { return static_cast<uint8_t>(component); }

constexpr uint8_t kAmJoin = number(rubicon::AmType::kJoin);
constexpr uint8_t kAmJoinReply = number(rubicon::AmType::kJoinReply);
constexpr uint8_t kAmAckJoin = number(rubicon::AmType::kAckJoin);
constexpr uint8_t kAmNet = number(rubicon::AmType::kNet);
constexpr uint8_t kAmConfig = number(rubicon::AmType::kConfig);

constexpr size_t kNetHeaderBytes = rubicon::NetMsgLayout::PayloadAt::kAt;
constexpr size_t kAppHeaderBytes = rubicon::AppMsgLayout::PayloadAt::kAt;

}  // namespace node
}  // namespace rubric
