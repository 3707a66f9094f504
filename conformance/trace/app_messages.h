// Messages of a line besides those of the wire spec: calls and events of an application, states of
// a link, the power of a node, and a frame that nothing decodes. This is their only table.
#pragma once

#include <cstdint>
#include <iterator>
#include <span>

#include "codec/generated/rubicon/tables.h"
#include "codec/reflect/schema.h"

namespace rubric::trace {

enum class AppKind : std::uint8_t {
  kNumber,  ///< From 0 to `max`, perhaps with names.
  kReal,    ///< binary32.
  kBytes,
  kAddress,  ///< pid and devid.
  kChannel,  ///< Source and destination devid.
};

struct AppField {
  const char* name;
  AppKind kind;
  std::uint32_t max = 0;
  const reflect::EnumTable* names = nullptr;
  const reflect::MaskTable* mask = nullptr;
  bool derived = false;  ///< Says how much there is of another field.
};

enum class AppWhat : std::uint8_t {
  kCall,   ///< From the application to the node: `<` on app.
  kEvent,  ///< From the node to its application: `>` on app.
  kState,  ///< A link's or the application's: `<` on any of them.
  kRadio,  ///< The end of the node's own last transmission: `<` on a radio.
  kPower,  ///< `<` on power.
  kFrame,  ///< On the links of frames, either way.
};

struct AppMessage {
  const char* name;
  AppWhat what;
  const AppField* fields;
  std::uint8_t field_count;
  std::span<const AppField> all() const { return {fields, field_count}; }
};

namespace app {

constexpr reflect::EnumEntry kResultNames[] = {{0, "fail"}, {1, "success"}};
constexpr reflect::EnumTable kResult{"result", kResultNames, 2};
constexpr reflect::EnumEntry kOnNames[] = {{0, "off"}, {1, "on"}};
constexpr reflect::EnumTable kOn{"on", kOnNames, 2};
constexpr reflect::EnumEntry kModeNames[] = {{0, "reliable"}, {1, "power_save"}};
constexpr reflect::EnumTable kMode{"mode", kModeNames, 2};
constexpr reflect::EnumEntry kStatusNames[] = {{0, "new"}, {1, "old"}, {2, "unknown_channel"}};
constexpr reflect::EnumTable kStatus{"status", kStatusNames, 3};
constexpr reflect::EnumEntry kLinkNames[] = {{0, "radio"}, {1, "serial"}, {2, "peis"}};
constexpr reflect::EnumTable kLink{"link", kLinkNames, 3};

namespace wire = rubicon::tables;

constexpr AppField kType{"type", AppKind::kNumber, 0xFF, &wire::enums::kMoteType, nullptr};
constexpr AppField kTransducers{"transducers", AppKind::kNumber, 0xFFFF, nullptr,
                                &wire::masks::kTransducerMask};
constexpr AppField kActuators{"actuators", AppKind::kNumber, 0xFF, nullptr,
                              &wire::masks::kActuatorMask};
constexpr AppField kAppId{"app_id", AppKind::kNumber, 0xFF, &wire::enums::kComponent, nullptr};
constexpr AppField kSeqNum{"seq_num", AppKind::kNumber, 0xFFFF};
constexpr AppField kData{"data", AppKind::kBytes};
constexpr AppField kAddress{"address", AppKind::kAddress};
constexpr AppField kDest{"dest", AppKind::kAddress};
constexpr AppField kSrc{"src", AppKind::kAddress};
constexpr AppField kReliable{"reliable", AppKind::kNumber, 1};
constexpr AppField kWhichLink{"link", AppKind::kNumber, 2, &kLink, nullptr};
constexpr AppField kIsOn{"on", AppKind::kNumber, 1, &kOn, nullptr};
constexpr AppField kChannel{"channel", AppKind::kChannel};
constexpr AppField kSize{"size", AppKind::kNumber, 0xFF};
constexpr AppField kWhichMode{"mode", AppKind::kNumber, 1, &kMode, nullptr};
constexpr AppField kPos{"pos", AppKind::kNumber, 0xFF};
constexpr AppField kValue{"value", AppKind::kReal};
constexpr AppField kSuccess{"result", AppKind::kNumber, 1, &kResult, nullptr};

// Calls, by the names of the paper's interfaces.
constexpr AppField kJoin[] = {kType, kTransducers, kActuators};
constexpr AppField kSend[] = {kDest, kAppId, kReliable, kData};
constexpr AppField kInterface[] = {kWhichLink, kIsOn};
constexpr AppField kGetInterface[] = {kWhichLink};
constexpr AppField kCreateOut[] = {kDest, kSize, kWhichMode};
constexpr AppField kCreateIn[] = {kSrc, kSize, kWhichMode};
constexpr AppField kOneChannel[] = {kChannel};
constexpr AppField kWriteOutput[] = {kChannel, kPos, kValue};
constexpr AppField kReadInput[] = {kChannel, kPos};
constexpr AppField kSetTimeStep[] = {{"clock", AppKind::kNumber, 0xFFFF}};
constexpr AppField kSetIslandId[] = {
    {"island", AppKind::kNumber, 0xFFFF, &wire::enums::kPid, nullptr}};

// Events.
constexpr AppField kJoined[] = {kAddress, kSuccess};
constexpr AppField kMoteJoined[] = {kAddress, kType, kTransducers, kActuators};
constexpr AppField kMoteLeft[] = {kAddress};
constexpr AppField kSendResult[] = {kSeqNum};
constexpr AppField kReceived[] = {kSrc, kAppId, kData};
constexpr AppField kAckReceived[] = {kAppId, kSeqNum, kSuccess};
constexpr AppField kSynData[] = {kChannel, {"status", AppKind::kNumber, 2, &kStatus, nullptr}};
constexpr AppField kChannelResult[] = {kChannel, kSuccess};
constexpr AppField kInputValue[] = {kValue, kSuccess};
constexpr AppField kOpResult[] = {kSuccess};
constexpr AppField kInterfaceState[] = {kWhichLink, kIsOn};
constexpr AppField kClock[] = {{"ms", AppKind::kNumber, 0xFFFFFFFF}};

constexpr AppField kLinkAck[] = {{"acked", AppKind::kNumber, 1}};
constexpr AppField kFrame[] = {{"type", AppKind::kNumber, 0xFF, &wire::enums::kAmType, nullptr},
                               {"payload", AppKind::kBytes},
                               {"size", AppKind::kNumber, 114, nullptr, nullptr, true}};

template <std::size_t N>
constexpr AppMessage message(const char* name, AppWhat what, const AppField (&fields)[N]) {
  return {name, what, fields, N};
}
constexpr AppMessage message(const char* name, AppWhat what) { return {name, what, nullptr, 0}; }

}  // namespace app

/// The name of the message for a frame that nothing decodes.
constexpr const char* kFrameName = "am";

constexpr AppMessage kAppMessages[] = {
    app::message("join", AppWhat::kCall, app::kJoin),
    app::message("send", AppWhat::kCall, app::kSend),
    app::message("interface", AppWhat::kCall, app::kInterface),
    app::message("get_interface", AppWhat::kCall, app::kGetInterface),
    app::message("create_out", AppWhat::kCall, app::kCreateOut),
    app::message("create_in", AppWhat::kCall, app::kCreateIn),
    app::message("dispose", AppWhat::kCall, app::kOneChannel),
    app::message("start", AppWhat::kCall, app::kOneChannel),
    app::message("stop", AppWhat::kCall, app::kOneChannel),
    app::message("start_all", AppWhat::kCall),
    app::message("stop_all", AppWhat::kCall),
    app::message("write_output", AppWhat::kCall, app::kWriteOutput),
    app::message("read_input", AppWhat::kCall, app::kReadInput),
    app::message("set_time_step", AppWhat::kCall, app::kSetTimeStep),
    app::message("set_island_id", AppWhat::kCall, app::kSetIslandId),
    app::message("get_clock", AppWhat::kCall),
    app::message("joined", AppWhat::kEvent, app::kJoined),
    app::message("mote_joined", AppWhat::kEvent, app::kMoteJoined),
    app::message("mote_left", AppWhat::kEvent, app::kMoteLeft),
    app::message("send_result", AppWhat::kEvent, app::kSendResult),
    app::message("received", AppWhat::kEvent, app::kReceived),
    app::message("ack_received", AppWhat::kEvent, app::kAckReceived),
    app::message("syn_data", AppWhat::kEvent, app::kSynData),
    app::message("channel_result", AppWhat::kEvent, app::kChannelResult),
    app::message("input_value", AppWhat::kEvent, app::kInputValue),
    app::message("op_result", AppWhat::kEvent, app::kOpResult),
    app::message("interface_state", AppWhat::kEvent, app::kInterfaceState),
    app::message("clock", AppWhat::kEvent, app::kClock),
    app::message("busy", AppWhat::kState),
    app::message("idle", AppWhat::kState),
    app::message("linkack", AppWhat::kRadio, app::kLinkAck),
    app::message("reboot", AppWhat::kPower),
    app::message("off", AppWhat::kPower),
    app::message(kFrameName, AppWhat::kFrame, app::kFrame),
};

}  // namespace rubric::trace
