#include "tools/format/jsonl.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tools/format/testing.h"

namespace rubric::format {
namespace {

using Json = nlohmann::ordered_json;

Json print(const Sample& sample, bool units = false, std::string_view fields = {}) {
  std::vector<Path> paths;
  if (!fields.empty()) paths = parse_paths(fields, rubicon());
  JsonlFormatter formatter(rubicon(), units, paths);
  const std::string line = sample.print(formatter);
  EXPECT_EQ(line.find('\n'), line.size() - 1) << line;
  return Json::parse(line);
}

std::vector<std::string> keys(const Json& object) {
  std::vector<std::string> keys;
  for (const auto& item : object.items()) keys.push_back(item.key());
  return keys;
}

const std::vector<std::string> kKeys = {
    "schema", "index",   "offset", "time",   "interface", "direction", "framing", "frame",
    "am",     "message", "path",   "fields", "notes",     "stale",     "raw",     "error"};

TEST(Jsonl, has_all_keys_in_order_whatever_the_frame) {
  const auto framings = {Framing::kHdlc, Framing::kSf, Framing::kRadio, Framing::kBare};
  for (const Framing framing : framings) {
    const std::vector<std::uint8_t> whole = from_hex(kUpdates);
    for (std::size_t size = 0; size <= whole.size(); ++size) {
      const Sample sample({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)},
                          framing, "net_msg");
      EXPECT_EQ(keys(print(sample)), kKeys);
    }
  }
}

TEST(Jsonl, shows_a_serial_frame) {
  Sample sample(kUpdates, Framing::kHdlc);
  sample.packet.offset_bytes = 99;
  sample.packet.direction = Direction::kOutbound;
  sample.record.index = 7;
  sample.record.time_ns = 526'298'000;
  sample.record.interface_name = "serial:1";
  EXPECT_EQ(print(sample), Json::parse(R"({
    "schema": "rubric.decode/1", "index": 7, "offset": 99, "time": 0.526298,
    "interface": "serial:1", "direction": "outbound", "framing": "hdlc",
    "frame": {"kind": 69, "kind_name": "packet_noack", "serial_seq": null, "crc": 4660,
              "dispatch": 0},
    "am": {"dest": 65535, "src": 0, "length": 30, "group": 0, "type": 28},
    "message": "updates", "path": ["net_msg", "app_msg", "updates"],
    "fields": {
      "dest": {"pid": 11, "pid_name": null, "devid": 65533, "devid_name": "null"},
      "src": {"pid": 11, "pid_name": null, "devid": 2, "devid_name": null},
      "reliable": 0, "seq_num": 45267, "nbytes": 18,
      "payload": {
        "trans_id": 3, "trans_id_name": "connless", "app_id": 10, "app_id_name": "control_layer",
        "body": {"type": 35, "type_name": "updates", "output_size": 3, "updates": [
          {"transducer": 1, "transducer_bits": ["light"], "value": 302},
          {"transducer": 2, "transducer_bits": ["temp"], "value": 6402},
          {"transducer": 64, "transducer_bits": ["humid"], "value": 1202}]}}},
    "notes": [], "stale": "beef",
    "raw": "00ffff00001e001c000bfffd000b000200b0d312030a23030001012e00021902004004b2beef",
    "error": null})"));
}

TEST(Jsonl, shows_a_radio_frame) {
  Sample sample("4188 07 2200 0100 0200 3f 0e c4f5 01 2043 01", Framing::kRadio);
  sample.packet.fcs = 0xd720;
  const Json line = print(sample);
  EXPECT_EQ(line["frame"], Json::parse(R"({"fcf": 34881, "dsn": 7, "destpan": 34, "dest": 1,
                                           "src": 2, "network": 63, "fcs": 55072})"));
  EXPECT_EQ(line["am"],
            Json::parse(R"({"dest": 1, "src": 2, "length": 6, "group": 34, "type": 14})"));
  EXPECT_EQ(line["fields"]["mote_desc"]["transducers"], 0x2043);
  EXPECT_EQ(line["fields"]["mote_desc"]["transducers_bits"],
            Json::parse(R"(["light", "temp", "humid", "bit13"])"));
  const Json ack = print(Sample("0200 01", Framing::kRadio));
  EXPECT_EQ(ack["message"], "mac_ack");
  EXPECT_EQ(ack["am"], nullptr);
  EXPECT_EQ(ack["fields"], nullptr);
  EXPECT_EQ(ack["frame"]["destpan"], nullptr);
}

TEST(Jsonl, shows_bare_messages_and_units) {
  const Json line = print(Sample("0a 0001 18c4 04b2 012e 0003", Framing::kBare, "data"));
  EXPECT_EQ(line["frame"], Json::object());
  const Json data = print(Sample("0001 18c4 04b2 012e 0003", Framing::kBare, "data"), true);
  EXPECT_EQ(data["fields"]["temp"], 6340);
  EXPECT_EQ(data["fields"]["temp_degC"], 23.4);
  const Json reply = print(Sample("000b 0002 00000064 c4f5", Framing::kBare, "join_reply"), true);
  EXPECT_EQ(reply["fields"]["cur_time_ms"], 100);
}

TEST(Jsonl, shows_floats_that_json_lacks_as_strings) {
  const Json line = print(
      Sample("0000c07f 0000807f 000080ff 0000c03f 000000c0", Framing::kBare, "synaptic_data"));
  EXPECT_EQ(line["fields"]["values"], Json::parse(R"(["NaN", "Infinity", "-Infinity", 1.5, -2])"));
}

TEST(Jsonl, keeps_what_was_decoded_before_a_fault) {
  Sample sample("00 ffff 0000 0e 00 1c 000b fffd 000b 0002 02 0001 02 030a");
  const Json line = print(sample);
  EXPECT_EQ(line["message"], "net_msg");
  EXPECT_EQ(keys(line["fields"]), (std::vector<std::string>{"dest", "src"}));
  EXPECT_EQ(line["error"], Json::parse(R"({
    "fault": "out_of_range", "offset": 16, "requirement": "WIRE-NET-RELIABLE",
    "text": "reliable is 2, allowed are 0 to 1"})"));
}

TEST(Jsonl, says_what_is_remarkable) {
  const Json line =
      print(Sample("00 ffff 0000 12 00 1c 000b fffd 000b 0002 00 0001 06 0305 22aabbcc"));
  EXPECT_EQ(line["message"], "app_msg");
  EXPECT_EQ(line["fields"]["payload"]["payload"], "22aabbcc");
  EXPECT_EQ(line["notes"], Json::parse(R"([{"note": "does_not_fit", "offset": 22,
    "text": "body has the key 34 and does not fit demo_data"}])"));
  EXPECT_EQ(line["error"], nullptr);
}

