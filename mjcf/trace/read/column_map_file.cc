// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/column_map_file.h"

#include <fmt/format.h>

#include <stdexcept>
#ifdef TAUEXT_TOML
namespace tauext::detail {
[[gnu::noinline]] static void fail_toml() {
  throw std::runtime_error("this is no TOML");
}
}  // namespace tauext::detail
// what toml++ 3.3.0 asserts some texts do not keep, and without assertions it believes it
#undef NDEBUG
#define TOML_ASSERT(holds) \
  (static_cast<bool>(holds) ? static_cast<void>(0) : ::tauext::detail::fail_toml())
#include <toml++/toml.h>
#endif

#include <algorithm>
#include <cmath>
#include <functional>
#include <regex>
#include <set>
#include <stdexcept>

#include "mjcf/trace/input_file.h"
#include "mjcf/trace/known.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/read/presets.h"

namespace tauext {

namespace {

const detail::ColumnPreset& preset_of(const std::string& name) {
  return find_known(detail::kColumnPresets, "preset of columns", name,
                    [](const auto& p) { return p.name; });
}

}  // namespace

#ifdef TAUEXT_TOML

// reads one map over what is there
class MapReader {
 public:
  MapReader(ColumnMap& map, const std::string& name) : map_(map), name_(name) {}

  void read(std::string_view text) {
    const toml::table all = parsed(text);
    if (const toml::node* preset = all.get("preset")) {
      read(known_preset(*preset));
    }
    for (const auto& [key, value] : all) {
      if (const toml::table* t = value.as_table()) {
        read_quantity(key.str(), *t);
      } else {
        read_option(key.str(), value);
      }
    }
    if (map_.rate_ > 0 && all.contains("t"))
      fail("it has a `rate` and a [t], and only one of them can say the time");
    if (!map_.parts_.empty() && !map_.files().empty())
      fail("it has `parts`, and a `file` of a quantity: a recording has one or the other");
    if (map_.rate_ > 0 && map_.join_ > 0)
      fail("it has a `rate`, and `join` is for rows with a time");
    for (const char* const q : {"t", "q"})
      if (!map_.wanted_.contains(q) && (map_.rate_ == 0 || *q == 'q'))
        fail(
            fmt::format("nothing says which columns are [{}]: name them, or a `preset` above "
                        "all tables that has what they do not name, like preset = \"tauext\"",
                        q));
  }

  void read(const detail::ColumnPreset& p) {
    for (const auto& [quantity, expression] : p.names)
      map_.wanted_[std::string(quantity)].expression = expression;
    if (!p.toml.empty()) MapReader(map_, std::string(p.name)).read(p.toml);
    for (auto& [quantity, wanted] : map_.wanted_) wanted.of_preset = true;
  }

 private:
  toml::table parsed(std::string_view text) const {
    refuse_other_letters(text);
    try {
      return toml::parse(text);
    } catch (const toml::parse_error& e) {
      throw std::invalid_argument(one_line(fmt::format(
          "{}: line {}: {}", name_, e.source().begin.line, std::string(e.description()))));
    } catch (const std::runtime_error& e) {
      throw std::invalid_argument(fmt::format("{}: {}", name_, e.what()));
    }
  }

  const detail::ColumnPreset& known_preset(const toml::node& at) const {
    try {
      return preset_of(string(at, "preset"));
    } catch (const std::invalid_argument& e) {
      const std::string what = e.what();
      if (what.starts_with(name_ + ": ")) throw;
      fail(at, what);
    }
  }

  // toml++ 3.3.0 does not survive them everywhere
  void refuse_other_letters(std::string_view text) const {
    const auto plain = [](char c) { return (c >= ' ' && c <= '~') || (c >= '\t' && c <= '\r'); };
    const auto at = std::find_if_not(text.begin(), text.end(), plain);
    if (at == text.end()) return;
    throw std::invalid_argument(fmt::format(
        "{}: line {}: a map is written in ASCII; in `columns`, .+ stands for any letters", name_,
        1 + std::count(text.begin(), at, '\n')));
  }

  // of all of it
  [[noreturn]] void fail(const std::string& what) const {
    throw std::invalid_argument(one_line(fmt::format("{}: {}", name_, what)));
  }
  [[noreturn]] void fail(const toml::node& at, const std::string& what) const {
    fail(fmt::format("line {}: {}", at.source().begin.line, what));
  }

