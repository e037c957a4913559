// SPDX-License-Identifier: Apache-2.0
// The bytes of MCAP files, by mcap.dev/spec: what is read here knows nothing of who wrote them.
#include "mjcf/trace/read/bag/mcap_writer.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "mjcf/trace/read/bag/json_message.h"
#include "mjcf/trace/read/test/recording.h"
#include "mjcf/trace/read/text/unpacked_file.h"

namespace tauext::test {
namespace {

using Json = nlohmann::json;

// the fields of a record in their order
class Reader {
 public:
  explicit Reader(std::string bytes) : bytes_(std::move(bytes)) {}
  std::uint64_t number(int size) {
    const std::string some = take(static_cast<std::size_t>(size));
    std::uint64_t x = 0;
    for (int i = size - 1; i >= 0; --i)
      x = x << 8 | static_cast<unsigned char>(some[static_cast<std::size_t>(i)]);
    return x;
  }
  std::string text(int length = 4) { return take(number(length)); }
  std::string rest() { return take(bytes_.size() - at_); }
  bool at_end() const { return at_ == bytes_.size(); }

 private:
  std::string take(std::size_t size) {
    EXPECT_LE(size, bytes_.size() - at_);
    at_ += size;
    return bytes_.substr(at_ - size, size);
  }