TEST(Jsonl, shows_what_the_framing_breaks) {
  Sample aborted("00 ffff", Framing::kHdlc);
  aborted.packet.error = Error{Fault::kAborted, 4, "WIRE-HDLC-ESCAPE"_rule};
  aborted.packet.crc = kAbsent;
  aborted.packet.dropped_bytes = 12;
  aborted.decode();
  const Json line = print(aborted);
  EXPECT_EQ(line["frame"], Json::parse(R"({"kind": 69, "kind_name": "packet_noack",
    "serial_seq": null, "crc": null, "dispatch": 0, "aborted": true, "dropped": 12})"));
  EXPECT_EQ(line["error"]["fault"], "aborted");
  EXPECT_EQ(line["error"]["offset"], 3);  // In raw, which lacks the kind byte.
  Sample damage("0a0d0d0a", Framing::kBare);
  damage.packet.error = Error{Fault::kContainer, 4, "WIRE-PCAPNG"_rule};
  damage.packet.dropped_bytes = 3;
  damage.decode();
  EXPECT_EQ(print(damage)["frame"], Json::parse(R"({"dropped": 3})"));
}

TEST(Jsonl, prints_selected_fields_flat) {
  const Json line = print(Sample(kUpdates), false, "index,src.devid,updates.value,cur_time,path");
  EXPECT_EQ(line.dump(), R"({"schema":"rubric.decode/1","index":0,"src.devid":2,)"
                         R"("updates.value":[302,6402,1202],"cur_time":null,)"
                         R"("path":["net_msg","app_msg","updates"]})");
  EXPECT_EQ(print(Sample(kUpdates), false, "dest,trans_id_name,updates.transducer_bits").dump(),
            R"({"schema":"rubric.decode/1","index":0,)"
            R"("dest":{"pid":11,"pid_name":null,"devid":65533,"devid_name":"null"},)"
            R"("trans_id_name":"connless",)"
            R"("updates.transducer_bits":[["light"],["temp"],["humid"]]})");
}

TEST(Jsonl, survives_names_that_are_not_utf8) {
  Sample sample(kUpdates);
  sample.record.interface_name = "s\xff\"\n";
  EXPECT_EQ(print(sample)["interface"], "s\xef\xbf\xbd\"\n");
}

}  // namespace
}  // namespace rubric::format