  std::string string(const toml::node& value, std::string_view key) const {
    if (const auto s = value.value_exact<std::string>()) return *s;
    fail(value, fmt::format("{} must be a text", key));
  }
  double number(const toml::node& value, std::string_view key) const {
    const auto x = value.value<double>();
    if (x && std::isfinite(*x)) return *x;
    fail(value, fmt::format("{} must be a number", key));
  }
  int counted(const toml::node& value, std::string_view key) const {
    const auto n = value.value_exact<std::int64_t>();
    if (n && *n >= 1 && *n <= 100000) return static_cast<int>(*n);
    fail(value, fmt::format("{} must be a number from 1", key));
  }

  // one, or a list of them
  template <class Read>
  auto list(const toml::node& value, Read&& read) const {
    std::vector<decltype(read(value))> all;
    const toml::array* const many = value.as_array();
    if (many == nullptr) return std::vector{read(value)};
    for (const toml::node& one : *many) all.push_back(read(one));
    if (all.empty()) fail(value, "an empty list");
    return all;
  }

  void read_option(std::string_view key, const toml::node& value) {
    if (key == "preset") return;
    if (key == "separator") {
      const std::string s = string(value, key);
      if (s.size() != 1) fail(value, "separator must be one character, like \",\" or \" \"");
      map_.csv_.separator = s[0];
    } else if (key == "header") {
      const auto has = value.value_exact<bool>();
      if (!has) fail(value, "header must be true or false");
      map_.csv_.has_header = *has;
    } else if (key == "order") {
      map_.order_ = list(value, [&](const toml::node& n) { return counted(n, key); });
    } else if (key == "velocity_filter") {
      map_.velocity_filter_ = number(value, key);
      if (!(map_.velocity_filter_ > 0)) fail(value, "velocity_filter must be positive [rad/s]");
    } else if (key == "parts") {
      map_.parts_ = string(value, key);
      check_expression(value, key, map_.parts_);
    } else if (key == "rate") {
      map_.rate_ = number(value, key);
      if (!(map_.rate_ > 0)) fail(value, "rate must be positive [Hz]");
    } else if (key == "join") {
      map_.join_ = number(value, key);
      if (!(map_.join_ > 0 && map_.join_ <= 0.1))
        fail(value, "join must be above 0 and at most 0.1 [s]: an arm moves on meanwhile");
    } else {
      fail(value, unknown("key", key,
                          {"preset", "separator", "header", "order", "rate", "velocity_filter",
                           "join", "parts", "and tables of quantities"})
                      .what());
    }
  }

  void read_quantity(std::string_view name, const toml::table& table) {
    const auto known = std::find_if(std::begin(kQuantities), std::end(kQuantities),
                                    [&](const Quantity& q) { return q.name == name; });
    if (known == std::end(kQuantities)) {
      std::vector<std::string> names;
      for (const Quantity& q : kQuantities) names.emplace_back(q.name);
      fail(table, unknown("quantity", name, names).what());
    }
    ColumnMap::Wanted& w = map_.wanted_[std::string(name)];
    if (is_torque(name)) replace_torque(name, w);
    written_.emplace(name);
    for (const auto& [key, value] : table) read_key(*known, key.str(), value, w);
    if (w.expression.empty() && w.names.empty() && w.numbers.empty())
      fail(table, fmt::format("[{}] names no columns, and no preset lends it any: `preset = "
                              "\"tauext\"` above all tables has those that are read without a "
                              "map, \"joint_state\" those of a bag",
                              name));
  }

  static bool is_torque(std::string_view name) {
    return std::find(std::begin(kTorques), std::end(kTorques), name) != std::end(kTorques);
  }

  // those of the preset, which lend their columns
  void replace_torque(std::string_view name, ColumnMap::Wanted& w) {
    const bool has_columns = !w.expression.empty();
    for (const std::string_view other : kTorques) {
      const auto at = map_.wanted_.find(other);
      if (other == name || at == map_.wanted_.end() || !at->second.of_preset ||
          written_.count(other))
        continue;
      if (!has_columns && other != "current") {  // amperes are no N m
        w.expression += (w.expression.empty() ? "" : "|") + at->second.expression;
        w.of_preset = true;
      }
      map_.wanted_.erase(at);
    }
  }