  std::string bytes_;
  std::size_t at_ = 0;
};

struct Rec {
  int kind;
  std::size_t begin, size;  // with its head
  std::string content;
};

std::vector<Rec> records_in(const std::string& bytes, std::size_t from, std::size_t to) {
  std::vector<Rec> all;
  while (from < to) {
    const auto kind = static_cast<unsigned char>(bytes[from]);
    const std::size_t size = Reader(bytes.substr(from + 1, 8)).number(8);
    if (size > to - from - 9) {
      ADD_FAILURE() << "a record of kind " << int{kind} << " ends behind its section";
      break;
    }
    all.push_back({kind, from, size + 9, bytes.substr(from + 9, size)});
    from += size + 9;
  }
  return all;
}

std::uint32_t crc_of(const std::string& bytes) {
  return static_cast<std::uint32_t>(
      ::crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

struct Message {
  std::uint64_t channel, sequence, t, published;
  std::string data;
};

// all of a file, each record of which is compared with the others
struct Mcap {
  std::string bytes;
  std::vector<Rec> data, summary, offsets;
  std::map<std::uint64_t, Json> schemas;
  std::map<std::uint64_t, std::string> types, topics;
  std::map<std::uint64_t, std::uint64_t> schema_of;
  std::vector<Message> messages;
  std::size_t chunks = 0, largest = 0;

  explicit Mcap(const std::string& file) : bytes(file) {
    const std::string magic = "\x89MCAP0\r\n";
    EXPECT_TRUE(bytes.starts_with(magic) && bytes.ends_with(magic));
    const std::size_t footer = bytes.size() - 8 - 29;
    Reader f(bytes.substr(footer));
    EXPECT_EQ(f.number(1), 2U);
    EXPECT_EQ(f.number(8), 20U);
    const std::size_t begin = f.number(8), begin_of_offsets = f.number(8);
    EXPECT_EQ(f.number(4), crc_of(bytes.substr(begin, footer + 25 - begin)));
    data = records_in(bytes, 8, begin);
    summary = records_in(bytes, begin, begin_of_offsets);
    offsets = records_in(bytes, begin_of_offsets, footer);
    EXPECT_EQ(data.front().kind, 1);
    EXPECT_EQ(data.back().kind, 15);
    EXPECT_EQ(Reader(data.back().content).number(4), crc_of(bytes.substr(0, data.back().begin)));
    read_chunks();
    read_statistics();
    read_offsets();
  }

  const Message& last() const { return messages.back(); }

  void read_definition(const Rec& r) {
    Reader f(r.content);
    const std::uint64_t id = f.number(2);
    if (r.kind == 3) {
      EXPECT_NE(id, 0U);
      types[id] = f.text();
      EXPECT_EQ(f.text(), "jsonschema");
      schemas[id] = Json::parse(f.text());
    } else {
      schema_of[id] = f.number(2);
      EXPECT_EQ(schemas.count(schema_of[id]), 1U) << "its schema comes first";
      topics[id] = f.text();
      EXPECT_EQ(f.text(), "json");
      for (Reader metadata(f.text()); !metadata.at_end();) metadata.text(), metadata.text();
    }
    EXPECT_TRUE(f.at_end());
  }

  // with what follows them; the summary repeats where they are
  void read_chunks() {
    for (std::size_t i = 0; i < data.size(); ++i) {
      if (data[i].kind != 6) {
        EXPECT_TRUE(data[i].kind == 1 || data[i].kind == 7 || data[i].kind == 15);
        continue;
      }
      std::map<std::uint64_t, std::size_t> places;
      std::size_t length = 0;
      std::set<std::tuple<std::uint64_t, std::uint64_t, std::uint64_t>> index;
      for (std::size_t k = i + 1; data[k].kind == 7; ++k) {
        Reader f(data[k].content);
        const std::uint64_t channel = f.number(2);
        EXPECT_TRUE(places.emplace(channel, data[k].begin).second);
        length += data[k].size;
        for (Reader entries(f.text()); !entries.at_end();) {
          const std::uint64_t t = entries.number(8), place = entries.number(8);
          EXPECT_TRUE(index.emplace(channel, t, place).second);
        }
      }
      read_chunk(data[i], places, length, index);
    }
  }

  template <class Places, class Index>
  void read_chunk(const Rec& r, const Places& places, std::size_t length, const Index& index) {
    Reader f(r.content);
    const std::uint64_t from = f.number(8), to = f.number(8), size = f.number(8);
    const std::uint64_t crc = f.number(4);
    EXPECT_EQ(f.text(), "zstd");
    const std::string packed = f.text(8), chunk = unpacked(packed, size, "x.mcap");
    EXPECT_EQ(chunk.size(), size);
    EXPECT_EQ(crc_of(chunk), crc);
    std::set<std::tuple<std::uint64_t, std::uint64_t, std::uint64_t>> found;
    std::uint64_t least = ~std::uint64_t{0}, most = 0;
    for (const Rec& inner : records_in(chunk, 0, chunk.size())) {
      if (inner.kind != 5) {
        read_definition(inner);
        continue;
      }
      Reader m(inner.content);
      Message message{m.number(2), m.number(4), m.number(8), m.number(8), m.rest()};
      EXPECT_EQ(topics.count(message.channel), 1U) << "its channel comes first";
      EXPECT_EQ(message.t, message.published);
      least = std::min(least, message.t), most = std::max(most, message.t);
      found.emplace(message.channel, message.t, inner.begin);
      messages.push_back(std::move(message));
    }
    EXPECT_EQ(found, index);
    EXPECT_TRUE(found.empty() ? from == 0 && to == 0 : from == least && to == most);
    ++chunks, largest = std::max<std::size_t>(largest, size);
    expect_index(r, from, to, places, length, packed.size(), size);
  }

  template <class Places>
  void expect_index(const Rec& chunk, std::uint64_t from, std::uint64_t to, const Places& places,
                    std::size_t length, std::size_t packed, std::size_t size) const {
    int found = 0;
    for (const Rec& r : summary) {
      if (r.kind != 8) continue;
      Reader f(r.content);
      const std::uint64_t from_there = f.number(8), to_there = f.number(8);
      if (f.number(8) != chunk.begin) continue;
      ++found;
      EXPECT_EQ(std::pair(from_there, to_there), std::pair(from, to));
      EXPECT_EQ(f.number(8), chunk.size);
      std::map<std::uint64_t, std::size_t> there;
      for (Reader map(f.text()); !map.at_end();) {
        const std::uint64_t channel = map.number(2);
        there[channel] = map.number(8);
      }
      EXPECT_EQ(there, places);
      EXPECT_EQ(f.number(8), length);
      EXPECT_EQ(f.text(), "zstd");
      EXPECT_EQ(f.number(8), packed);
      EXPECT_EQ(f.number(8), size);
      EXPECT_TRUE(f.at_end());
    }
    EXPECT_EQ(found, 1);
  }

  void read_statistics() const {
    std::map<int, std::size_t> kinds;
    for (const Rec& r : summary) {
      ++kinds[r.kind];
      if (r.kind != 11) continue;
      Reader f(r.content);
      EXPECT_EQ(f.number(8), messages.size());
      EXPECT_EQ(f.number(2), schemas.size());
      EXPECT_EQ(f.number(4), topics.size());
      EXPECT_EQ(f.number(4), 0U) << "attachments";
      EXPECT_EQ(f.number(4), 0U) << "metadata";
      EXPECT_EQ(f.number(4), chunks);
      std::uint64_t least = messages.empty() ? 0 : messages[0].t, most = 0;
      std::map<std::uint64_t, std::uint64_t> counts, there;
      for (const auto& [id, name] : topics) counts[id] = 0;
      for (const Message& m : messages)
        least = std::min(least, m.t), most = std::max(most, m.t), ++counts[m.channel];
      EXPECT_EQ(f.number(8), least);
      EXPECT_EQ(f.number(8), most);
      for (Reader map(f.text()); !map.at_end();) {
        const std::uint64_t channel = map.number(2);
        there[channel] = map.number(8);
      }
      EXPECT_EQ(there, counts);
    }
    EXPECT_EQ(kinds, (std::map<int, std::size_t>{
                         {3, schemas.size()}, {4, topics.size()}, {8, chunks}, {11, 1}}));
  }

  void read_offsets() const {
    std::size_t at = summary.front().begin;
    for (const Rec& r : offsets) {
      EXPECT_EQ(r.kind, 14);
      Reader f(r.content);
      const auto kind = static_cast<int>(f.number(1));
      EXPECT_EQ(f.number(8), at);
      const std::size_t end = at + f.number(8);
      for (const Rec& s : summary) {
        EXPECT_EQ(s.kind == kind, s.begin >= at && s.begin < end);
      }
      at = end;
    }
    EXPECT_EQ(at, offsets.front().begin) << "all of the summary is in a group";
  }
};

class McapFile : public Recording {
 protected:
  // on two topics, the second one every third time
  std::string some(int messages, double from = 0) const {
    McapWriter file(path("x.mcap"));
    const std::vector<JsonField> fields{{"t", false, "[s] time"}, {"q", true, "[rad]"}};
    const std::size_t one = file.add({"/one", "a.A", json_schema("a.A", fields), {}});
    const std::size_t two = file.add({"/two", "a.A", json_schema("a.A", fields), {{"k", "v"}}});
    JsonMessage m;
    for (int k = 0; k < messages; ++k) {
      const double t = from + 1e-3 * k, q[] = {std::sin(k), 1e-7 * k};
      m.clear();
      m.put("t", t);
      m.put("q", q, 2);
      const std::string text(m.finish());
      file.write(one, t, text);
      if (k % 3 == 0) file.write(two, t, text);
    }
    file.commit();
    return get(path("x.mcap"));
  }
};

TEST_F(McapFile, IsWhatTheSpecificationSays) {
  for (const int messages : {0, 1, 60'000}) {
    const Mcap file(some(messages));
    EXPECT_EQ(file.messages.size(), static_cast<std::size_t>(messages + (messages + 2) / 3));
    EXPECT_EQ(file.topics, (std::map<std::uint64_t, std::string>{{0, "/one"}, {1, "/two"}}));
    EXPECT_EQ(file.types.size(), 1U) << "topics of one type share its schema";
    if (messages < 2) continue;
    EXPECT_GE(file.chunks, 3U);
    EXPECT_LT(file.largest, 1'100'000U);
    const Message& last = file.last();
    EXPECT_EQ(last.channel, 0U);
    EXPECT_EQ(last.t, 59'999'000'000U);
    EXPECT_EQ(last.sequence, 59'999U);
    EXPECT_EQ(Json::parse(last.data)["q"][0].get<double>(), std::sin(59'999));
  }
}

TEST_F(McapFile, OfTheSameMessagesHasTheSameBytes) {
  EXPECT_TRUE(some(5000) == some(5000));
}

// 2^-30 s is 0.93 ns
TEST_F(McapFile, TimesAreTheNearestNanosecondAndTheFirstIsNotBelow0) {
  const auto times = [&](const std::vector<double>& all) {
    McapWriter file(path("t.mcap"));
    const std::size_t topic = file.add({"/t", "a.A", json_schema("a.A", {}), {}});
    for (const double t : all) file.write(topic, t, "{}");
    file.commit();
    std::vector<std::uint64_t> ns;
    for (const Message& m : Mcap(get(path("t.mcap"))).messages) ns.push_back(m.t);
    return ns;
  };
  using Times = std::vector<std::uint64_t>;
  const double epoch = 1.7e9 + std::ldexp(1, -10);
  EXPECT_EQ(times({0, std::ldexp(1, -30), 1 - std::ldexp(1, -40), epoch}),
            (Times{0, 1, 1'000'000'000, 1'700'000'000'000'976'562 + 1}))
      << "half a nanosecond is rounded up";
  EXPECT_EQ(times({-0.5, -0.25, 1}), (Times{0, 250'000'000, 1'500'000'000}));
  for (const double t : {-1e-9, 1.9e10, std::nan("")}) {
    const std::string error = error_of([&] { times({0.5, t}); });
    EXPECT_TRUE(error.starts_with(path("t.mcap") + ": t = ")) << error;
    EXPECT_NE(error.find("write a .csv"), std::string::npos) << error;
  }
}

TEST_F(McapFile, AppearsWholeOrNotAtAll) {
  {
    McapWriter file(path("y.mcap"));
    const std::size_t topic = file.add({"/t", "a.A", json_schema("a.A", {}), {}});
    for (int k = 0; k < 100'000; ++k) file.write(topic, 1e-3 * k, R"({"some":"text"})");
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
  EXPECT_NE(error_of([&] {
              McapWriter file("/dev/full");
              const std::size_t topic = file.add({"/t", "a.A", json_schema("a.A", {}), {}});
              for (int k = 0; k < 100'000; ++k) file.write(topic, k, R"({"some":"text"})");
              file.commit();
            }).find("/dev/full: cannot write: No space left on device"),
            std::string::npos);
}

// another program's parser gives every bit back
TEST(JsonNumbers, ComeBackBitForBitAndWhatIsNotFiniteIsNull) {
  std::vector<double> all{0.0, -0.0, 1, -1, 0.1, 1e22, 1e-300, 5e-324, 1.7976931348623157e308};
  std::uint64_t bits = 88172645463325252;  // Marsaglia's xorshift
  for (int k = 0; k < 10'000; ++k) {
    bits ^= bits << 13, bits ^= bits >> 7, bits ^= bits << 17;
    const auto x = std::bit_cast<double>(bits);
    if (std::isfinite(x)) all.push_back(x);
  }
  JsonMessage m;
  m.put("all", all.data(), all.size());
  m.put("count", std::int64_t{-7});
  const Json read = Json::parse(m.finish());
  ASSERT_EQ(read["all"].size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    EXPECT_EQ(std::bit_cast<std::uint64_t>(read["all"][i].get<double>()),
              std::bit_cast<std::uint64_t>(all[i]))
        << all[i];
  EXPECT_EQ(read["count"], -7);
  const double odd[] = {std::nan(""), std::numeric_limits<double>::infinity(), 2};
  m.clear();
  m.put("odd", odd, 3);
  m.put("x", -odd[1]);
  EXPECT_EQ(m.finish(), R"({"odd":[null,null,2],"x":null})");
}

TEST(JsonSchema, NamesEachFieldOnce) {
  const Json schema =
      Json::parse(json_schema("a.A", {{"t", false, "[s] time"}, {"q", true, "[rad] position"}}));
  EXPECT_EQ(schema, Json::parse(R"({"title": "a.A", "type": "object", "properties": {
    "t": {"type": "number", "description": "[s] time"},
    "q": {"type": "array", "items": {"type": "number"}, "description": "[rad] position"}}})"));
}

}  // namespace
}  // namespace tauext::test
