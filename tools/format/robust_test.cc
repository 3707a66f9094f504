// Messages alone, whatever their bytes: every format prints them within its reserved room, and JSON
// parses. Frames are the fuzz target decode's.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "tools/format/csv.h"
#include "tools/format/filter.h"
#include "tools/format/jsonl.h"
#include "tools/format/testing.h"
#include "tools/format/text.h"

namespace rubric::format {
namespace {

class Robust : public testing::Test {
 protected:
  Robust()
      : jsonl_(rubicon(), true),
        selected_(rubicon(), false,
                  parse_paths("seq_num,value,updates,transducers_bits,payload,error,stale,net_msg",
                              rubicon())),
        csv_(rubicon(), {}),
        text_(rubicon(),
              [] {
                TextOptions options;
                options.hex = options.color = options.units = true;
                return options;
              }()),
        filter_("seq_num>5 || values<1 || transducers & temp || !error && payload==00", rubicon()) {
  }

  void print_all(const Sample& sample) {
    const auto line = nlohmann::json::parse(sample.print(jsonl_));
    EXPECT_EQ(line.size(), 16U);
    EXPECT_EQ(line["error"].is_null(), !sample.frame.malformed());
    EXPECT_EQ(line["raw"].get<std::string>().size(), 2 * sample.bytes.size());
    EXPECT_TRUE(nlohmann::json::accept(sample.print(selected_)));
    sample.print(csv_);
    sample.print(text_);
    filter_.matches(sample.record);
  }

  std::size_t below(std::size_t bound) { return random_() % bound; }
  std::uint8_t byte(std::size_t bound = 256) { return static_cast<std::uint8_t>(below(bound)); }

  std::mt19937 random_{1};
  JsonlFormatter jsonl_;
  JsonlFormatter selected_;
  CsvFormatter csv_;
  TextFormatter text_;
  Filter filter_;
};

TEST_F(Robust, random_messages_of_every_type) {
  for (int i = 0; i < rubicon().type_count; ++i) {
    for (int round = 0; round < 100; ++round) {
      std::vector<std::uint8_t> bytes(below(130));
      for (std::uint8_t& value : bytes) value = byte(round % 2 ? 30 : 256);
      print_all(Sample(std::move(bytes), Framing::kBare, rubicon().types[i]->id));
    }
  }
}

TEST_F(Robust, large_messages) {
  print_all(Sample(std::vector<std::uint8_t>(100'000, 0x3e), Framing::kBare, "synaptic_data"));
  print_all(Sample(std::vector<std::uint8_t>(100'001, 0xff), Framing::kBare, "synaptic_data"));
  print_all(Sample(std::vector<std::uint8_t>(70'000, 0x00), Framing::kBare, "net_msg"));
}

}  // namespace
}  // namespace rubric::format