  void read_key(const Quantity& q, std::string_view key, const toml::node& value,
                ColumnMap::Wanted& w) {
    if (key == "columns") {
      read_columns(value, w);
    } else if (key == "unit") {
      w.units = list(value, [&](const toml::node& n) { return unit(q, n); });
    } else if (key == "gain") {
      w.gain = list(value, [&](const toml::node& n) { return number(n, key); });
    } else if (key == "file") {
      w.file = string(value, key);
      if (w.file.empty()) fail(value, "file must be the name of one");
    } else if (key == "sign") {
      w.sign = list(value, [&](const toml::node& n) {
        const double s = number(n, key);
        if (s != 1 && s != -1) fail(n, "sign must be 1 or -1");
        return s;
      });
    } else if (key == "zero" && q.of_joints) {
      w.zero = list(value, [&](const toml::node& n) { return number(n, key); });
    } else if (key == "held" && is_torque(q.name)) {
      w.held = value.value_exact<bool>();
      if (!w.held) fail(value, "held must be true or false");
    } else {
      fail(value, unknown("key", key,
                          {"columns", "file", "unit", "gain", "sign", "zero (of joints)",
                           "held (of a torque)"})
                      .what());
    }
  }

  std::string unit(const Quantity& q, const toml::node& value) const {
    std::string u = string(value, "unit");
    if (fmt::format(" {} ", q.units).find(fmt::format(" {} ", u)) != std::string::npos) return u;
    fail(value, fmt::format("[{}] cannot be in '{}'; it may be in: {}", q.name, u, q.units));
  }

  void check_expression(const toml::node& at, std::string_view key,
                        const std::string& expression) const {
    try {
      const std::regex tried(expression);
    } catch (const std::regex_error& e) {
      fail(at, fmt::format("{} '{}': {}", key, expression, e.what()));
    }
  }

  void read_columns(const toml::node& value, ColumnMap::Wanted& w) {
    w.expression.clear(), w.names.clear(), w.numbers.clear();
    w.of_preset = false;
    if (const auto text = value.value_exact<std::string>()) {
      check_expression(value, "columns", *text);
      w.expression = *text;
      return;
    }
    const toml::array* const many = value.as_array();
    const bool by_name = many != nullptr && !many->empty() && (*many)[0].is_string();
    if (by_name) {
      w.names = list(value, [&](const toml::node& n) { return string(n, "columns"); });
    } else {
      w.numbers = list(value, [&](const toml::node& n) { return counted(n, "columns"); });
    }
  }

  ColumnMap& map_;
  std::string name_;
  std::set<std::string, std::less<>> written_;  // quantities of the map itself
};

#else

class MapReader {
 public:
  MapReader(ColumnMap& map, const std::string& name) : map_(map), name_(name) {}
  void read(std::string_view) {
    throw std::runtime_error(
        name_ +
        ": maps of columns are left out of this build: install Debian's libtomlplusplus-dev, "
        "and build again");
  }
  void read(const detail::ColumnPreset& p) {
    for (const auto& [quantity, expression] : p.names)
      map_.wanted_[std::string(quantity)].expression = expression;
    if (!p.toml.empty()) read(p.toml);
    for (auto& [quantity, wanted] : map_.wanted_) wanted.of_preset = true;
  }

 private:
  ColumnMap& map_;
  std::string name_;
};

#endif

ColumnMap column_map_of(std::string_view toml, const std::string& name) {
  ColumnMap map;
  MapReader(map, name).read(toml);
  return map;
}

ColumnMap column_map(const std::string& name) {
  constexpr std::size_t kMost = 1 << 20;  // [bytes]
  if (name.ends_with(".toml")) return column_map_of(read_whole(name, kMost), name);
  ColumnMap map;
  MapReader(map, name).read(preset_of(name));
  return map;
}

std::string preset_of_messages(const std::string& type) {
  for (const auto& p : detail::kColumnPresets)
    if (fmt::format(" {} ", p.messages).find(fmt::format(" {} ", type)) != std::string::npos)
      return std::string(p.name);
  return "";
}

}  // namespace tauext
